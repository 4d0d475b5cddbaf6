// Every sample stays within the tolerance, compared exactly.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/tin/simplify/judge.h"
#include "tests/tin/simplify/runs.h"
#include "tests/tin/simplify/terrains.h"

namespace {

using support::SimplifyTest;
using support::applied;
using support::at_most;
using support::expect_true_report;
using support::expect_within;
using support::heights;
using support::simplify;
using support::to;
using tin::base::Code;
using tin::exact::Point;
using tin::simplify::Effort;
using tin::simplify::Options;
using tin::terrain::Duplicates;
using tin::terrain::Edit;
using tin::terrain::Placement;
using tin::terrain::Terrain;
using tin::terrain::VertexId;

TEST_F(SimplifyTest, KeepsEverySampleOfHardRastersWithinTheTolerance) {
  for (const auto& [name, raster] : support::hard_rasters(random_, 24)) {
    SCOPED_TRACE(name);
    const Terrain source = support::raster_terrain(raster);
    for (const double tolerance : {0.0, 1e-9, 0.25, 1.0, 3.0, 20.0, 1e9}) expect_within(source, tolerance);
  }
}

TEST_F(SimplifyTest, LocalSearchKeepsEverySampleWithinTheToleranceAndNeedsFewer) {
  for (const auto& [name, raster] : support::hard_rasters(random_, 30)) {
    SCOPED_TRACE(name);
    const Terrain source = support::raster_terrain(raster);
    for (const double tolerance : {0.0, 1.0, 20.0}) {
      const std::size_t fast = expect_within(source, tolerance);
      const std::size_t balanced = expect_within(source, tolerance, Effort::kBalanced);
      const std::size_t thorough = expect_within(source, tolerance, Effort::kThorough);
      EXPECT_LE(balanced, fast);
      EXPECT_LE(thorough, fast);
    }
  }
}

TEST_F(SimplifyTest, ScatteredSamplesStayWithinTheToleranceInLocalSearch) {
  for (const std::int32_t extent : {60, 3000, tin::exact::kLatticeHalf - 1}) {
    const Terrain source = support::scattered_terrain(random_, 600, extent, extent == 3000);
    for (const double tolerance : {0.0, 2.0, 10.0}) {
      EXPECT_LE(expect_within(source, tolerance, Effort::kThorough), expect_within(source, tolerance));
    }
  }
}

TEST_F(SimplifyTest, KeepsRastersOfAnyStepWithinTheTolerance) {
  for (const auto& [name, raster] : support::hard_rasters(random_, 18)) {
    SCOPED_TRACE(name);
    for (const std::int32_t dy : {92663, -92663, 1})
      expect_within(support::raster_terrain(raster, 66091, dy), 2);
  }
}

TEST_F(SimplifyTest, KeepsScatteredSamplesWithinTheTolerance) {
  for (const std::int32_t extent : {40, 3000, tin::exact::kLatticeHalf - 1}) {
    for (const bool whole : {true, false}) {
      const Terrain source = support::scattered_terrain(random_, 500, extent, whole);
      for (const double tolerance : {0.0, 0.5, 2.0, 10.0, 1000.0}) expect_within(source, tolerance);
    }
  }
}

TEST_F(SimplifyTest, KeepsClustersFarApartWithinTheTolerance) {
  std::vector<Placement> placements;
  for (const Point p : support::corner_clusters(random_, 120))
    placements.push_back({p, static_cast<double>(random_() % 50)});
  const Terrain source = *Terrain::build({}, placements, Duplicates::kKeep);
  for (const double tolerance : {0.0, 5.0, 30.0}) expect_within(source, tolerance);
}

TEST_F(SimplifyTest, KeepsEditedRastersWithinTheTolerance) {
  for (const auto& [name, raster] : support::hard_rasters(random_, 20)) {
    SCOPED_TRACE(name);
    Terrain source = support::raster_terrain(raster);
    std::vector<Edit> edits;
    for (std::uint64_t i = 0; i < source.vertex_count() / 12; ++i) {
      edits.emplace_back(tin::terrain::Remove{VertexId(1 + 12 * i)});
      edits.emplace_back(tin::terrain::SetZ{VertexId(3 + 12 * i), 7.0 + static_cast<double>(i)});
      edits.emplace_back(tin::terrain::Insert{
          {static_cast<std::int32_t>(random_() % 150) - 75, static_cast<std::int32_t>(random_() % 150) - 75},
          9.5});
    }
    ASSERT_TRUE(source.apply(edits, Duplicates::kReplace).ok());
    for (const double tolerance : {0.0, 1.0, 6.0}) expect_within(source, tolerance);
  }
}

TEST_F(SimplifyTest, SimplifiesWhatWasSimplifiedBefore) {
  for (const auto& [name, raster] : support::hard_rasters(random_, 40)) {
    SCOPED_TRACE(name);
    Terrain source = support::raster_terrain(raster);
    for (const double tolerance : {3.0, 9.0, 30.0}) {
      const auto outcome = simplify(source, to(tolerance), nullptr);
      ASSERT_TRUE(outcome.ok());
      const Terrain result = applied(source, *outcome);
      EXPECT_EQ(support::judge(source, result, tolerance).value_or(""), "");
      source = result;
    }
  }
}

TEST_F(SimplifyTest, AtToleranceZeroOnlyWhatLiesOnTheSurfaceGoes) {
  const Terrain noisy = support::raster_terrain(
      heights(15, 15, [&](auto, auto) { return std::optional<double>(random_() % 1000); }));
  const auto kept = simplify(noisy, to(0), nullptr);
  EXPECT_EQ(kept->report.max_error, 0);
  EXPECT_FALSE(kept->report.worst.has_value());
  const Terrain slope = support::raster_terrain(
      heights(15, 15, [](auto c, auto r) { return std::optional(3.0 * c - 2.0 * r); }));
  EXPECT_EQ(expect_within(slope, 0), 4U);
  const Terrain roof = support::raster_terrain(
      heights(15, 15, [](auto c, auto) { return std::optional(c < 7 ? c : 14.0 - c); }));
  EXPECT_EQ(expect_within(roof, 0), 6U);
}

TEST_F(SimplifyTest, AnErrorThatEqualsTheToleranceIsWithinIt) {
  // A spike of 2 over a plane: without it the error is 2, exactly.
  const Terrain spike = support::raster_terrain(
      heights(5, 5, [](auto c, auto r) { return std::optional(c == 2 && r == 1 ? 2.0 : 0.0); }));
  EXPECT_EQ(simplify(spike, to(2), nullptr)->report.vertices_after, 4U);
  EXPECT_EQ(simplify(spike, to(2), nullptr)->report.max_error, 2);
  EXPECT_GT(simplify(spike, to(std::nextafter(2.0, 0.0)), nullptr)->report.vertices_after, 4U);
}

TEST_F(SimplifyTest, AnInterpolatedThirdIsComparedExactly) {
  // A triangle of 0, 0 and 1 with one sample at its centroid: interpolated 1/3, which no double equals.
  const std::vector<Placement> placements{{{0, 0}, 0}, {{3, 0}, 0}, {{0, 3}, 1}, {{1, 1}, 0}};
  const Terrain source = *Terrain::build({}, placements, Duplicates::kReject);
  const double below = 1.0 / 3;  // rounded down
  EXPECT_EQ(simplify(source, to(below), nullptr)->report.vertices_after, 4U);
  EXPECT_EQ(simplify(source, to(std::nextafter(below, 1.0)), nullptr)->report.vertices_after, 3U);
}

TEST_F(SimplifyTest, TheHullKeepsItsShape) {
  const Terrain source = support::raster_terrain(
      heights(20, 20, [&](auto, auto) { return std::optional<double>(random_() % 3); }));
  const Terrain result = applied(source, *simplify(source, to(100), nullptr));
  EXPECT_EQ(result.vertex_count(), 4U);
  EXPECT_EQ(result.bounds()->min, source.bounds()->min);
  EXPECT_EQ(result.bounds()->max, source.bounds()->max);
  for (const auto& set : support::hard_sets(random_, 200)) {
    SCOPED_TRACE(set.name);
    std::vector<Placement> placements;
    for (const Point p : set.points) placements.push_back({p, static_cast<double>(random_() % 9)});
    const Terrain terrain = *Terrain::build({}, placements, Duplicates::kKeep);
    if (terrain.mesh().dimension() == 2) expect_within(terrain, 4);
  }
}

TEST_F(SimplifyTest, WhatIsProtectedStays) {
  for (const auto& [name, raster] : support::hard_rasters(random_, 30)) {
    SCOPED_TRACE(name);
    const Terrain source = support::raster_terrain(raster);
    for (Options options : {to(5), to(5, Effort::kBalanced), at_most(120, Effort::kBalanced)}) {
      for (std::uint64_t i = 1; i <= 20 && i <= source.vertex_count(); ++i) {
        options.protect.push_back(source.vertex(VertexId(1 + i * 7919 % source.vertex_count()))->at);
      }
      options.protect.push_back({1 << 28, 3});  // no sample
      const auto outcome = simplify(source, options, nullptr);
      if (!outcome.ok()) continue;  // a hull of many corners
      const Terrain result = applied(source, *outcome);
      expect_true_report(source, result, *outcome);
      for (const Point p : options.protect) {
        const auto where = result.triangulation().locate(p);
        EXPECT_EQ(where.kind == tin::delaunay::Location::Kind::kOnVertex, p.x != 1 << 28);
      }
    }
  }
}

TEST_F(SimplifyTest, RefusesImpossibleOptions) {
  const Terrain source =
      support::raster_terrain(heights(3, 3, [](auto, auto) { return std::optional(1.0); }));
  const double nan = std::numeric_limits<double>::quiet_NaN(),
               infinity = std::numeric_limits<double>::infinity();
  for (const Options& options : {Options{}, to(-1), to(nan), to(infinity), to(-infinity)}) {
    const auto refused = simplify(source, options, nullptr);
    ASSERT_FALSE(refused.ok());
    EXPECT_EQ(refused.error().code, Code::kInvalidValue);
  }
  EXPECT_TRUE(simplify(source, to(std::numeric_limits<double>::max()), nullptr).ok());
  EXPECT_TRUE(simplify(source, to(std::numeric_limits<double>::denorm_min()), nullptr).ok());
}

TEST_F(SimplifyTest, ALineOfSamplesStaysAsItIs) {
  for (const std::size_t count : {0UL, 1UL, 2UL, 3UL, 40UL}) {
    std::vector<Placement> placements;
    for (const Point p : support::line_points(count, 3, -2)) placements.push_back({p, 1.0});
    const Terrain source = *Terrain::build({}, placements, Duplicates::kReject);
    const auto outcome = simplify(source, to(10), nullptr);
    ASSERT_TRUE(outcome.ok());
    EXPECT_TRUE(outcome->removed.empty());
    EXPECT_EQ(outcome->report.vertices_after, count);
    EXPECT_EQ(outcome->report.max_error, 0);
    EXPECT_TRUE(simplify(source, at_most(count), nullptr).ok());
    if (count > 0) {
      EXPECT_FALSE(simplify(source, at_most(count - 1), nullptr).ok());
    }
  }
  const Terrain row =
      support::raster_terrain(heights(30, 1, [](auto c, auto) { return std::optional<double>(c % 7); }));
  EXPECT_TRUE(simplify(row, to(1), nullptr)->removed.empty());
}

}  // namespace
