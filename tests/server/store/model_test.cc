// Random operations on a store and on a std::map must have the same results, also after the store was opened
// anew.
#include <gtest/gtest.h>

#include <cstdlib>
#include <iostream>
#include <map>
#include <random>

#include "tests/server/store/store_kinds.h"

namespace server::store {
namespace {

using Random = std::mt19937_64;

std::uint64_t chosen_seed() {
  const char* given = std::getenv("TINSMITH_SEED");
  const std::uint64_t seed = given != nullptr ? std::strtoull(given, nullptr, 10) : std::random_device{}();
  std::cout << "TINSMITH_SEED=" << seed << std::endl;
  return seed;
}

struct ModelTin {
  TinRecord tin;
  std::uint64_t checkpoint_revision = 0;
  std::string checkpoint;
  std::map<std::uint64_t, JournalRow> journal;

  std::uint64_t last() const { return journal.empty() ? checkpoint_revision : journal.rbegin()->first; }
};

class ModelTest : public testing::AnyStore {
 protected:
  std::uint64_t below(std::uint64_t bound) { return random_() % bound; }
  std::string id() { return std::string(1, static_cast<char>('a' + below(4))); }
  std::string bytes() {
    std::string result(below(50), '\0');
    for (char& c : result) c = static_cast<char>(random_());
    return result;
  }

  void create() {
    const TinRecord tin{id(), bytes(), static_cast<std::int64_t>(random_() >> 1)};
    const std::uint64_t revision = below(100);
    const std::string checkpoint = bytes();
    const bool expected = !model_.contains(tin.id);
    ASSERT_EQ(store_->create_tin(tin, revision, checkpoint).ok(), expected);
    if (expected) model_[tin.id] = {tin, revision, checkpoint, {}};
  }

  void append() {
    const std::string tin = id();
    const auto found = model_.find(tin);
    const std::uint64_t last = found == model_.end() ? 0 : found->second.last();
    const JournalRow row{below(5) == 0 ? below(120) : last + 1,
                         bytes(),
                         {static_cast<std::int64_t>(below(1000)), bytes(), bytes()}};
    const bool expected = found != model_.end() && row.revision == last + 1;
    ASSERT_EQ(testing::append(*store_, tin, row.revision, row.record, row.info).ok(), expected);
    if (expected) found->second.journal[row.revision] = row;
  }

  void checkpoint() {
    const std::string tin = id();
    const auto found = model_.find(tin);
    const std::uint64_t last = found == model_.end() ? 0 : found->second.last();
    const std::uint64_t revision = last + 2 - std::min(last + 2, below(6));
    const std::string content = bytes();
    const bool expected =
        found != model_.end() && revision <= last && revision >= found->second.checkpoint_revision;
    ASSERT_EQ(store_->put_checkpoint(tin, revision, content).ok(), expected);
    if (!expected) return;
    found->second.checkpoint_revision = revision;
    found->second.checkpoint = content;
  }

  void retitle() {
    const std::string tin = id();
    const std::string title = bytes();
    ASSERT_EQ(store_->update_title(tin, title).ok(), model_.contains(tin));
    if (model_.contains(tin)) model_[tin].tin.title = title;
  }

  void remove() {
    const std::string tin = id();
    ASSERT_EQ(store_->remove_tin(tin).ok(), model_.erase(tin) == 1);
  }

  void compare() {
    const auto tins = store_->list();
    ASSERT_TRUE(testing::succeeds(tins));
    std::vector<TinRecord> expected;
    for (const auto& [id, entry] : model_) expected.push_back(entry.tin);
    ASSERT_EQ(*tins, expected);
    for (const auto& [id, entry] : model_) {
      const auto loaded = store_->load(id);
      ASSERT_TRUE(testing::succeeds(loaded));
      ASSERT_EQ(loaded->checkpoint_revision, entry.checkpoint_revision);
      ASSERT_EQ(loaded->checkpoint, entry.checkpoint);
      std::vector<JournalRow> rows;
      for (auto row = entry.journal.upper_bound(entry.checkpoint_revision); row != entry.journal.end();
           ++row) {
        rows.push_back(row->second);
      }
      ASSERT_EQ(loaded->journal, rows);
    }
  }

  Random random_{chosen_seed()};
  std::map<std::string, ModelTin> model_;
};

INSTANTIATE_TEST_SUITE_P(All, ModelTest, ::testing::ValuesIn(testing::store_kinds()), testing::name_of);

TEST_P(ModelTest, RandomOperationsAgreeWithAMap) {
  for (int step = 0; step < 3000 && !HasFatalFailure(); ++step) {
    switch (below(40)) {
      case 0:
        remove();
        break;
      case 1:
      case 2:
      case 3:
        create();
        break;
      case 4:
      case 5:
        retitle();
        break;
      case 6:
      case 7:
      case 8:
        checkpoint();
        break;
      case 9:
        compare();
        break;
      case 10:
        if (step % 5 == 0) reopen();
        break;
      default:
        append();
    }
  }
  reopen();
  compare();
}

}  // namespace
}  // namespace server::store
