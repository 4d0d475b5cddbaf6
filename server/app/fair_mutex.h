// A readers-writer lock in which a stream of readers cannot starve the writer.
#pragma once

#include <mutex>
#include <shared_mutex>

namespace server::app {

/// Satisfies SharedLockable. Whoever wants to write closes a gate first: later readers wait behind it.
class FairSharedMutex {
 public:
  void lock();
  void unlock() { mutex_.unlock(); }
  void lock_shared();
  bool try_lock_shared();
  void unlock_shared() { mutex_.unlock_shared(); }

 private:
  std::mutex gate_;
  std::shared_mutex mutex_;
};

}  // namespace server::app
