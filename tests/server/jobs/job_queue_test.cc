#include "server/jobs/job_queue.h"

#include <gtest/gtest.h>

#include <atomic>
#include <future>
#include <map>
#include <mutex>
#include <set>
#include <stdexcept>

namespace server::jobs {
namespace {

using std::chrono::milliseconds;
using tin::base::Code;
using tin::base::Progress;
using tin::base::Result;

constexpr milliseconds kLong{20000};

Result<std::string> quick(Progress&) {
  return std::string("{}");
}

// Work that runs until the test lets it go, or until it is cancelled.
class Gate {
 public:
  JobQueue::Work work() {
    return [this](Progress& progress) -> Result<std::string> {
      ++started_;
      while (!open_) {
        if (progress.cancelled()) return tin::base::error(Code::kCancelled, "stopped");
        std::this_thread::sleep_for(milliseconds(1));
      }
      return std::string("\"through\"");
    };
  }
  void open() { open_ = true; }
  void await_started(int count) const {
    while (started_ < count) std::this_thread::sleep_for(milliseconds(1));
  }
  int started() const { return started_; }

 private:
  std::atomic<int> started_{0};
  std::atomic<bool> open_{false};
};

JobState state_of(const JobQueue& jobs, const JobId& id) {
  return jobs.status(id)->state;
}

TEST(JobQueueTest, AJobRunsAndItsResultIsKept) {
  JobQueue jobs({});
  const auto id = jobs.submit("simplify", "alps to 5 m", [](Progress& progress) -> Result<std::string> {
    progress.report(0.5);
    return std::string("{\"vertices\":7}");
  });
  ASSERT_TRUE(id.ok());
  const auto status = jobs.wait(*id, kLong);
  ASSERT_TRUE(status);
  EXPECT_EQ(status->id, *id);
  EXPECT_EQ(status->kind, "simplify");
  EXPECT_EQ(status->description, "alps to 5 m");
  EXPECT_EQ(status->state, JobState::kSuccessful);
  EXPECT_EQ(status->progress, 100);
  EXPECT_EQ(status->result, "{\"vertices\":7}");
  EXPECT_FALSE(status->error);
  ASSERT_TRUE(status->started_ms && status->finished_ms);
  EXPECT_LE(status->created_ms, *status->started_ms);
  EXPECT_LE(*status->started_ms, *status->finished_ms);
}

TEST(JobQueueTest, UnknownJobsAreNotFound) {
  JobQueue jobs({});
  EXPECT_FALSE(jobs.status("nobody"));
  EXPECT_FALSE(jobs.wait("nobody", kLong));
  const auto dismissed = jobs.dismiss("nobody");
  ASSERT_FALSE(dismissed.ok());
  EXPECT_EQ(dismissed.error().code, Code::kNotFound);
}

TEST(JobQueueTest, IdsDiffer) {
  JobQueue jobs({.max_queued = 1000, .max_kept = 1000});
  std::set<JobId> ids;
  for (int i = 0; i < 500; ++i) ids.insert(*jobs.submit("k", "", quick));
  EXPECT_EQ(ids.size(), 500u);
  EXPECT_EQ(ids.begin()->size(), 20u);
}

TEST(JobQueueTest, ErrorsAndExceptionsFailTheJobAndNotTheWorker) {
  JobQueue jobs({});
  const std::pair<JobQueue::Work, Code> failures[] = {
      {[](Progress&) -> Result<std::string> { return tin::base::error(Code::kInvalidValue, "no"); },
       Code::kInvalidValue},
      {[](Progress&) -> Result<std::string> { throw std::bad_alloc(); }, Code::kTooLarge},
      {[](Progress&) -> Result<std::string> { throw std::runtime_error("boom"); }, Code::kInternal},
      {[](Progress&) -> Result<std::string> { throw 7; }, Code::kInternal},
      // Cancelled, but not by us: a failure, not a dismissal.
      {[](Progress&) -> Result<std::string> { return tin::base::error(Code::kCancelled, "?"); },
       Code::kCancelled},
  };
  for (const auto& [work, code] : failures) {
    const auto status = jobs.wait(*jobs.submit("k", "", work), kLong);
    ASSERT_TRUE(status);
    EXPECT_EQ(status->state, JobState::kFailed);
    ASSERT_TRUE(status->error);
    EXPECT_EQ(status->error->code, code);
    EXPECT_EQ(status->message, status->error->message);
  }
  EXPECT_EQ(jobs.wait(*jobs.submit("k", "", quick), kLong)->state, JobState::kSuccessful);
}

TEST(JobQueueTest, ProgressIsSeenWhileItRuns) {
  JobQueue jobs({});
  std::promise<void> reported;
  std::promise<void> seen;
  const auto id = jobs.submit("k", "", [&](Progress& progress) -> Result<std::string> {
    progress.report(0.425);
    reported.set_value();
    seen.get_future().wait();
    progress.report(1.0);
    return tin::base::error(Code::kInternal, "after all");
  });
  reported.get_future().wait();
  const auto status = jobs.status(*id);
  EXPECT_EQ(status->state, JobState::kRunning);
  EXPECT_EQ(status->progress, 42);
  EXPECT_FALSE(status->finished_ms);
  seen.set_value();
  EXPECT_EQ(jobs.wait(*id, kLong)->progress, 99);  // 100 is for the successful
}

TEST(JobQueueTest, WaitingEndsWithTheTimeout) {
  JobQueue jobs({});
  Gate gate;
  const auto id = jobs.submit("k", "", gate.work());
  const auto status = jobs.wait(*id, milliseconds(20));
  ASSERT_TRUE(status);
  EXPECT_NE(status->state, JobState::kSuccessful);
  gate.open();
  EXPECT_EQ(jobs.wait(*id, kLong)->state, JobState::kSuccessful);
}

TEST(JobQueueTest, TheQueueTakesItsLimitAndNoMore) {
  JobQueue jobs({.workers = 1, .max_queued = 3, .max_kept = 10});
  Gate gate;
  ASSERT_TRUE(jobs.submit("k", "", gate.work()).ok());
  gate.await_started(1);
  for (int i = 0; i < 3; ++i) ASSERT_TRUE(jobs.submit("k", "", gate.work()).ok()) << i;
  const auto refused = jobs.submit("k", "", gate.work());
  ASSERT_FALSE(refused.ok());
  EXPECT_EQ(refused.error().code, Code::kTooMany);
  EXPECT_EQ(jobs.list().size(), 4u);
  gate.open();
  for (const JobStatus& status : jobs.list()) jobs.wait(status.id, kLong);
  EXPECT_TRUE(jobs.submit("k", "", quick).ok());
}

TEST(JobQueueTest, FinishedJobsAreKeptUpToTheLimit) {
  JobQueue jobs({.workers = 1, .max_queued = 10, .max_kept = 3});
  std::vector<JobId> ids;
  for (int i = 0; i < 4; ++i) {
    ids.push_back(*jobs.submit("k", std::to_string(i), quick));
    EXPECT_EQ(jobs.wait(ids.back(), kLong)->state, JobState::kSuccessful);
    EXPECT_EQ(jobs.list().size(), static_cast<std::size_t>(std::min(i + 1, 3)));
  }
  EXPECT_FALSE(jobs.status(ids[0]));
  EXPECT_TRUE(jobs.status(ids[1]));
  EXPECT_EQ(jobs.list().front().id, ids[3]);  // the newest first
}

TEST(JobQueueTest, WhoWaitsSeesTheEndThoughNothingIsKept) {
  JobQueue jobs({.workers = 1, .max_queued = 10, .max_kept = 0});
  Gate gate;
  const JobId id = *jobs.submit("k", "", gate.work());
  auto waiting = std::async(std::launch::async, [&] { return jobs.wait(id, kLong); });
  gate.await_started(1);
  std::this_thread::sleep_for(milliseconds(50));
  gate.open();
  const auto status = waiting.get();
  ASSERT_TRUE(status);
  EXPECT_EQ(status->state, JobState::kSuccessful);
  EXPECT_FALSE(jobs.status(id));
}

TEST(JobQueueTest, AQueuedJobIsDismissedWithoutRunning) {
  JobQueue jobs({});
  Gate gate;
  const JobId first = *jobs.submit("k", "", gate.work());
  gate.await_started(1);
  const auto held = std::make_shared<int>(7);
  const JobId second = *jobs.submit("k", "", [held, work = gate.work()](Progress& p) { return work(p); });
  EXPECT_EQ(state_of(jobs, second), JobState::kAccepted);
  ASSERT_TRUE(jobs.dismiss(second).ok());
  EXPECT_EQ(state_of(jobs, second), JobState::kDismissed);
  EXPECT_FALSE(jobs.status(second)->started_ms);
  EXPECT_EQ(held.use_count(), 1);  // what it held is let go of
  gate.open();
  EXPECT_EQ(jobs.wait(first, kLong)->state, JobState::kSuccessful);
  jobs.stop();
  EXPECT_EQ(gate.started(), 1);
}

TEST(JobQueueTest, ARunningJobIsStopped) {
  JobQueue jobs({});
  Gate gate;
  const JobId id = *jobs.submit("k", "", gate.work());
  gate.await_started(1);
  ASSERT_TRUE(jobs.dismiss(id).ok());
  const auto status = jobs.wait(id, kLong);
  EXPECT_EQ(status->state, JobState::kDismissed);
  EXPECT_FALSE(status->error);
  EXPECT_EQ(status->message, "dismissed while it ran");
  ASSERT_TRUE(jobs.dismiss(id).ok());  // once more does no harm, and does not say that it had finished
  EXPECT_EQ(state_of(jobs, id), JobState::kDismissed);
  EXPECT_EQ(jobs.status(id)->message, "dismissed while it ran");
}

TEST(JobQueueTest, AJobThatWasDoneWhenDismissedSaysSo) {
  JobQueue jobs({});
  std::promise<void> started;
  std::promise<void> dismissed;
  const JobId id = *jobs.submit("k", "", [&](Progress&) -> Result<std::string> {
    started.set_value();
    dismissed.get_future().wait();
    return std::string("1");
  });
  started.get_future().wait();
  ASSERT_TRUE(jobs.dismiss(id).ok());
  EXPECT_EQ(jobs.status(id)->message, "stopping");
  dismissed.set_value();
  EXPECT_EQ(jobs.wait(id, kLong)->state, JobState::kSuccessful);
}

TEST(JobQueueTest, AFinishedJobIsDismissedAndLosesItsResult) {
  JobQueue jobs({});
  const JobId id = *jobs.submit("k", "", quick);
  EXPECT_EQ(jobs.wait(id, kLong)->result, "{}");
  ASSERT_TRUE(jobs.dismiss(id).ok());
  EXPECT_EQ(state_of(jobs, id), JobState::kDismissed);
  EXPECT_EQ(jobs.status(id)->result, "");
}

TEST(JobQueueTest, StoppingCancelsAllAndRefusesMore) {
  JobQueue jobs({.workers = 2});
  Gate gate;
  std::vector<JobId> ids;
  for (int i = 0; i < 5; ++i) ids.push_back(*jobs.submit("k", "", gate.work()));
  gate.await_started(2);
  jobs.stop();
  for (const JobId& id : ids) EXPECT_EQ(state_of(jobs, id), JobState::kDismissed);
  const auto refused = jobs.submit("k", "", quick);
  ASSERT_FALSE(refused.ok());
  EXPECT_EQ(refused.error().code, Code::kTooMany);
  jobs.stop();  // once more does no harm
}

TEST(JobQueueTest, DestructionStopsWhatRuns) {
  Gate gate;
  {
    JobQueue jobs({});
    ASSERT_TRUE(jobs.submit("k", "", gate.work()).ok());
    ASSERT_TRUE(jobs.submit("k", "", gate.work()).ok());
    gate.await_started(1);
  }
  EXPECT_EQ(gate.started(), 1);
}

TEST(JobQueueTest, DrainingLetsFinishWhatWaitsAndTakesNothingNew) {
  Gate gate;
  JobQueue jobs({});
  const auto first = jobs.submit("k", "", gate.work());
  const auto second = jobs.submit("k", "", [](Progress&) -> Result<std::string> { return std::string("2"); });
  ASSERT_TRUE(first.ok() && second.ok());
  gate.await_started(1);
  std::thread draining([&] { jobs.drain(kLong); });
  while (jobs.submit("k", "", gate.work()).ok()) std::this_thread::yield();
  gate.open();
  draining.join();
  EXPECT_FALSE(jobs.submit("k", "", gate.work()).ok());
  EXPECT_EQ(jobs.status(*first)->state, JobState::kSuccessful);
  EXPECT_EQ(jobs.status(*second)->state, JobState::kSuccessful);
}

TEST(JobQueueTest, DrainingStopsWhatTakesTooLong) {
  Gate gate;
  JobQueue jobs({});
  const auto id = jobs.submit("k", "", gate.work());
  ASSERT_TRUE(id.ok());
  gate.await_started(1);
  jobs.drain(std::chrono::milliseconds(20));
  EXPECT_EQ(jobs.status(*id)->state, JobState::kDismissed);
}

TEST(JobQueueTest, ManyThreadsSubmitWatchAndDismiss) {
  JobQueue jobs({.workers = 3, .max_queued = 50, .max_kept = 20});
  std::atomic<int> ran{0};
  std::vector<std::thread> threads;
  for (int t = 0; t < 6; ++t) {
    threads.emplace_back([&, t] {
      for (int i = 0; i < 100; ++i) {
        const auto id = jobs.submit("k", "", [&](Progress& progress) -> Result<std::string> {
          progress.report(0.5);
          ++ran;
          if (progress.cancelled()) return tin::base::error(Code::kCancelled, "stopped");
          return std::string("{}");
        });
        if (!id.ok()) continue;
        if ((i + t) % 3 == 0) static_cast<void>(jobs.dismiss(*id));
        if ((i + t) % 3 == 1) jobs.wait(*id, kLong);
        jobs.list();
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  jobs.stop();
  EXPECT_GT(ran, 0);
  EXPECT_LE(jobs.list().size(), 20u);
  for (const JobStatus& status : jobs.list()) EXPECT_TRUE(status.finished_ms);
}

/// A memory that a test looks into.
class Notebook : public JobMemory {
 public:
  Result<void> remember(const JobStatus& job) override {
    const std::lock_guard guard(mutex_);
    if (fail) return tin::base::error(Code::kStorage, "no disk");
    jobs[job.id] = job;
    return {};
  }
  void forget(const JobId& id) override {
    const std::lock_guard guard(mutex_);
    jobs.erase(id);
  }
  JobState state(const JobId& id) {
    const std::lock_guard guard(mutex_);
    return jobs.at(id).state;
  }

  std::map<JobId, JobStatus> jobs;
  bool fail = false;

 private:
  std::mutex mutex_;
};

TEST(JobMemoryTest, WhatBecameOfAJobIsRememberedBeforeItIsTold) {
  Notebook notebook;
  JobQueue jobs({.workers = 1, .max_queued = 4, .max_kept = 2}, &notebook);
  const auto id = jobs.submit("k", "d", [](tin::base::Progress&) { return Result<std::string>("{}"); });
  ASSERT_TRUE(id.ok());
  ASSERT_TRUE(jobs.wait(*id, std::chrono::seconds(30))->finished_ms);
  EXPECT_EQ(notebook.state(*id), JobState::kSuccessful);
  EXPECT_EQ(notebook.jobs.at(*id).result, "{}");
  for (int i = 0; i < 3; ++i) {
    const auto more = jobs.submit("k", "d", [](tin::base::Progress&) -> Result<std::string> {
      return tin::base::error(Code::kTooLarge, "too much", "/inputs");
    });
    ASSERT_TRUE(more.ok());
    jobs.wait(*more, std::chrono::seconds(30));
  }
  jobs.stop();
  EXPECT_EQ(notebook.jobs.size(), 2U) << "it forgets what the queue forgets";
  EXPECT_FALSE(notebook.jobs.contains(*id));
  EXPECT_EQ(notebook.jobs.begin()->second.error->where, "/inputs");
}

TEST(JobMemoryTest, AJobThatCannotBeRememberedIsNotTaken) {
  Notebook notebook;
  notebook.fail = true;
  JobQueue jobs({}, &notebook);
  const auto id = jobs.submit("k", "d", [](tin::base::Progress&) { return Result<std::string>("{}"); });
  ASSERT_FALSE(id.ok());
  EXPECT_EQ(id.error().code, Code::kStorage);
  EXPECT_TRUE(jobs.list().empty());
}

TEST(JobMemoryTest, ARestartKeepsResultsAndDismissesWhatHadNotFinished) {
  Notebook notebook;
  const auto job = [](const char* id, JobState state) {
    JobStatus status;
    status.id = id;
    status.state = state;
    return status;
  };
  JobStatus done = job("done", JobState::kSuccessful);
  done.finished_ms = 5;
  done.result = "{\"a\":1}";
  const JobStatus ran = job("ran", JobState::kRunning), waited = job("waited", JobState::kAccepted);
  for (const JobStatus& each : {done, ran, waited}) ASSERT_TRUE(notebook.remember(each).ok());
  JobQueue jobs({}, &notebook, {done, ran, waited});
  EXPECT_EQ(jobs.status("done")->result, done.result);
  for (const char* id : {"ran", "waited"}) {
    EXPECT_EQ(jobs.status(id)->state, JobState::kDismissed);
    EXPECT_NE(jobs.status(id)->message.find("restart"), std::string::npos);
    EXPECT_EQ(notebook.state(id), JobState::kDismissed);
  }
  EXPECT_EQ(jobs.list().size(), 3U);
  EXPECT_EQ(jobs.list().back().id, "done");
}

}  // namespace
}  // namespace server::jobs
