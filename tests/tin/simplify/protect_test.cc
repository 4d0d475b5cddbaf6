// What is protected stays, on ground that is worked on in several tiles and patches.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <random>
#include <set>

#include "tin/simplify/simplify.h"

namespace {

using tin::exact::Point;
using tin::terrain::SourceGrid;
using tin::terrain::SourceSamples;

constexpr int kSize = 600;  // 360,000 samples: more than one tile

SourceSamples hills(unsigned seed) {
  auto grid = std::make_shared<SourceGrid>();
  grid->width = grid->height = kSize;
  grid->dx = 10;
  grid->dy = -10;
  grid->x0 = -kSize / 2 * 10;
  grid->y0 = kSize / 2 * 10;
  std::mt19937 random(seed);
  std::vector<double> heights;
  for (int i = 0; i < kSize * kSize; ++i) {
    const double x = i % kSize, y = i / kSize;
    heights.push_back(
        std::round(300 * std::sin(x / 60) * std::cos(y / 45) + static_cast<double>(random() % 4)));
  }
  return SourceSamples::raster(grid, heights);
}

class ProtectTest : public testing::TestWithParam<tin::simplify::Effort> {};

TEST_P(ProtectTest, EverythingThatIsProtectedIsAVertexAndTheToleranceHolds) {
  constexpr unsigned kSeed = 20261127;
  std::cout << "seed " << kSeed << '\n';
  const SourceSamples source = hills(kSeed);
  tin::simplify::Options options;
  options.tolerance = 12;
  options.effort = GetParam();
  options.threads = 2;
  std::mt19937 random(kSeed);
  std::set<Point> wanted;
  for (int i = 0; i < 2000; ++i) wanted.insert(source.at(random() % source.size()));
  options.protect.assign(wanted.begin(), wanted.end());
  options.protect.push_back({1, 1});  // no sample stands here: it does not count
  options.protect.push_back(options.protect.front());
  const auto chosen = tin::simplify::simplify_samples(source, options, nullptr);
  ASSERT_TRUE(chosen.ok());
  EXPECT_LE(chosen->report.max_error, 12);
  std::set<Point> vertices;
  for (const auto& vertex : chosen->vertices) vertices.insert(vertex.at);
  EXPECT_TRUE(std::includes(vertices.begin(), vertices.end(), wanted.begin(), wanted.end()));
  EXPECT_FALSE(vertices.contains({1, 1}));
  EXPECT_LT(vertices.size(), 10'000U) << "and the rest is thinned";
}

INSTANTIATE_TEST_SUITE_P(Efforts, ProtectTest,
                         testing::Values(tin::simplify::Effort::kFast, tin::simplify::Effort::kBalanced));

TEST(ProtectBudgetTest, WhatIsProtectedCountsAgainstTheBudget) {
  const SourceSamples source = hills(1);
  tin::simplify::Options options;
  options.max_vertices = 50;
  options.effort = tin::simplify::Effort::kFast;
  for (std::size_t i = 0; i < 46; ++i) options.protect.push_back(source.at(1000 + 61 * i));
  EXPECT_TRUE(tin::simplify::simplify_samples(source, options, nullptr).ok()) << "and four corners";
  options.protect.push_back(source.at(90'000));
  const auto refused = tin::simplify::simplify_samples(source, options, nullptr);
  ASSERT_FALSE(refused.ok());
  EXPECT_EQ(refused.error().code, tin::base::Code::kInvalidValue);
  EXPECT_NE(refused.error().message.find("51"), std::string::npos) << refused.error().message;
}

}  // namespace
