// Group commit: one thread that writes, and takes all writes that wait into one transaction. A sync of the
// disk costs the same for one edit and for a hundred.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <functional>
#include <mutex>
#include <optional>
#include <thread>
#include <vector>

#include "server/store/sqlite_internal.h"
#include "server/store/store.h"
#include "tin/base/result.h"

namespace server::store {

/// Thread-safe. The database belongs to its thread from construction to destruction.
class Committer {
 public:
  /// One write: all or nothing of it happens. It may run twice, when others of its group failed.
  using Work = std::function<tin::base::Result<void>(Database&)>;

  explicit Committer(Database& database);
  ~Committer();  // ends when all that was given is done
  Committer(const Committer&) = delete;
  Committer& operator=(const Committer&) = delete;

  /// Returns when the write is durable, or refused. Errors: those of `work`; kNoSpace; kStorage.
  tin::base::Result<void> commit(const Work& work);

  /// An error once the disk failed: nothing is written any more.
  tin::base::Result<void> writable() const;
  Store::Counts counts() const;

 private:
  struct Waiting;  // a caller, on its own stack

  void run();
  void commit_group(const std::vector<Waiting*>& group);
  tin::base::Result<void> try_group(const std::vector<Waiting*>& group);
  tin::base::Result<void> run_within_savepoint(const Work& work);
  void cut_log_back();

  Database& database_;
  mutable std::mutex mutex_;
  std::condition_variable given_;
  std::vector<Waiting*> waiting_;
  bool ending_ = false;
  std::optional<tin::base::Error> failed_;
  Store::Counts counts_;
  std::thread thread_;  // last: it uses the rest
};

}  // namespace server::store
