#include "tin/mesh/page_allocator.h"

#include <sys/mman.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <mutex>
#include <span>

namespace tin::mesh {
namespace {

constexpr std::size_t kHugePage = std::size_t{2} << 20;
constexpr std::size_t kMapped =
    2 * kHugePage;  // blocks of this size or more are mapped, smaller ones come from the heap
constexpr std::align_val_t kCacheLine{64};

#if defined(__SANITIZE_ADDRESS__)
constexpr bool kKeepsPages = false;  // so that a use after free is seen
#else
constexpr bool kKeepsPages = true;
#endif

std::size_t whole_pages(std::size_t bytes) { return (bytes + kHugePage - 1) / kHugePage * kHugePage; }

char* map(std::size_t size) {
  void* const mapped =
      ::mmap(nullptr, size + kHugePage, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (mapped == MAP_FAILED) throw std::bad_alloc();
  char* const begin = static_cast<char*>(mapped);
  const std::size_t skip = (kHugePage - reinterpret_cast<std::uintptr_t>(begin) % kHugePage) % kHugePage;
  if (skip > 0) ::munmap(begin, skip);
  if (skip < kHugePage) ::munmap(begin + skip + size, kHugePage - skip);
  ::madvise(begin + skip, size, MADV_HUGEPAGE);  // advice: where it is refused small pages serve
  return begin + skip;
}

/// The blocks that wait to be used again.
class KeptPages {
 public:
  /// A block of this size, cut off the smallest that has it; null without one.
  char* take(std::size_t size) {
    const std::lock_guard lock(mutex_);
    Block* best = nullptr;
    for (Block& block : std::span(blocks_).first(count_)) {
      if (block.size >= size && (best == nullptr || block.size < best->size)) best = &block;
    }
    if (best == nullptr) return nullptr;
    char* const begin = best->begin;
    best->begin += size;
    best->size -= size;
    bytes_ -= size;
    if (best->size == 0) *best = blocks_[--count_];
    return begin;
  }

  /// False when there is no room for it.
  bool keep(char* begin, std::size_t size) noexcept {
    const std::lock_guard lock(mutex_);
    if (bytes_ + size > kMostPagesKept) return false;
    bytes_ += size;
    // A block that adjoins becomes part of this one, so that many small ones serve a large one again.
    for (std::size_t i = 0; i < count_;) {
      const Block other = blocks_[i];
      if (other.begin + other.size != begin && begin + size != other.begin) {
        ++i;
        continue;
      }
      begin = std::min(begin, other.begin);
      size += other.size;
      blocks_[i] = blocks_[--count_];
    }
    if (count_ == blocks_.size()) {
      bytes_ -= size;
      return false;
    }
    blocks_[count_++] = {begin, size};
    return true;
  }

  std::size_t bytes() noexcept {
    const std::lock_guard lock(mutex_);
    return bytes_;
  }

 private:
  struct Block {
    char* begin;
    std::size_t size;
  };
  std::mutex mutex_;
  std::array<Block, kMostPagesKept / kMapped>
      blocks_{};  // a block is no smaller: they never run out but for remainders
  std::size_t count_ = 0, bytes_ = 0;
};

/// Never destroyed: arrays with static lifetime may be given back later than anything else.
KeptPages& kept() {
  static KeptPages* const pages = new KeptPages;
  return *pages;
}

}  // namespace

void* allocate_pages(std::size_t bytes) {
  if (bytes < kMapped) return ::operator new(bytes, kCacheLine);
  const std::size_t size = whole_pages(bytes);
  char* const again = kKeepsPages ? kept().take(size) : nullptr;
  return again != nullptr ? again : map(size);
}

void free_pages(void* memory, std::size_t bytes) noexcept {
  if (bytes < kMapped) return ::operator delete(memory, kCacheLine);
  const std::size_t size = whole_pages(bytes);
  if (kKeepsPages) {
    ::madvise(memory, size, MADV_FREE);  // its contents may go when memory is short
    if (kept().keep(static_cast<char*>(memory), size)) return;
  }
  ::munmap(memory, size);
}

std::size_t kept_pages() noexcept { return kKeepsPages ? kept().bytes() : 0; }

}  // namespace tin::mesh
