// Long work beside the requests: a bounded queue, a few workers, and a memory of what became of each job.
//
//   JobQueue jobs({.workers = 1, .max_queued = 16, .max_kept = 200});
//   auto id = jobs.submit("simplify", "alps to 5 m", [=](tin::base::Progress& p) { return simplify(..., p);
//   }); auto status = jobs.wait(*id, std::chrono::seconds(60));  // or status(*id) now and then
//   jobs.dismiss(*id);                                       // stops the work
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "tin/base/progress.h"
#include "tin/base/result.h"

namespace server::jobs {

/// Names a job; 100 random bits in letters and digits, so that nobody guesses another's.
using JobId = std::string;

/// The states of OGC API Processes.
enum class JobState { kAccepted, kRunning, kSuccessful, kFailed, kDismissed };

struct JobLimits {
  std::size_t workers = 1;
  std::size_t max_queued = 16;  // waiting for a worker; those that run do not count
  std::size_t max_kept = 200;   // finished ones; the one that finished first is forgotten first
};

/// A job as it was when asked. Times are Unix times.
struct JobStatus {
  JobId id;
  std::string kind;         // the process: "simplify"
  std::string description;  // what of: "alps to 5 m"
  JobState state = JobState::kAccepted;
  int progress = 0;  // percent; 100 only when successful
  std::int64_t created_ms = 0;
  std::optional<std::int64_t> started_ms;
  std::optional<std::int64_t> finished_ms;
  std::string message;                    // a sentence for people
  std::optional<tin::base::Error> error;  // when failed
  std::string result;                     // JSON, when successful
};

/// Where jobs are remembered beyond the process. Thread-safe.
class JobMemory {
 public:
  virtual ~JobMemory() = default;
  /// Durable when it returns. Errors: those of the store.
  virtual tin::base::Result<void> remember(const JobStatus& job) = 0;
  virtual void forget(const JobId& id) = 0;
};

/// Thread-safe.
class JobQueue {
 public:
  /// Gives the result as JSON, or why there is none. Reports to the Progress, and returns Code::kCancelled
  /// soon after that says cancelled(). May throw; bad_alloc becomes kTooLarge, all else kInternal.
  using Work = std::function<tin::base::Result<std::string>(tin::base::Progress&)>;

  /// `memory`, if there is one, outlives the queue. `earlier` are the jobs of an earlier process, in the
  /// order in which they were submitted: those that had not finished are dismissed now.
  explicit JobQueue(const JobLimits& limits, JobMemory* memory = nullptr,
                    const std::vector<JobStatus>& earlier = {});
  ~JobQueue();
  JobQueue(const JobQueue&) = delete;
  JobQueue& operator=(const JobQueue&) = delete;

  /// Errors: kTooMany when the queue is full or stopped; those of the memory.
  tin::base::Result<JobId> submit(std::string kind, std::string description, Work work);

  /// Nothing when there is no such job, or no more.
  std::optional<JobStatus> status(std::string_view id) const;
  /// The status as soon as the job has finished, or when `timeout` is over.
  std::optional<JobStatus> wait(std::string_view id, std::chrono::milliseconds timeout) const;
  /// All jobs, the newest first.
  std::vector<JobStatus> list() const;

  /// A job that waits is dismissed at once. One that runs is asked to stop: it becomes dismissed when its
  /// work returns, or successful if that was done already; wait() tells. One that finished is dismissed, too:
  /// its result is dropped, and it is forgotten in its turn. Errors: kNotFound.
  tin::base::Result<void> dismiss(std::string_view id);

  /// Takes no more jobs, lets those that wait or run finish until `timeout` is over, then stops.
  void drain(std::chrono::milliseconds timeout);

  /// Dismisses all that wait or run, and returns when no work runs any more. Later submissions fail.
  void stop();

 private:
  struct Job;
  using JobPtr = std::shared_ptr<Job>;

  void run_worker();
  JobPtr next_job();
  void run(Job& job);
  void recall(const std::vector<JobStatus>& earlier);
  void finish(Job& job, JobState state, std::string message);  // with mutex_ held
  void bring_memory_up();                                      // without it
  JobPtr find(std::string_view id) const;                      // with mutex_ held

  const JobLimits limits_;
  JobMemory* const memory_;
  std::mutex memory_mutex_;  // before mutex_
  mutable std::mutex mutex_;
  std::vector<JobStatus> to_remember_;
  std::vector<JobId> to_forget_;
  mutable std::condition_variable finished_changed_;
  std::condition_variable queue_changed_;
  bool draining_ = false;
  bool stopped_ = false;
  std::deque<JobPtr> queued_;
  std::vector<JobPtr> running_;
  std::deque<JobPtr> finished_;                 // in the order of finishing
  std::map<JobId, JobPtr, std::less<>> by_id_;  // all of them
  std::uint64_t submitted_ = 0;
  std::mutex stop_mutex_;  // one joins, others wait for it
  std::vector<std::thread> workers_;
};

}  // namespace server::jobs
