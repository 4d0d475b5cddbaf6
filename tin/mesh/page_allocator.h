// Memory for the mesh's big arrays: asked from the system in huge pages where it gives them, since a random access
// to a large mesh costs a TLB miss per 4 KiB page, and left uninitialised, since bulk building writes every element.
#pragma once

#include <cstddef>
#include <new>
#include <type_traits>
#include <utility>
#include <vector>

namespace tin::mesh {

/// At least 64-byte aligned; big blocks are whole huge pages. Throws std::bad_alloc.
void* allocate_pages(std::size_t bytes);
void free_pages(void* memory, std::size_t bytes) noexcept;

/// An allocator over allocate_pages() whose vector::resize() default-initialises: new elements of plain types hold nothing.
template <class T>
class PageAllocator {
 public:
  using value_type = T;
  PageAllocator() = default;
  template <class U>
  explicit PageAllocator(const PageAllocator<U>&) noexcept {}

  T* allocate(std::size_t count) { return static_cast<T*>(allocate_pages(count * sizeof(T))); }
  void deallocate(T* memory, std::size_t count) noexcept { free_pages(memory, count * sizeof(T)); }

  template <class U>
  void construct(U* at) noexcept {
    static_assert(std::is_trivially_destructible_v<U>);
    ::new (static_cast<void*>(at)) U;
  }
  template <class U, class... Args>
  void construct(U* at, Args&&... args) {
    ::new (static_cast<void*>(at)) U(std::forward<Args>(args)...);
  }
  friend bool operator==(const PageAllocator&, const PageAllocator&) { return true; }
};

template <class T>
using PageVector = std::vector<T, PageAllocator<T>>;

}  // namespace tin::mesh
