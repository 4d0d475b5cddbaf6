// Every write and every sync fails once, one after the other; the disk is full, and is freed. What was
// acknowledged is there, what was refused has changed nothing, reading goes on, and no write is taken on
// trust after the disk failed.
#include <gtest/gtest.h>

#include "tests/faults/faulty_disk.h"
#include "tests/faults/scenario.h"
#include "tests/support/temp_dir.h"

namespace tests::faults {
namespace {

class FailingDiskTest : public testing::Test {
 protected:
  // The scenario with the nth such operation failing.
  /// Whether there was an nth one: how many there are depends on which edits share a commit.
  bool run_with_failure(Operation operation, std::uint64_t nth, Failure failure) {
    SCOPED_TRACE("operation " + std::to_string(nth));
    const support::TempDir folder;
    FaultyDisk disk;
    std::uint64_t revision = 0;
    std::string digest;
    bool struck = false;
    {
      Scenario scenario(folder.path(), disk.options());
      disk.fail_at(operation, nth, failure);
      scenario.run();
      struck = disk.failed();
      EXPECT_EQ(scenario.broken_for_readers(), "");
      disk.fail_at(operation, 0, failure);
      const bool taken = scenario.edit_once();
      EXPECT_EQ(taken, scenario.store().writable().ok());
      if (failure == Failure::kFull) {
        EXPECT_TRUE(taken) << "there is room again";
      }
      EXPECT_EQ(scenario.broken_for_readers(), "");
      revision = scenario.revision();
      digest = scenario.digest();
    }
    EXPECT_EQ(broken_on_disk(folder.path(), revision, digest), "");
    return struck;
  }

  void every(Operation operation, Failure failure) {
    std::uint64_t most = 0;
    {
      const support::TempDir folder;
      FaultyDisk disk;
      Scenario scenario(folder.path(), disk.options());
      const std::uint64_t before = disk.count(operation);
      scenario.run();
      most = disk.count(operation) - before;
      EXPECT_EQ(scenario.revision(), 7U) << "without a failure everything is taken";
    }
    ASSERT_GT(most, 10U);
    std::uint64_t struck = 0;
    for (std::uint64_t nth = 1; nth <= most && !HasFailure(); ++nth)
      struck += run_with_failure(operation, nth, failure) ? 1 : 0;
    EXPECT_GE(struck, most * 3 / 4);
  }
};

TEST_F(FailingDiskTest, EveryWriteFailsOnce) {
  every(Operation::kWrite, Failure::kBroken);
}

TEST_F(FailingDiskTest, EverySyncFailsOnce) {
  every(Operation::kSync, Failure::kBroken);
}

TEST_F(FailingDiskTest, EveryWriteFindsNoRoomOnce) {
  every(Operation::kWrite, Failure::kFull);
}

TEST_F(FailingDiskTest, AFullDiskRefusesEditsAndTakesThemAgainWhenThereIsRoom) {
  const support::TempDir folder;
  FaultyDisk disk;
  Scenario scenario(folder.path(), disk.options());
  ASSERT_TRUE(scenario.edit_once());
  disk.set_full(true);
  for (int i = 0; i < 5; ++i) {
    const auto refused = scenario.tin().edit(
        std::vector<server::app::WorldEdit>{tin::terrain::SetZ{server::app::VertexId(1), 5}}, {});
    ASSERT_FALSE(refused.ok());
    EXPECT_EQ(refused.error().code, tin::base::Code::kNoSpace);
    EXPECT_EQ(scenario.broken_for_readers(), "");
  }
  EXPECT_TRUE(scenario.store().writable().ok()) << "a full disk is not a broken one";
  disk.set_full(false);
  EXPECT_TRUE(scenario.edit_once());
  EXPECT_EQ(scenario.broken_for_readers(), "");
}

TEST_F(FailingDiskTest, AfterAFailedSyncEditsAreRefusedUntilARestart) {
  const support::TempDir folder;
  FaultyDisk disk;
  std::uint64_t revision = 0;
  std::string digest;
  {
    Scenario scenario(folder.path(), disk.options());
    ASSERT_TRUE(scenario.edit_once());
    disk.fail_at(Operation::kSync, 1, Failure::kBroken);
    for (int i = 0; i < 3; ++i) EXPECT_FALSE(scenario.edit_once());
    EXPECT_FALSE(scenario.store().writable().ok());
    EXPECT_EQ(scenario.broken_for_readers(), "");
    revision = scenario.revision();
    digest = scenario.digest();
  }
  EXPECT_EQ(broken_on_disk(folder.path(), revision, digest), "");
  Scenario again(folder.path(), disk.options());
  EXPECT_TRUE(again.edit_once());
}

}  // namespace
}  // namespace tests::faults
