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

TEST_P(StoreTest, ASourceComesAndGoesInPieces) {
  const std::string piece(3'000'000, 'p');
  const auto pieces = [&piece](const Sink& sink) -> tin::base::Result<void> {
    for (int i = 0; i < 3; ++i) {
      if (auto taken = sink(piece); !taken) return taken;
    }
    return {};
  };
  ASSERT_TRUE(succeeds(store_->create_tin(kAlps, 1, "one", pieces)));
  std::string together;
  std::size_t largest = 0;
  ASSERT_TRUE(succeeds(
      store_->read_source("alps", [&](std::string_view part, std::uint64_t whole) -> tin::base::Result<void> {
        EXPECT_EQ(whole, 9'000'000U);
        largest = std::max(largest, part.size());
        together += part;
        return {};
      })));
  EXPECT_TRUE(together == piece + piece + piece);
  EXPECT_LE(largest, std::size_t{1} << 20);
  int taken = 0;
  const auto ended =
      store_->read_source("alps", [&](std::string_view, std::uint64_t) -> tin::base::Result<void> {
        ++taken;
        return tin::base::error(Code::kCancelled, "ended");
      });
  EXPECT_TRUE(fails(ended, Code::kCancelled));
  EXPECT_EQ(taken, 1);
  // What ends on its way was never there.
  const auto broken = [&piece](const Sink& sink) -> tin::base::Result<void> {
    if (auto first = sink(piece); !first) return first;
    return tin::base::error(Code::kCancelled, "ended");
  };
  EXPECT_TRUE(fails(store_->create_tin({"b", "", 0}, 1, "b", broken), Code::kCancelled));
  EXPECT_TRUE(fails(store_->load("b"), Code::kNotFound));
  ASSERT_TRUE(succeeds(store_->create_tin({"b", "", 0}, 1, "b", "whole")));
  EXPECT_EQ(store_->load_source("b").value(), "whole");
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

TEST_P(StoreTest, EntriesComeTogetherOrNotAtAll) {
  ASSERT_TRUE(succeeds(store_->create_tin(kAlps, 1, "one")));
  const Answer answer{"key", "request", "answer", 5};
  const std::vector<Entry> two{{JournalRow{2, "two", kInfo}, answer},
                               {JournalRow{3, "three", {}}, std::nullopt}};
  ASSERT_TRUE(succeeds(store_->append("alps", two)));
  const std::vector<Entry> gap{{JournalRow{4, "four", {}}, std::nullopt},
                               {JournalRow{6, "six", {}}, std::nullopt}};
  EXPECT_TRUE(fails(store_->append("alps", gap), Code::kConflict));
  const std::vector<Entry> again{{JournalRow{4, "four", {}}, Answer{"key", "other", "", 6}}};
  EXPECT_TRUE(fails(store_->append("alps", again), Code::kConflict));
  for (int round = 0; round < 2; ++round) {
    EXPECT_EQ(store_->load("alps")->journal.size(), 2u);
    EXPECT_EQ(store_->find_answer("alps", "key").value(), answer);
    EXPECT_EQ(store_->find_answer("alps", "other").value(), std::nullopt);
    reopen();
  }
  EXPECT_TRUE(fails(store_->find_answer("none", "key"), Code::kNotFound));
}

TEST_P(StoreTest, AnEntryMayBringTheCheckpointThatItStandsOn) {
  ASSERT_TRUE(succeeds(store_->create_tin(kAlps, 1, "open")));
  const std::vector<Entry> first{{JournalRow{2, "two", {}}, std::nullopt, "fitted"}};
  ASSERT_TRUE(succeeds(store_->append("alps", first)));
  reopen();
  const auto loaded = store_->load("alps");
  ASSERT_TRUE(succeeds(loaded));
  EXPECT_EQ(loaded->checkpoint, "fitted");
  EXPECT_EQ(loaded->checkpoint_revision, 1u);
  EXPECT_EQ(loaded->journal.size(), 1u);
}

TEST_P(StoreTest, TheJournalIsReadInPartsFromEitherEnd) {
  ASSERT_TRUE(succeeds(store_->create_tin(kAlps, 1, "one")));
  for (std::uint64_t revision = 2; revision <= 9; ++revision)
    ASSERT_TRUE(succeeds(append(*store_, "alps", revision, std::string(100, 'r'))));
  const auto revisions = [&](const JournalRange& range) {
    std::vector<std::uint64_t> out;
    const auto rows = store_->read_journal("alps", range);
    EXPECT_TRUE(succeeds(rows));
    for (const JournalRow& row : *rows) out.push_back(row.revision);
    return out;
  };
  using Numbers = std::vector<std::uint64_t>;
  EXPECT_EQ(revisions({.first = 4, .last = 6}), (Numbers{4, 5, 6}));
  EXPECT_EQ(revisions({.first = 8}), (Numbers{8, 9}));
  EXPECT_EQ(revisions({.newest_first = true, .most_rows = 2}), (Numbers{9, 8}));
  EXPECT_EQ(revisions({.last = 5, .newest_first = true, .most_bytes = 150}), (Numbers{5, 4}));
  EXPECT_EQ(revisions({.most_bytes = 1}), (Numbers{2})) << "one in any case";
  EXPECT_EQ(revisions({.first = 10}), (Numbers{}));
  EXPECT_TRUE(fails(store_->read_journal("none", {}), Code::kNotFound));
}

TEST_P(StoreTest, TrimmingForgetsWhatTheCheckpointHolds) {
  ASSERT_TRUE(succeeds(store_->create_tin(kAlps, 1, "one")));
  for (std::uint64_t revision = 2; revision <= 9; ++revision)
    ASSERT_TRUE(succeeds(append(*store_, "alps", revision, std::string(100, 'r'))));
  const auto first = [&] { return store_->journal_extent("alps")->first; };
  ASSERT_TRUE(succeeds(store_->trim_journal("alps", {.revisions = 3})));
  EXPECT_EQ(first(), 2u) << "the checkpoint is older";
  ASSERT_TRUE(succeeds(store_->put_checkpoint("alps", 8, "eight")));
  ASSERT_TRUE(succeeds(store_->trim_journal("alps", {.revisions = 6})));
  EXPECT_EQ(first(), 4u);
  ASSERT_TRUE(succeeds(store_->trim_journal("alps", {.bytes = 399})));
  EXPECT_EQ(first(), 7u);
  ASSERT_TRUE(succeeds(store_->trim_journal("alps", {.revisions = 0})));
  EXPECT_EQ(first(), 9u) << "what follows the checkpoint stays";
  reopen();
  EXPECT_EQ(store_->load("alps")->journal.size(), 1u);
  ASSERT_TRUE(succeeds(store_->put_checkpoint("alps", 9, "nine")));
  ASSERT_TRUE(succeeds(store_->trim_journal("alps", {.revisions = 0})));
  EXPECT_EQ(first(), 0u);
  EXPECT_EQ(store_->journal_extent("alps")->last, 9u);
  EXPECT_TRUE(succeeds(append(*store_, "alps", 10, "ten")));
}

TEST_P(StoreTest, OldAndSurplusAnswersAreForgotten) {
  ASSERT_TRUE(succeeds(store_->create_tin(kAlps, 1, "one")));
  for (int i = 0; i < 10; ++i) {
    const Entry entry{std::nullopt, Answer{std::to_string(i), "", "", 100 + i}};
    ASSERT_TRUE(succeeds(store_->append("alps", {&entry, 1})));
  }
  const auto kept = [&] {
    std::string keys;
    for (int i = 0; i < 10; ++i) {
      if (*store_->find_answer("alps", std::to_string(i))) keys += std::to_string(i);
    }
    return keys;
  };
  ASSERT_TRUE(succeeds(store_->trim_answers(103, 100)));
  EXPECT_EQ(kept(), "3456789");
  ASSERT_TRUE(succeeds(store_->trim_answers(0, 2)));
  EXPECT_EQ(kept(), "89");
  ASSERT_TRUE(succeeds(store_->remove_tin("alps")));
  ASSERT_TRUE(succeeds(store_->create_tin(kAlps, 1, "one")));
  EXPECT_EQ(kept(), "") << "a TIN of the same id later is another one";
}

TEST_P(StoreTest, JobsAreKeptInTheirOrder) {
  JobRow first{"z", "simplify", "alps", 0, 1, 0, 0, "waiting", "", "", ""};
  const JobRow second{"a", "import", "file", 2, 2, 3, 4, "done", "", "", "{}"};
  ASSERT_TRUE(succeeds(store_->put_job(first)));
  ASSERT_TRUE(succeeds(store_->put_job(second)));
  first.state = 3;
  first.started_ms = 5;
  first.finished_ms = 6;
  first.message = "failed";
  first.error = "too-large";
  first.where = "/inputs";
  ASSERT_TRUE(succeeds(store_->put_job(first)));
  reopen();
  EXPECT_EQ(store_->list_jobs().value(), (std::vector<JobRow>{first, second}));
  ASSERT_TRUE(succeeds(store_->remove_job("z")));
  EXPECT_EQ(store_->list_jobs().value(), (std::vector<JobRow>{second}));
}

TEST_P(StoreTest, WritesThatComeAtOneTimeShareCommits) {
  constexpr int kThreads = 16;
  constexpr std::uint64_t kAppends = 30;
  for (int t = 0; t < kThreads; ++t)
    ASSERT_TRUE(succeeds(store_->create_tin({std::to_string(t), "", 0}, 1, "")));
  const auto before = store_->counts();
  std::vector<std::thread> threads;
  for (int t = 0; t < kThreads; ++t) {
    threads.emplace_back([&, id = std::to_string(t)] {
      for (std::uint64_t revision = 2; revision < 2 + kAppends; ++revision) {
        EXPECT_TRUE(succeeds(append(*store_, id, revision, id)));
        if (revision % 10 == 0) {  // one that fails takes no other with it
          EXPECT_TRUE(fails(append(*store_, id, revision, id), Code::kConflict));
        }
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  const auto after = store_->counts();
  EXPECT_EQ(after.writes - before.writes, kThreads * kAppends);
  EXPECT_LT(after.commits - before.commits, kThreads * kAppends / 2);
  EXPECT_GT(after.seconds, before.seconds);
  EXPECT_EQ(after.waiting, 0U);
  reopen();
  for (int t = 0; t < kThreads; ++t) EXPECT_EQ(store_->load(std::to_string(t))->journal.size(), kAppends);
}

}  // namespace
}  // namespace server::store
