// Long arrays, in memory of the caller's choice.
//
//   Array<double> heights(count, 0.0, &memory);   // std::pmr::memory_resource
#pragma once

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

}  // namespace tin::base
