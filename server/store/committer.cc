#include "server/store/committer.h"

#include <chrono>
#include <exception>
#include <new>
#include <utility>

namespace server::store {
namespace {

using tin::base::Code;
using tin::base::Result;

constexpr std::size_t kMostInGroup = 1024;
// SQLite would write the log into the database within a commit, while clients wait; here it is done after
// they have their answers, when the log has so many pages.
constexpr int kLogPages = 2000;

}  // namespace

struct Committer::Waiting {
  const Work& work;
  Result<void> result = {};  // of the work
  bool durable = false;      // whatever goes wrong elsewhere, only this acknowledges
  bool done = false;
  std::condition_variable changed = {};
};

Committer::Committer(Database& database) : database_(database) {
  waiting_.reserve(kMostInGroup);
  thread_ = std::thread([this] { run(); });
}

Committer::~Committer() {
  {
    const std::lock_guard guard(mutex_);
    ending_ = true;
  }
  given_.notify_one();
  thread_.join();
}

Result<void> Committer::commit(const Work& work) {
  Waiting self{work};
  std::unique_lock lock(mutex_);
  if (failed_) return *failed_;
  waiting_.push_back(&self);
  ++counts_.waiting;
  given_.notify_one();
  self.changed.wait(lock, [&] { return self.done; });
  --counts_.waiting;
  if (self.durable || !self.result.ok()) return std::move(self.result);
  return tin::base::error(Code::kStorage, "the write was not committed");
}

Result<void> Committer::writable() const {
  const std::lock_guard guard(mutex_);
  return failed_ ? Result<void>(*failed_) : Result<void>();
}

Store::Counts Committer::counts() const {
  const std::lock_guard guard(mutex_);
  return counts_;
}

void Committer::run() {
  std::vector<Waiting*> group;
  group.reserve(kMostInGroup);
  std::unique_lock lock(mutex_);
  for (;;) {
    given_.wait(lock, [this] { return ending_ || !waiting_.empty(); });
    if (waiting_.empty()) return;
    const std::size_t size = std::min(waiting_.size(), kMostInGroup);
    group.assign(waiting_.begin(), waiting_.begin() + static_cast<std::ptrdiff_t>(size));
    waiting_.erase(waiting_.begin(), waiting_.begin() + static_cast<std::ptrdiff_t>(size));
    lock.unlock();
    const auto begin = std::chrono::steady_clock::now();
    try {
      commit_group(group);
    } catch (const std::bad_alloc&) {  // while saying what went wrong; nobody is acknowledged by that
    }
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begin;
    lock.lock();
    counts_.seconds += took.count();
    if (database_.disk_failed() && !failed_) {
      failed_ = tin::base::error(
          Code::kStorage, "the disk failed under a write: nothing is written until a restart, reads go on");
    }
    for (Waiting* one : group) {
      counts_.writes += one->durable && one->result.ok() ? 1 : 0;
      one->done = true;
      one->changed.notify_one();
    }
    lock.unlock();
    cut_log_back();
    lock.lock();
  }
}

/// What cannot be committed together is tried one by one: a write that is too large for the disk must not
/// take the others with it.
void Committer::commit_group(const std::vector<Waiting*>& group) {
  const auto together = try_group(group);
  if (together.ok()) return;
  if (group.size() == 1 || database_.disk_failed()) {
    for (Waiting* one : group) one->result = together;
    return;
  }
  for (Waiting* one : group) {
    one->result = {};
    const auto alone = try_group({one});
    if (!alone.ok()) one->result = alone;
  }
}

/// Results of the writes are in `group` when it succeeds. Errors: those that concern the whole transaction.
Result<void> Committer::try_group(const std::vector<Waiting*>& group) {
  // After a failed write or sync nobody knows what the disk holds, and a later sync may succeed without the
  // pages that were lost: only reading the file anew tells.
  if (database_.disk_failed()) {
    return tin::base::error(Code::kStorage, "the disk failed earlier: nothing is written until a restart");
  }
  try {
    Transaction transaction(database_);
    if (!transaction.begun().ok()) return transaction.begun();
    bool any = false;
    for (Waiting* one : group) {
      one->result = run_within_savepoint(one->work);
      if (!database_.in_transaction()) return one->result;  // SQLite took all of it back: no room, no memory
      any = any || one->result.ok();
    }
    if (!any) return {};
    auto committed = transaction.commit();
    if (!committed.ok()) return committed;
    for (Waiting* one : group) one->durable = true;
    const std::lock_guard guard(mutex_);
    ++counts_.commits;
    return {};
  } catch (const std::bad_alloc&) {
    return tin::base::error(Code::kStorage, "there is not enough memory to write");
  } catch (const std::exception& exception) {
    return tin::base::error(Code::kInternal, std::string("a write failed: ") + exception.what());
  }
}

Result<void> Committer::run_within_savepoint(const Work& work) {
  if (auto begun = database_.execute("SAVEPOINT one"); !begun.ok()) return begun;
  Result<void> done;
  try {
    done = work(database_);
  } catch (const std::bad_alloc&) {
    done = tin::base::error(Code::kStorage, "there is not enough memory to write");
  }
  if (!done.ok() && database_.in_transaction()) {
    if (auto back = database_.execute("ROLLBACK TO one"); !back.ok()) return back;
  }
  if (database_.in_transaction()) {
    if (auto released = database_.execute("RELEASE one"); !released.ok() && done.ok()) return released;
  }
  return done;
}

void Committer::cut_log_back() {
  if (database_.log_pages() < kLogPages || database_.disk_failed()) return;
  // A failure shows in disk_failed(); a full disk or a reader in the way lets the log grow until the next
  // time.
  database_.checkpoint_log();
}

}  // namespace server::store
