// What every store promises.
#include "server/store/store.h"

#include <gtest/gtest.h>

#include <thread>

#include "tests/server/store/store_kinds.h"

namespace server::store {
namespace {

using testing::append;
using testing::fails;
using testing::succeeds;
using tin::base::Code;

class StoreTest : public testing::AnyStore {};
INSTANTIATE_TEST_SUITE_P(All, StoreTest, ::testing::ValuesIn(testing::store_kinds()), testing::name_of);

const TinRecord kAlps{"alps", "The Alps", 1700000000123};
const RevisionInfo kInfo{1700000001000, "ada", "fixed the summit"};

TEST_P(StoreTest, IsEmptyAtFirst) {
  const auto tins = store_->list();
  ASSERT_TRUE(succeeds(tins));
  EXPECT_TRUE(tins->empty());
}

TEST_P(StoreTest, WhatIsPutInComesOut) {
  ASSERT_TRUE(succeeds(store_->create_tin(kAlps, 1, "checkpoint")));
  ASSERT_TRUE(succeeds(append(*store_, "alps", 2, "record", kInfo)));
  for (int round = 0; round < 2; ++round) {
    const auto loaded = store_->load("alps");
    ASSERT_TRUE(succeeds(loaded));
    EXPECT_EQ(loaded->tin, kAlps);
    EXPECT_EQ(loaded->checkpoint_revision, 1u);
    EXPECT_EQ(loaded->checkpoint, "checkpoint");
    EXPECT_EQ(loaded->journal, (std::vector<JournalRow>{{2, "record", kInfo}}));
    reopen();
  }
}

TEST_P(StoreTest, AnyBytesAndAnyTextAreKept) {
  const std::string bytes("\0\xff' \"; DROP\0", 12);
  const TinRecord tin{bytes, bytes, -5};
  const RevisionInfo info{-1, bytes, bytes};
  ASSERT_TRUE(succeeds(store_->create_tin(tin, 0, bytes)));
  ASSERT_TRUE(succeeds(append(*store_, bytes, 1, bytes, info)));
  ASSERT_TRUE(succeeds(append(*store_, bytes, 2, "", {})));
  const auto loaded = store_->load(bytes);
  ASSERT_TRUE(succeeds(loaded));
  EXPECT_EQ(loaded->tin, tin);
  EXPECT_EQ(loaded->checkpoint, bytes);
  EXPECT_EQ(loaded->journal, (std::vector<JournalRow>{{1, bytes, info}, {2, "", {}}}));
}

TEST_P(StoreTest, ListsById) {
  for (const std::string id : {"b", "c", "a"})
    ASSERT_TRUE(succeeds(store_->create_tin({id, "t " + id, 7}, 1, "")));
  const auto tins = store_->list();
  ASSERT_TRUE(succeeds(tins));
  EXPECT_EQ(*tins, (std::vector<TinRecord>{{"a", "t a", 7}, {"b", "t b", 7}, {"c", "t c", 7}}));
}

TEST_P(StoreTest, AnIdIsTakenOnce) {
  ASSERT_TRUE(succeeds(store_->create_tin(kAlps, 1, "first")));
  EXPECT_TRUE(fails(store_->create_tin({"alps", "other", 0}, 9, "second"), Code::kConflict));
  const auto loaded = store_->load("alps");
  ASSERT_TRUE(succeeds(loaded));
  EXPECT_EQ(loaded->tin, kAlps);
  EXPECT_EQ(loaded->checkpoint, "first");
}

TEST_P(StoreTest, UnknownTinsAreNotFound) {
  EXPECT_TRUE(fails(store_->load("alps"), Code::kNotFound));
  EXPECT_TRUE(fails(store_->load_source("alps"), Code::kNotFound));
  EXPECT_TRUE(fails(append(*store_, "alps", 1, "", {}), Code::kNotFound));
  EXPECT_TRUE(fails(store_->put_checkpoint("alps", 1, ""), Code::kNotFound));
  EXPECT_TRUE(fails(store_->update_title("alps", ""), Code::kNotFound));
  EXPECT_TRUE(fails(store_->remove_tin("alps"), Code::kNotFound));
}

TEST_P(StoreTest, OnlyTheSuccessorIsAppended) {
  ASSERT_TRUE(succeeds(store_->create_tin(kAlps, 5, "")));
  for (const std::uint64_t wrong : {0, 4, 5, 7}) {
    EXPECT_TRUE(fails(append(*store_, "alps", wrong, "wrong", {}), Code::kConflict)) << wrong;
  }
  ASSERT_TRUE(succeeds(append(*store_, "alps", 6, "six", {})));
  for (const std::uint64_t wrong : {5, 6, 8}) {
    EXPECT_TRUE(fails(append(*store_, "alps", wrong, "wrong", {}), Code::kConflict)) << wrong;
  }
  ASSERT_TRUE(succeeds(append(*store_, "alps", 7, "seven", {})));
  const auto loaded = store_->load("alps");
  ASSERT_TRUE(succeeds(loaded));
  EXPECT_EQ(loaded->journal, (std::vector<JournalRow>{{6, "six", {}}, {7, "seven", {}}}));
}

TEST_P(StoreTest, ACheckpointShortensTheReplay) {
  ASSERT_TRUE(succeeds(store_->create_tin(kAlps, 1, "one")));
  for (std::uint64_t revision = 2; revision <= 4; ++revision) {
    ASSERT_TRUE(succeeds(append(*store_, "alps", revision, std::to_string(revision), {})));
  }
  ASSERT_TRUE(succeeds(store_->put_checkpoint("alps", 3, "three")));
  for (int round = 0; round < 2; ++round) {
    const auto loaded = store_->load("alps");
    ASSERT_TRUE(succeeds(loaded));
    EXPECT_EQ(loaded->checkpoint_revision, 3u);
    EXPECT_EQ(loaded->checkpoint, "three");
    EXPECT_EQ(loaded->journal, (std::vector<JournalRow>{{4, "4", {}}}));
    reopen();
  }
  ASSERT_TRUE(succeeds(store_->put_checkpoint("alps", 4, "four")));
  ASSERT_TRUE(succeeds(append(*store_, "alps", 5, "5", {})));
}

TEST_P(StoreTest, CheckpointsMoveForwardWithinTheJournal) {
  ASSERT_TRUE(succeeds(store_->create_tin(kAlps, 1, "one")));
  ASSERT_TRUE(succeeds(append(*store_, "alps", 2, "", {})));
  EXPECT_TRUE(fails(store_->put_checkpoint("alps", 3, "three"), Code::kConflict));
  ASSERT_TRUE(succeeds(store_->put_checkpoint("alps", 2, "two")));
  EXPECT_TRUE(fails(store_->put_checkpoint("alps", 1, "one"), Code::kConflict));
  ASSERT_TRUE(succeeds(store_->put_checkpoint("alps", 2, "two again")));
  EXPECT_EQ(store_->load("alps")->checkpoint, "two again");
}

TEST_P(StoreTest, CheckpointsOfAnySizeAreKept) {
  constexpr std::size_t kChunk = std::size_t{4} << 20;
  ASSERT_TRUE(succeeds(store_->create_tin(kAlps, 1, "")));
  for (const std::size_t size :
       {std::size_t{0}, std::size_t{1}, kChunk - 1, kChunk, kChunk + 1, 2 * kChunk + 77}) {
    std::string bytes(size, '\0');
    for (std::size_t i = 0; i < size; ++i) bytes[i] = static_cast<char>(i * 2654435761U >> 13);
    ASSERT_TRUE(succeeds(store_->put_checkpoint("alps", 1, bytes)));
    const auto loaded = store_->load("alps");
    ASSERT_TRUE(succeeds(loaded));
    EXPECT_TRUE(loaded->checkpoint == bytes) << size;
  }
}

TEST_P(StoreTest, TheSourceStaysAsItWasBesideAllCheckpoints) {
  std::string source(10'000'000, '\0');
  for (std::size_t i = 0; i < source.size(); ++i) source[i] = static_cast<char>(i * 2654435761U >> 13);
  ASSERT_TRUE(succeeds(store_->create_tin(kAlps, 1, "one", source)));
  ASSERT_TRUE(succeeds(store_->create_tin({"bare", "", 0}, 1, "one")));
  ASSERT_TRUE(succeeds(append(*store_, "alps", 2, "two", {})));
  ASSERT_TRUE(succeeds(store_->put_checkpoint("alps", 2, "two")));
  for (int round = 0; round < 2; ++round) {
    const auto loaded = store_->load_source("alps");
    ASSERT_TRUE(succeeds(loaded));
    EXPECT_TRUE(*loaded == source);
    EXPECT_EQ(store_->load_source("bare").value(), "");
    reopen();
  }
  EXPECT_TRUE(fails(store_->create_tin(kAlps, 1, "", "another source"), Code::kConflict));
  EXPECT_TRUE(*store_->load_source("alps") == source);
  ASSERT_TRUE(succeeds(store_->remove_tin("alps")));
  EXPECT_TRUE(fails(store_->load_source("alps"), Code::kNotFound));
  ASSERT_TRUE(succeeds(store_->create_tin(kAlps, 1, "one", "new")));
  EXPECT_EQ(store_->load_source("alps").value(), "new");
}

TEST_P(StoreTest, TitlesChange) {
  ASSERT_TRUE(succeeds(store_->create_tin(kAlps, 1, "")));
  ASSERT_TRUE(succeeds(store_->update_title("alps", "Die Alpen")));
  reopen();
  EXPECT_EQ(store_->load("alps")->tin.title, "Die Alpen");
}

TEST_P(StoreTest, ARemovedTinIsGoneAndItsIdFree) {
  ASSERT_TRUE(succeeds(store_->create_tin(kAlps, 1, "old")));
  ASSERT_TRUE(succeeds(store_->create_tin({"b", "", 0}, 1, "b")));
  ASSERT_TRUE(succeeds(append(*store_, "alps", 2, "old", {})));
  ASSERT_TRUE(succeeds(store_->remove_tin("alps")));
  EXPECT_TRUE(fails(store_->load("alps"), Code::kNotFound));
  EXPECT_EQ(store_->list()->size(), 1u);
  ASSERT_TRUE(succeeds(store_->create_tin(kAlps, 1, "new")));
  const auto loaded = store_->load("alps");
  ASSERT_TRUE(succeeds(loaded));
  EXPECT_EQ(loaded->checkpoint, "new");
  EXPECT_TRUE(loaded->journal.empty());
  EXPECT_EQ(store_->load("b")->checkpoint, "b");
}

TEST_P(StoreTest, ManyThreadsAppendToTheirTins) {
  constexpr int kThreads = 4;
  constexpr std::uint64_t kAppends = 25;
  for (int t = 0; t < kThreads; ++t)
    ASSERT_TRUE(succeeds(store_->create_tin({std::to_string(t), "", 0}, 1, "")));
  std::vector<std::thread> threads;
  for (int t = 0; t < kThreads; ++t) {
    threads.emplace_back([&, id = std::to_string(t)] {
      for (std::uint64_t revision = 2; revision < 2 + kAppends; ++revision) {
        EXPECT_TRUE(succeeds(append(*store_, id, revision, id, {})));
        EXPECT_TRUE(succeeds(store_->list()));
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  for (int t = 0; t < kThreads; ++t) EXPECT_EQ(store_->load(std::to_string(t))->journal.size(), kAppends);
}

TEST_P(StoreTest, OfManyThreadsWithOneRevisionOneWins) {
  ASSERT_TRUE(succeeds(store_->create_tin(kAlps, 1, "")));
  std::atomic<int> won{0};
  std::vector<std::thread> threads;
  for (int t = 0; t < 4; ++t) {
    threads.emplace_back([&] {
      for (std::uint64_t revision = 2; revision < 22; ++revision) {
        if (append(*store_, "alps", revision, "", {}).ok()) ++won;
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(won, 20);
  EXPECT_EQ(store_->load("alps")->journal.size(), 20u);
}

}  // namespace
}  // namespace server::store
