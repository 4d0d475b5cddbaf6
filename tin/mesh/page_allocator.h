// Memory for the mesh's big arrays: asked from the system in huge pages where it gives them, since a random
// access to a large mesh costs a TLB miss per 4 KiB page, and left uninitialised, since bulk building writes
// every element.
//
// Blocks that are given back are kept for the next arrays, up to a limit: a page that is new to the process
// must be found and cleared by the system, which can take as long as building the mesh on it. The system is
// told that it may take kept pages away when memory is short.
#pragma once

#include <cstddef>
#include <new>
#include <type_traits>
#include <utility>
#include <vector>

namespace tin::mesh {

/// At least 64-byte aligned; big blocks are whole huge pages. Throws std::bad_alloc. Safe on several threads.
void* allocate_pages(std::size_t bytes);
void free_pages(void* memory, std::size_t bytes) noexcept;

/// What is kept at most, and what is kept now.
inline constexpr std::size_t kMostPagesKept = std::size_t{512} << 20;
std::size_t kept_pages() noexcept;

/// An allocator over allocate_pages() whose vector::resize() leaves new elements of plain types as they are:
/// unknown.
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
  void construct(U*) noexcept {
    static_assert(std::is_trivially_copyable_v<U>);  // begins to live with the memory
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
