// Bounds on how many requests may do something long at once.
#pragma once

#include <atomic>
#include <cstddef>
#include <utility>

namespace server::api {

/// So many places; thread-safe.
class Slots {
 public:
  explicit Slots(std::ptrdiff_t places) : free_(places), places_(places) {}

  bool try_acquire() {
    std::ptrdiff_t free = free_.load(std::memory_order_relaxed);
    while (free > 0) {
      if (free_.compare_exchange_weak(free, free - 1)) return true;
    }
    return false;
  }
  void release() { ++free_; }
  /// How many are taken now.
  std::ptrdiff_t taken() const { return places_ - free_.load(std::memory_order_relaxed); }

 private:
  std::atomic<std::ptrdiff_t> free_;
  const std::ptrdiff_t places_;
};

/// A place, if one was free, until the end of the scope.
class Slot {
 public:
  explicit Slot(Slots& slots) : slots_(slots.try_acquire() ? &slots : nullptr) {}
  Slot(Slot&& other) noexcept : slots_(std::exchange(other.slots_, nullptr)) {}
  Slot& operator=(Slot&&) = delete;
  ~Slot() {
    if (slots_ != nullptr) slots_->release();
  }
  bool taken() const { return slots_ != nullptr; }

 private:
  Slots* slots_;
};

}  // namespace server::api
