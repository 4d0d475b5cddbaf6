// Memory runs out at every place, one after the other: what was acknowledged is there, what was refused has
// changed nothing, and the next edit is taken.
#include <gtest/gtest.h>

#include <atomic>
#include <cstdlib>
#include <new>

#include "tests/faults/scenario.h"
#include "tests/support/temp_dir.h"

namespace {

std::atomic<long> left{0};  // allocations until one fails; 0: none does
std::atomic<bool> struck{false};

void* allocate(std::size_t size, std::size_t alignment) {
  if (left.load(std::memory_order_relaxed) > 0 && left.fetch_sub(1) == 1) {
    struck = true;
    throw std::bad_alloc();
  }
  void* const memory = alignment <= alignof(std::max_align_t)
                           ? std::malloc(size)
                           : std::aligned_alloc(alignment, (size + alignment - 1) / alignment * alignment);
  if (memory == nullptr) throw std::bad_alloc();
  return memory;
}

}  // namespace

void* operator new(std::size_t size) {
  return allocate(size, 1);
}
void* operator new(std::size_t size, std::align_val_t alignment) {
  return allocate(size, static_cast<std::size_t>(alignment));
}
void operator delete(void* memory) noexcept {
  std::free(memory);
}
void operator delete(void* memory, std::size_t) noexcept {
  std::free(memory);
}
void operator delete(void* memory, std::align_val_t) noexcept {
  std::free(memory);
}
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept {
  std::free(memory);
}

namespace tests::faults {
namespace {

using server::app::WorldEdit;

/// `act` with each of its allocations failing in turn; it may throw. `settle` runs after each, and must succeed.
template <class Act, class Settle>
void with_every_failure(Scenario& scenario, Act act, Settle settle) {
  for (long nth = 1;; ++nth) {
    SCOPED_TRACE("allocation " + std::to_string(nth));
    struck = false;
    left = nth;
    try {
      act();
    } catch (const std::bad_alloc&) {
    }
    left = 0;
    // The edit is in, or it is not: both are sound, and revisions, readers and store agree.
    const auto version = scenario.tin().version();
    const auto extent = scenario.store().journal_extent("t");
    ASSERT_TRUE(extent.ok());
    ASSERT_EQ(extent->last, version.revision);
    const auto stored = server::app::Tin::load(scenario.store(), "t");
    ASSERT_TRUE(stored.ok());
    ASSERT_EQ(stored->terrain.digest(), version.terrain->digest());
    ASSERT_TRUE(scenario.edit_once());
    ASSERT_EQ(scenario.broken_for_readers(), "");
    ASSERT_TRUE(settle());
    if (!struck) break;
    ASSERT_LT(nth, 100'000);
  }
}

TEST(AllocationTest, AnEditSurvivesTheFailureOfEachOfItsAllocations) {
  const support::TempDir folder;
  Scenario scenario(folder.path(), {});
  ASSERT_TRUE(scenario.edit_once());
  int number = 0;
  with_every_failure(scenario, [&] {
    const std::vector<WorldEdit> edits{server::app::InsertAt{3.3 + 0.001 * ++number, 4.4, 5},
                                       tin::terrain::SetZ{server::app::VertexId(12), 100.0 + number}};
    const std::uint64_t before = scenario.tin().revision();
    const auto edited = scenario.tin().edit(
        edits, {{}, {}, server::app::RequestKey{"key-of-edit-" + std::to_string(number), "request"}});
    EXPECT_EQ(scenario.tin().revision(), before + (edited.ok() ? 1 : 0));
  }, [] { return true; });
}

TEST(AllocationTest, AnUndoSurvivesTheFailureOfEachOfItsAllocations) {
  const support::TempDir folder;
  Scenario scenario(folder.path(), {});
  ASSERT_TRUE(scenario.edit_once());
  with_every_failure(scenario,
                     [&] { static_cast<void>(scenario.tin().revert(scenario.tin().revision(), {})); },
                     [] { return true; });
}

TEST(AllocationTest, ACheckpointSurvivesTheFailureOfEachOfItsAllocations) {
  const support::TempDir folder;
  server::store::SqliteOptions options;
  options.checkpoint_row_bytes = 500;
  Scenario scenario(folder.path(), options);
  ASSERT_TRUE(scenario.edit_once());
  // One more edit each time is all that there is to fold in: else the work would grow as fast as the number that fails.
  with_every_failure(scenario, [&] { static_cast<void>(scenario.tin().write_checkpoint()); },
                     [&] { return scenario.tin().write_checkpoint().ok() && scenario.edit_once(); });
}

}  // namespace
}  // namespace tests::faults
