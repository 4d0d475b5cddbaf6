#include "server/jobs/job_queue.h"

#include <algorithm>
#include <exception>
#include <new>
#include <random>
#include <utility>

namespace server::jobs {
namespace {

using tin::base::Code;
using tin::base::Result;

std::int64_t now_ms() {
  const auto now = std::chrono::system_clock::now().time_since_epoch();
  return std::chrono::duration_cast<std::chrono::milliseconds>(now).count();
}

JobId random_id() {
  constexpr std::string_view kLetters = "abcdefghijklmnopqrstuvwxyz234567";  // 5 bits each
  constexpr std::size_t kLength = 20;
  std::random_device entropy;
  std::uniform_int_distribution<std::size_t> letter(0, kLetters.size() - 1);
  JobId id(kLength, ' ');
  for (char& c : id) c = kLetters[letter(entropy)];
  return id;
}

bool is_finished(JobState state) {
  return state != JobState::kAccepted && state != JobState::kRunning;
}

// The job boundary: one of the two places where the environment's exceptions end.
Result<std::string> guarded(const JobQueue::Work& work, tin::base::Progress& progress) {
  try {
    return work(progress);
  } catch (const std::bad_alloc&) {
    return tin::base::error(Code::kTooLarge, "there is not enough memory for this job");
  } catch (const std::exception& exception) {
    return tin::base::error(Code::kInternal, std::string("the job failed: ") + exception.what());
  } catch (...) {
    return tin::base::error(Code::kInternal, "the job failed for an unknown reason");
  }
}

}  // namespace

struct JobQueue::Job {
  JobStatus status;  // its progress field is filled in by snapshot()
  std::uint64_t number = 0;
  tin::base::Progress progress;
  Work work;

  JobStatus snapshot() const {
    JobStatus copy = status;
    const bool successful = status.state == JobState::kSuccessful;
    const double fraction = std::clamp(progress.fraction(), 0.0, 0.99);
    copy.progress = successful ? 100 : static_cast<int>(100 * fraction);
    if (status.state == JobState::kRunning && progress.cancelled()) copy.message = "stopping";
    return copy;
  }
};

JobQueue::JobQueue(const JobLimits& limits, JobMemory* memory, const std::vector<JobStatus>& earlier)
    : limits_(limits), memory_(memory) {
  recall(earlier);
  for (std::size_t i = 0; i < limits_.workers; ++i) workers_.emplace_back([this] { run_worker(); });
}

JobQueue::~JobQueue() {
  stop();
}

void JobQueue::recall(const std::vector<JobStatus>& earlier) {
  {
    const std::lock_guard guard(mutex_);
    for (const JobStatus& status : earlier) {
      const auto job = std::make_shared<Job>();
      job->status = status;
      job->number = submitted_++;
      by_id_.emplace(status.id, job);
      if (is_finished(status.state)) {
        finished_.push_back(job);
      } else {
        finish(*job, JobState::kDismissed,
               "dismissed because the server was restarted before it had finished");
      }
    }
  }
  bring_memory_up();
}

Result<JobId> JobQueue::submit(std::string kind, std::string description, Work work) {
  const auto job = std::make_shared<Job>();
  job->status.id = random_id();
  job->status.kind = std::move(kind);
  job->status.description = std::move(description);
  job->status.created_ms = now_ms();
  job->status.message = "waiting for a worker";
  job->work = std::move(work);
  const JobId id = job->status.id;
  const auto check_room = [this]() -> Result<void> {
    if (stopped_ || draining_) return tin::base::error(Code::kTooMany, "the server is shutting down");
    if (queued_.size() < limits_.max_queued) return {};
    return tin::base::error(Code::kTooMany, std::to_string(queued_.size()) + " jobs are waiting already");
  };
  {
    const std::lock_guard guard(mutex_);
    if (auto room = check_room(); !room.ok()) return room.error();
  }
  if (memory_ != nullptr) {
    if (auto kept = memory_->remember(job->status); !kept.ok()) return kept.error();
  }
  {
    std::unique_lock lock(mutex_);
    if (auto room = check_room(); !room.ok()) {  // others were quicker
      lock.unlock();
      if (memory_ != nullptr) memory_->forget(id);
      return room.error();
    }
    job->number = submitted_++;
    by_id_.emplace(id, job);
    queued_.push_back(job);
  }
  queue_changed_.notify_one();
  return id;
}

std::optional<JobStatus> JobQueue::status(std::string_view id) const {
  const std::lock_guard guard(mutex_);
  const JobPtr job = find(id);
  return job ? std::optional(job->snapshot()) : std::nullopt;
}

std::optional<JobStatus> JobQueue::wait(std::string_view id, std::chrono::milliseconds timeout) const {
  std::unique_lock lock(mutex_);
  const JobPtr job = find(id);
  if (!job) return std::nullopt;
  // The job is held, so its end is seen even if it is forgotten at once.
  finished_changed_.wait_for(lock, timeout, [&] { return is_finished(job->status.state); });
  return job->snapshot();
}

std::vector<JobStatus> JobQueue::list() const {
  const std::lock_guard guard(mutex_);
  std::vector<JobPtr> jobs;
  for (const auto& [id, job] : by_id_) jobs.push_back(job);
  std::sort(jobs.begin(), jobs.end(), [](const JobPtr& a, const JobPtr& b) { return a->number > b->number; });
  std::vector<JobStatus> statuses;
  for (const JobPtr& job : jobs) statuses.push_back(job->snapshot());
  return statuses;
}

Result<void> JobQueue::dismiss(std::string_view id) {
  Work dropped;  // destroyed without the lock: it may own much
  std::unique_lock lock(mutex_);
  const JobPtr job = find(id);
  if (!job) return tin::base::error(Code::kNotFound, "no job \"" + std::string(id) + "\"");
  if (job->status.state == JobState::kRunning) {
    job->progress.cancel();
  } else if (job->status.state == JobState::kAccepted) {
    dropped = std::move(job->work);
    std::erase(queued_, job);
    finish(*job, JobState::kDismissed, "dismissed before it began");
  } else if (job->status.state != JobState::kDismissed) {
    job->status.state = JobState::kDismissed;
    job->status.message = "dismissed after it had finished";
    job->status.result.clear();
    job->status.error.reset();
    if (memory_ != nullptr) to_remember_.push_back(job->status);
  }
  lock.unlock();
  bring_memory_up();
  return {};
}

void JobQueue::drain(std::chrono::milliseconds timeout) {
  {
    std::unique_lock lock(mutex_);
    draining_ = true;
    finished_changed_.wait_for(lock, timeout, [this] { return queued_.empty() && running_.empty(); });
  }
  stop();
}

void JobQueue::stop() {
  {
    std::vector<Work> dropped;
    const std::lock_guard guard(mutex_);
    stopped_ = true;
    for (const JobPtr& job : running_) job->progress.cancel();
    for (const JobPtr& job : std::exchange(queued_, {})) {
      dropped.push_back(std::move(job->work));
      finish(*job, JobState::kDismissed, "dismissed because the server stopped");
    }
  }
  bring_memory_up();
  queue_changed_.notify_all();
  const std::lock_guard joining(stop_mutex_);
  for (std::thread& worker : std::exchange(workers_, {})) worker.join();
}

void JobQueue::run_worker() {
  while (const JobPtr job = next_job()) run(*job);
}

JobQueue::JobPtr JobQueue::next_job() {
  std::unique_lock lock(mutex_);
  queue_changed_.wait(lock, [this] { return stopped_ || !queued_.empty(); });
  if (queued_.empty()) return nullptr;
  const JobPtr job = queued_.front();
  queued_.pop_front();
  running_.push_back(job);
  job->status.state = JobState::kRunning;
  job->status.started_ms = now_ms();
  job->status.message = "running";
  return job;
}

void JobQueue::run(Job& job) {
  Result<std::string> result = guarded(job.work, job.progress);
  job.work = nullptr;  // what it holds (a snapshot, perhaps) goes before anyone hears of the end
  const bool cancelled = !result.ok() && result.error().code == Code::kCancelled && job.progress.cancelled();
  if (memory_ != nullptr && result.ok()) {
    // On disk before anyone hears of it. If that fails, this process knows it still.
    JobStatus done = status(job.status.id).value_or(job.status);
    done.state = JobState::kSuccessful;
    done.finished_ms = now_ms();
    done.message = "done";
    done.result = *result;
    static_cast<void>(memory_->remember(done));
  }
  {
    const std::lock_guard guard(mutex_);
    std::erase_if(running_, [&](const JobPtr& running) { return running.get() == &job; });
    if (result.ok()) {
      job.status.result = *std::move(result);
      finish(job, JobState::kSuccessful, "done");
    } else if (cancelled) {
      finish(job, JobState::kDismissed, "dismissed while it ran");
    } else {
      job.status.error = std::move(result).error();
      finish(job, JobState::kFailed, job.status.error->message);
    }
  }
  bring_memory_up();
}

void JobQueue::finish(Job& job, JobState state, std::string message) {
  job.status.state = state;
  job.status.finished_ms = now_ms();
  job.status.message = std::move(message);
  finished_.push_back(find(job.status.id));
  if (memory_ != nullptr) to_remember_.push_back(job.status);
  while (finished_.size() > limits_.max_kept) {
    if (memory_ != nullptr) to_forget_.push_back(finished_.front()->status.id);
    by_id_.erase(finished_.front()->status.id);
    finished_.pop_front();
  }
  finished_changed_.notify_all();
}

/// Writes down what happened meanwhile. The memory may be slow, so nobody waits for it with the lock.
void JobQueue::bring_memory_up() {
  if (memory_ == nullptr) return;
  const std::lock_guard in_order(memory_mutex_);
  std::unique_lock lock(mutex_);
  const auto jobs = std::exchange(to_remember_, {});
  const auto ids = std::exchange(to_forget_, {});
  lock.unlock();
  for (const JobStatus& job : jobs) static_cast<void>(memory_->remember(job));
  for (const JobId& id : ids) memory_->forget(id);
}

JobQueue::JobPtr JobQueue::find(std::string_view id) const {
  const auto found = by_id_.find(id);
  return found == by_id_.end() ? nullptr : found->second;
}

}  // namespace server::jobs
