#include "tin/mesh/page_allocator.h"

#include <gtest/gtest.h>

#include <cstring>
#include <random>
#include <vector>

#include "tests/support/point_sets.h"

namespace {

using tin::mesh::allocate_pages;
using tin::mesh::free_pages;
using tin::mesh::kept_pages;
using tin::mesh::kMostPagesKept;

constexpr std::size_t kMiB = std::size_t{1} << 20;

/// A block filled with a byte of its own.
struct Block {
  unsigned char* begin;
  std::size_t size;
  unsigned char mark;

  bool is_intact() const {
    for (std::size_t i = 0; i < size; i += 997) {
      if (begin[i] != mark) return false;
    }
    return begin[size - 1] == mark;
  }
};

Block make(std::size_t size, unsigned char mark) {
  auto* const begin = static_cast<unsigned char*>(allocate_pages(size));
  std::memset(begin, mark, size);
  return {begin, size, mark};
}

TEST(PageAllocatorTest, BlocksNeverOverlapThroughAnyHistory) {
  support::Random random(support::seed());
  testing::ScopedTrace trace(__FILE__, __LINE__, "TINSMITH_SEED=" + std::to_string(support::seed()));
  std::uniform_int_distribution<std::size_t> any_size(1, 24 * kMiB);
  std::vector<Block> blocks;
  for (int step = 0; step < 300; ++step) {
    if (blocks.size() < 12 && random() % 2 == 0) {
      blocks.push_back(make(any_size(random), static_cast<unsigned char>(step)));
      EXPECT_EQ(reinterpret_cast<std::uintptr_t>(blocks.back().begin) % 64, 0U);
    } else if (!blocks.empty()) {
      std::swap(blocks[random() % blocks.size()], blocks.back());
      EXPECT_TRUE(blocks.back().is_intact());
      free_pages(blocks.back().begin, blocks.back().size);
      blocks.pop_back();
    }
    EXPECT_LE(kept_pages(), kMostPagesKept);
  }
  for (const Block& block : blocks) {
    EXPECT_TRUE(block.is_intact());
    free_pages(block.begin, block.size);
  }
}

TEST(PageAllocatorTest, KeepsWhatIsGivenBackAndUsesItAgain) {
  const std::size_t before = kept_pages();
  void* const first = allocate_pages(10 * kMiB);
  free_pages(first, 10 * kMiB);
  if (kept_pages() == 0) return;  // a sanitizer's build keeps none
  EXPECT_GE(kept_pages(), before);
  const std::size_t kept = kept_pages();
  void* const again = allocate_pages(10 * kMiB);
  EXPECT_EQ(kept_pages(), kept - 10 * kMiB);
  free_pages(again, 10 * kMiB);
  EXPECT_EQ(kept_pages(), kept);
}

TEST(PageAllocatorTest, KeepsNoMoreThanItsLimit) {
  void* const large = allocate_pages(kMostPagesKept);  // never touched: costs no memory
  void* const more = allocate_pages(8 * kMiB);
  free_pages(large, kMostPagesKept);
  free_pages(more, 8 * kMiB);
  EXPECT_LE(kept_pages(), kMostPagesKept);
}

}  // namespace
