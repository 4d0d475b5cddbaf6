#include "server/app/fair_mutex.h"

namespace server::app {

void FairSharedMutex::lock() {
  const std::lock_guard gate(gate_);
  mutex_.lock();
}

bool FairSharedMutex::try_lock_shared() {
  const std::unique_lock gate(gate_, std::try_to_lock);
  return gate && mutex_.try_lock_shared();
}

void FairSharedMutex::lock_shared() {
  const std::lock_guard gate(gate_);
  mutex_.lock_shared();
}

}  // namespace server::app
