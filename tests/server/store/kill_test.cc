// Nothing acknowledged is lost: a child appends and says so through a pipe until it is killed; then all that
// it said is there.
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <random>
#include <thread>

#include "tests/server/store/store_kinds.h"

namespace server::store {
namespace {

constexpr std::uint64_t kCheckpointEvery = 7;

std::string record_of(std::uint64_t revision) {
  return std::string(1 + revision * 37 % 900, static_cast<char>('a' + revision % 26));
}

std::string checkpoint_of(std::uint64_t revision) {
  return "state " + std::to_string(revision) + std::string(revision * 997 % 20000, '.');
}

class KillTest : public testing::AnyStore {
 protected:
  // In the child: goes on from where the store is, and never returns.
  [[noreturn]] void append_for_ever(int acknowledge) {
    auto opened = GetParam().open(folder_.path());
    if (!opened.ok()) _exit(3);
    const std::unique_ptr<Store> store = *std::move(opened);
    const auto loaded = store->load("t");
    if (!loaded.ok()) _exit(4);
    for (std::uint64_t revision = loaded->checkpoint_revision + loaded->journal.size() + 1;; ++revision) {
      if (!testing::append(*store, "t", revision, record_of(revision), {}).ok()) _exit(5);
      if (::write(acknowledge, &revision, sizeof revision) != sizeof revision) _exit(6);
      const bool due = revision % kCheckpointEvery == 0;
      if (due && !store->put_checkpoint("t", revision, checkpoint_of(revision)).ok()) _exit(7);
    }
  }

  // Runs a child for `life` and kills it; the last revision that it acknowledged, or 0.
  std::uint64_t run_and_kill(std::chrono::microseconds life) {
    int ends[2];
    EXPECT_EQ(::pipe(ends), 0);
    const pid_t child = ::fork();
    if (child == 0) {
      ::close(ends[0]);
      append_for_ever(ends[1]);
    }
    ::close(ends[1]);
    std::this_thread::sleep_for(life);
    ::kill(child, SIGKILL);
    std::uint64_t last = 0;
    for (std::uint64_t revision = 0; ::read(ends[0], &revision, sizeof revision) == sizeof revision;)
      last = revision;
    ::close(ends[0]);
    int status = 0;
    EXPECT_EQ(::waitpid(child, &status, 0), child);
    EXPECT_TRUE(WIFSIGNALED(status)) << "the child gave up with " << WEXITSTATUS(status);
    return last;
  }

  // Everything up to `acknowledged` must be there and be right; what was under way may be there too.
  void expect_whole(std::uint64_t acknowledged) {
    const auto loaded = store_->load("t");
    ASSERT_TRUE(testing::succeeds(loaded));
    const std::uint64_t last = loaded->checkpoint_revision + loaded->journal.size();
    EXPECT_GE(last, acknowledged);
    EXPECT_LE(last, acknowledged + 1);
    EXPECT_EQ(loaded->checkpoint, checkpoint_of(loaded->checkpoint_revision));
    EXPECT_TRUE(loaded->checkpoint_revision == 1 || loaded->checkpoint_revision % kCheckpointEvery == 0);
    for (const JournalRow& row : loaded->journal) EXPECT_EQ(row.record, record_of(row.revision));
  }
};

INSTANTIATE_TEST_SUITE_P(All, KillTest, ::testing::ValuesIn(testing::store_kinds()), testing::name_of);

TEST_P(KillTest, NothingAcknowledgedIsLost) {
  std::mt19937 random{std::random_device{}()};
  ASSERT_TRUE(testing::succeeds(store_->create_tin({"t", "", 0}, 1, checkpoint_of(1))));
  std::uint64_t acknowledged = 1;
  for (int round = 0; round < 50 && !HasFailure(); ++round) {
    close();
    const std::chrono::microseconds life(std::uniform_int_distribution<int>(1000, 60000)(random));
    acknowledged = std::max(acknowledged, run_and_kill(life));
    open();
    expect_whole(acknowledged);
    const auto loaded = store_->load("t");
    acknowledged = loaded->checkpoint_revision + loaded->journal.size();  // what survived once must stay
  }
  EXPECT_GT(acknowledged, 10u);
}

}  // namespace
}  // namespace server::store
