// Heights that float within the tolerance.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "tests/tin/simplify/judge.h"
#include "tests/tin/simplify/runs.h"
#include "tests/tin/simplify/terrains.h"
#include "tin/mesh/validate.h"

namespace {

using support::applied;
using support::at_most;
using support::expect_kept;
using support::expect_true_report;
using support::heights;
using support::simplify;
using support::SimplifyTest;
using support::to;
using tin::simplify::Effort;
using tin::simplify::Elevations;
using tin::simplify::Options;
using tin::terrain::Duplicates;
using tin::terrain::Placement;
using tin::terrain::Terrain;

Options fitted(Options options) {
  options.elevations = Elevations::kFit;
  return options;
}

/// Hills of whole metres, so large that several patches work on them.
Terrain hills(std::int32_t width, std::int32_t height) {
  return support::raster_terrain(heights(width, height, [](auto c, auto r) {
    return std::optional(
        std::round(120 * std::sin(c * 0.07) * std::cos(r * 0.05) + 15 * std::sin(c * 0.4 + r * 0.3)));
  }));
}

class FitTest : public SimplifyTest {};

TEST_F(FitTest, KeepsEverySampleOfHardRastersWithinTheTolerance) {
  for (const auto& [name, raster] : support::hard_rasters(random_, 26)) {
    SCOPED_TRACE(name);
    const Terrain source = support::raster_terrain(raster);
    for (const double tolerance : {0.0, 1e-9, std::nextafter(2.0, 0.0), 20.0, 1e9}) {
      expect_kept(source, fitted(to(tolerance, Effort::kBalanced)));
    }
  }
}

TEST_F(FitTest, KeepsScatteredSamplesWithinTheTolerance) {
  for (const std::int32_t extent : {60, 3000, tin::exact::kLatticeHalf - 1}) {
    const Terrain source = support::scattered_terrain(random_, 500, extent, extent == 3000);
    for (const double tolerance : {0.5, 7.3}) expect_kept(source, fitted(to(tolerance, Effort::kBalanced)));
  }
}

TEST_F(FitTest, NeedsFewerVerticesThanTheSamplesOwnHeights) {
  const Terrain source = hills(90, 80);
  for (const Effort effort : {Effort::kFast, Effort::kBalanced, Effort::kThorough}) {
    const std::size_t own = support::expect_within(source, 6, effort);
    const std::size_t fit = expect_kept(source, fitted(to(6, effort))).vertex_count();
    EXPECT_LT(static_cast<double>(fit), 0.9 * static_cast<double>(own));
  }
}

TEST_F(FitTest, NoVertexIsFurtherFromItsSampleThanTheTolerance) {
  const Terrain source = hills(60, 60);
  const Terrain result = expect_kept(source, fitted(to(3, Effort::kBalanced)));
  int floating = 0;
  for (const auto& vertex : result.vertices_by_id()) {
    const auto slot = source.triangulation().locate(vertex.at);
    ASSERT_EQ(slot.kind, tin::delaunay::Location::Kind::kOnVertex);
    const double own = source.z(slot.vertex);
    EXPECT_LE(std::abs(vertex.z - own), 3);
    floating += vertex.z != own ? 1 : 0;
  }
  EXPECT_GT(floating, 20);
}

TEST_F(FitTest, WhatNeverGoesKeepsItsHeight) {
  const Terrain source = hills(70, 70);
  Options options = fitted(to(5, Effort::kBalanced));
  std::set<tin::exact::Point> fixed{source.bounds()->min, source.bounds()->max};
  for (std::uint64_t i = 1; i <= 40; ++i) {
    options.protect.push_back(
        source.vertex(tin::terrain::VertexId(1 + i * 7919 % source.vertex_count()))->at);
    fixed.insert(options.protect.back());
  }
  const Terrain result = expect_kept(source, options);
  std::size_t seen = 0;
  for (const auto& vertex : result.vertices_by_id()) {
    if (!fixed.contains(vertex.at)) continue;
    ++seen;
    const auto where = source.triangulation().locate(vertex.at);
    EXPECT_EQ(vertex.z, source.z(where.vertex));
  }
  EXPECT_EQ(seen, fixed.size());
}

TEST_F(FitTest, ABudgetIsKeptAndItsErrorIsSmaller) {
  const Terrain source = hills(90, 80);
  for (const std::size_t budget : {60UL, 200UL}) {
    const auto own = simplify(source, at_most(budget, Effort::kThorough), nullptr);
    const auto fit = simplify(source, fitted(at_most(budget, Effort::kThorough)), nullptr);
    ASSERT_TRUE(fit.ok());
    expect_true_report(source, applied(source, *fit), *fit);
    EXPECT_LE(fit->report.vertices_after, budget);
    EXPECT_LT(fit->report.max_error, own->report.max_error);
  }
}

TEST_F(FitTest, ThreadsDoNotChangeTheResult) {
  const Terrain source = hills(460, 330);
  Options options = fitted(to(1, Effort::kBalanced));
  const auto one = simplify(source, options, nullptr);
  options.threads = 3;
  const auto more = simplify(source, options, nullptr);
  EXPECT_EQ(applied(source, *one).digest(), applied(source, *more).digest());
  EXPECT_FALSE(one->reset.empty());
}

TEST_F(FitTest, ASecondSimplificationIsHeldAgainstTheFirstSamples) {
  const Terrain full = hills(50, 60);
  const auto source = support::raster_source(full);
  Terrain terrain = full;
  for (const double tolerance : {9.0, 2.0, 30.0}) {
    const auto outcome =
        tin::simplify::simplify(terrain, &source, {}, fitted(to(tolerance, Effort::kBalanced)), nullptr);
    ASSERT_TRUE(outcome.ok());
    terrain = applied(terrain, *outcome);
    EXPECT_EQ(tin::mesh::validate(terrain.mesh()).value_or(""), "");
    EXPECT_EQ(support::judge(full, terrain, tolerance).value_or(""), "");
    EXPECT_EQ(outcome->report.samples, full.vertex_count());
  }
  // And back to the samples' own heights.
  const auto exact = tin::simplify::simplify(terrain, &source, {}, to(0), nullptr);
  terrain = applied(terrain, *exact);
  EXPECT_EQ(terrain.digest(), applied(full, *simplify(full, to(0), nullptr)).digest());
}

}  // namespace
