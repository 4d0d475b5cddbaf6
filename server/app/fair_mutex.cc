#include "server/app/fair_mutex.h"

namespace server::app {

void FairSharedMutex::lock() {
  const std::lock_guard gate(gate_);
  mutex_.lock();
}

void FairSharedMutex::lock_shared() {
  const std::lock_guard gate(gate_);
  mutex_.lock_shared();
}

}  // namespace server::app
