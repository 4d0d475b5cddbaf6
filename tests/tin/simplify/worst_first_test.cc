// The queue of greedy insertion against a plain search for the worst.
#include "tin/simplify/worst_first.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "tests/support/point_sets.h"

namespace {

using tin::simplify::Candidate;
using tin::simplify::WorstFirst;

bool comes_before(const Candidate& a, const Candidate& b) {
  return a.error != b.error ? a.error > b.error : a.sample < b.sample;
}

TEST(WorstFirstTest, TheWorstValidCandidateComesFirstWhateverComesBetween) {
  support::Random random(support::seed());
  const testing::ScopedTrace trace(__FILE__, __LINE__, "TINSMITH_SEED=" + std::to_string(support::seed()));
  std::size_t popped = 0, forgotten = 0;
  for (const double least : {0.0, 1e-300, 0.5, 10.0, 1e300}) {
    WorstFirst queue(least);
    std::vector<Candidate> plain;
    std::vector<std::uint32_t> stamps(100, 0);
    const auto is_valid = [&](const Candidate& candidate) { return stamps[candidate.triangle] == candidate.stamp; };
    for (std::uint32_t i = 0; i < 20000; ++i) {
      if (random() % 5 < 3) {
        // Equal errors, very different ones, and some below the least.
        const double error = random() % 2 == 0 ? static_cast<double>(random() % 50)
                                               : std::ldexp(1.0 + static_cast<double>(random() % 8) / 8,
                                                            static_cast<int>(random() % 1200) - 100);
        const auto triangle = static_cast<std::uint32_t>(random() % stamps.size());
        const Candidate candidate{error, i % 7 + i * 8, triangle, ++stamps[triangle]};
        queue.push(candidate);
        plain.push_back(candidate);
        continue;
      }
      std::size_t best = plain.size();
      for (std::size_t k = 0; k < plain.size();) {
        if (!is_valid(plain[k])) {
          plain[k] = plain.back();
          plain.pop_back();
          best = plain.size(), k = 0, ++forgotten;
          continue;
        }
        if (best == plain.size() || comes_before(plain[k], plain[best])) best = k;
        ++k;
      }
      const auto worst = queue.pop(is_valid);
      ASSERT_EQ(worst.has_value(), !plain.empty());
      if (!worst) continue;
      ASSERT_EQ(worst->error, plain[best].error);
      ASSERT_EQ(worst->sample, plain[best].sample);
      ++stamps[worst->triangle];
      ++popped;
    }
  }
  EXPECT_GT(popped, 10000U);
  EXPECT_GT(forgotten, 10000U);
}

}  // namespace
