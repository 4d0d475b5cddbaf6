#include "tin/mesh/slot_set.h"

#include <gtest/gtest.h>

#include <random>
#include <set>

namespace {

using tin::mesh::SlotSet;

TEST(SlotSetTest, TakesTheNearestInTheWordThenTheNextThenTheLowest) {
  SlotSet set;
  for (const std::uint32_t slot : {3U, 60U, 130U, 100'000U}) set.add(slot);
  EXPECT_EQ(set.take_near(50), 60U);
  EXPECT_EQ(set.take_near(40), 3U);
  EXPECT_EQ(set.take_near(64), 130U);
  set.add(2);
  EXPECT_EQ(set.take_near(4'000'000'000U), 2U);
  EXPECT_EQ(set.take_near(5), 100'000U);
  EXPECT_TRUE(set.empty());
}

TEST(SlotSetTest, AgreesWithAnOrderedSet) {
  std::mt19937_64 random(7);
  for (const std::uint32_t range : {70U, 5000U, 3'000'000U}) {
    SlotSet set;
    std::set<std::uint32_t> model;
    for (int step = 0; step < 30'000; ++step) {
      const auto slot = static_cast<std::uint32_t>(random() % range);
      if (random() % 2 == 0 || model.empty()) {
        if (model.insert(slot).second) set.add(slot);
      } else {
        const std::uint32_t taken = set.take_near(slot);
        ASSERT_EQ(model.erase(taken), 1U);
        // Nothing nearer in the word, and outside it the next above or the lowest.
        const std::uint32_t word = slot / 64 * 64, distance = taken > slot ? taken - slot : slot - taken;
        for (std::uint32_t other = word; other < word + 64; ++other) {
          if (model.count(other) == 0) continue;
          ASSERT_EQ(taken / 64, slot / 64);
          ASSERT_GE(other > slot ? other - slot : slot - other, distance);
        }
        if (taken / 64 != slot / 64) {
          const auto next = model.lower_bound(slot);
          if (next != model.end()) {
            ASSERT_TRUE(taken > slot && taken < *next);
          } else if (taken < slot && !model.empty()) {
            ASSERT_LT(taken, *model.begin());
          }
        }
      }
      ASSERT_EQ(set.size(), model.size());
    }
  }
}

}  // namespace
