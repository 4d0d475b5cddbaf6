// Long arrays, in memory of the caller's choice.
//
//   Array<double> heights = filled<double>(count, 0.0, &memory);   // std::pmr::memory_resource
//   const Pace pace(&memory);
//   for (...) { work_through(row); pace.touched(1, row_bytes); }
#pragma once

#include <algorithm>
#include <cstddef>
#include <memory_resource>
#include <type_traits>
#include <vector>

namespace tin::base {

/// As std::pmr::polymorphic_allocator, but what is moved takes its memory along, also by assignment.
template <class T>
class MemoryOf {
 public:
  using value_type = T;
  using propagate_on_container_move_assignment = std::true_type;
  using propagate_on_container_swap = std::true_type;

  MemoryOf() = default;
  // NOLINTNEXTLINE(google-explicit-constructor): as polymorphic_allocator
  MemoryOf(std::pmr::memory_resource* memory) : memory_(memory) {}
  template <class U>
  MemoryOf(const MemoryOf<U>& other) : memory_(other.memory()) {}  // NOLINT(google-explicit-constructor)

  T* allocate(std::size_t count) { return static_cast<T*>(memory_->allocate(count * sizeof(T), alignof(T))); }
  void deallocate(T* items, std::size_t count) { memory_->deallocate(items, count * sizeof(T), alignof(T)); }
  std::pmr::memory_resource* memory() const { return memory_; }

  friend bool operator==(const MemoryOf& a, const MemoryOf& b) { return a.memory_->is_equal(*b.memory_); }

 private:
  std::pmr::memory_resource* memory_ = std::pmr::get_default_resource();
};

/// Requires: the memory outlives it, and what it was moved to.
template <class T>
using Array = std::vector<T, MemoryOf<T>>;

/// Memory that lets go of parts of itself while nobody needs them, and so wants to hear what is touched.
class PacedMemory : public std::pmr::memory_resource {
 public:
  /// Since they last said so somebody has touched up to `pieces` stretches of `bytes_each` bytes. Any thread.
  virtual void touched(std::size_t pieces, std::size_t bytes_each) = 0;
};

/// Tells a memory what is touched of it, if it wants to know. Those who work through long arrays do so every
/// few megabytes at the latest: so much more than it means to may be resident.
class Pace {
 public:
  Pace() = default;
  /// Requires: the memory outlives it.
  explicit Pace(std::pmr::memory_resource* memory) : memory_(dynamic_cast<PacedMemory*>(memory)) {}
  bool is_asked_for() const { return memory_ != nullptr; }
  void touched(std::size_t pieces, std::size_t bytes_each) const {
    if (memory_ != nullptr) memory_->touched(pieces, bytes_each);
  }

 private:
  PacedMemory* memory_ = nullptr;
};

/// So many bytes are worked through between two words about it.
inline constexpr std::size_t kPaceBytes = std::size_t{1} << 20;

/// `count` times `value`. Cost: linear; one allocation.
template <class T>
Array<T> filled(std::size_t count, const T& value, std::pmr::memory_resource* memory) {
  constexpr std::size_t kAtOnce = kPaceBytes / sizeof(T);
  const Pace pace(memory);
  Array<T> out(memory);
  out.reserve(count);
  while (out.size() < count) {
    const std::size_t more = std::min(count - out.size(), kAtOnce);
    out.resize(out.size() + more, value);
    pace.touched(1, more * sizeof(T));
  }
  return out;
}

}  // namespace tin::base
