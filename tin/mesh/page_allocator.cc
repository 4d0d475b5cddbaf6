#include "tin/mesh/page_allocator.h"

#include <sys/mman.h>

#include <cstdint>

namespace tin::mesh {
namespace {

constexpr std::size_t kHugePage = std::size_t{2} << 20;
constexpr std::size_t kMapped = 2 * kHugePage;  // blocks of this size or more are mapped, smaller ones come from the heap
constexpr std::align_val_t kCacheLine{64};

std::size_t whole_pages(std::size_t bytes) { return (bytes + kHugePage - 1) / kHugePage * kHugePage; }

}  // namespace

void* allocate_pages(std::size_t bytes) {
  if (bytes < kMapped) return ::operator new(bytes, kCacheLine);
  const std::size_t size = whole_pages(bytes);
  void* const mapped = ::mmap(nullptr, size + kHugePage, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (mapped == MAP_FAILED) throw std::bad_alloc();
  char* const begin = static_cast<char*>(mapped);
  const std::size_t skip = (kHugePage - reinterpret_cast<std::uintptr_t>(begin) % kHugePage) % kHugePage;
  if (skip > 0) ::munmap(begin, skip);
  if (skip < kHugePage) ::munmap(begin + skip + size, kHugePage - skip);
  ::madvise(begin + skip, size, MADV_HUGEPAGE);  // advice: where it is refused small pages serve
  return begin + skip;
}

void free_pages(void* memory, std::size_t bytes) noexcept {
  if (bytes < kMapped) {
    ::operator delete(memory, kCacheLine);
  } else {
    ::munmap(memory, whole_pages(bytes));
  }
}

}  // namespace tin::mesh
