// Bounds on how many requests may do something long at once.
#pragma once

#include <cstddef>
#include <semaphore>

namespace server::api {

/// So many places; thread-safe.
using Slots = std::counting_semaphore<>;

/// A place, if one was free, until the end of the scope.
class Slot {
 public:
  explicit Slot(Slots& slots) : slots_(slots), taken_(slots.try_acquire()) {}
  ~Slot() {
    if (taken_) slots_.release();
  }
  Slot(const Slot&) = delete;
  Slot& operator=(const Slot&) = delete;
  bool taken() const { return taken_; }

 private:
  Slots& slots_;
  const bool taken_;
};

}  // namespace server::api
