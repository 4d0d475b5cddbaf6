// The surface between the samples counts, too.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/tin/simplify/judge.h"
#include "tests/tin/simplify/runs.h"
#include "tests/tin/simplify/terrains.h"
#include "tin/mesh/validate.h"

namespace {

using support::applied;
using support::expect_kept;
using support::heights;
using support::judge_surface;
using support::simplify;
using support::SimplifyTest;
using support::to;
using tin::simplify::Against;
using tin::simplify::Effort;
using tin::simplify::Elevations;
using tin::simplify::Options;
using tin::terrain::Duplicates;
using tin::terrain::Placement;
using tin::terrain::Terrain;

Options of_surface(Options options) {
  options.against = Against::kSurface;
  return options;
}

class SurfaceTest : public SimplifyTest {
 protected:
  /// All that is promised, and that the report states the largest distance.
  Terrain expect_surface_kept(const Terrain& source, const Options& options) {
    Terrain result = expect_kept(source, of_surface(options));
    const auto report = simplify(source, of_surface(options), nullptr)->report;
    EXPECT_EQ(judge_surface(source, result, *options.tolerance).value_or(""), "") << *options.tolerance;
    if (report.max_error > 1e-6 && report.max_error < 1e100) {
      const double below = report.max_error * (1 - 1e-9);
      EXPECT_TRUE(judge_surface(source, result, below) || support::judge(source, result, below));
    }
    return result;
  }
};

TEST_F(SurfaceTest, HardRastersStayWithinTheToleranceEverywhere) {
  for (const auto& [name, raster] : support::hard_rasters(random_, 14)) {
    SCOPED_TRACE(name);
    const Terrain source = support::raster_terrain(raster);
    for (const double tolerance : {0.0, 1.0, 6.0, 1e9}) {
      expect_surface_kept(source, to(tolerance));
      Options options = to(tolerance, Effort::kBalanced);
      options.elevations = Elevations::kFit;
      expect_surface_kept(source, options);
    }
  }
}

TEST_F(SurfaceTest, ScatteredSamplesStayWithinTheToleranceEverywhere) {
  for (const std::int32_t extent : {30, 3000, tin::exact::kLatticeHalf - 1}) {
    const Terrain source = support::scattered_terrain(random_, 160, extent, extent == 3000);
    for (const double tolerance : {0.5, 5.0}) {
      expect_surface_kept(source, to(tolerance));
      expect_surface_kept(source, to(tolerance, Effort::kBalanced));
    }
  }
}

TEST_F(SurfaceTest, WhatLiesBetweenTheSamplesIsFound) {
  // The samples alone do not see where two roofs cross: with them only, the surface is missed by more.
  int missed = 0;
  for (int round = 0; round < 6; ++round) {
    const Terrain source = support::raster_terrain(
        heights(16, 14, [&](auto, auto) { return std::optional<double>(random_() % 40); }));
    const Terrain samples_only = expect_kept(source, to(8, Effort::kBalanced));
    missed += judge_surface(source, samples_only, 8) ? 1 : 0;
    const auto report = simplify(source, of_surface(to(8, Effort::kBalanced)), nullptr)->report;
    EXPECT_GT(report.crossings, 10U);
    expect_surface_kept(source, to(8, Effort::kBalanced));
  }
  EXPECT_GT(missed, 0);
}

TEST_F(SurfaceTest, AWorstPlaceBetweenSamplesIsNamed) {
  int between = 0;
  for (int round = 0; round < 12; ++round) {
    const Terrain source = support::raster_terrain(
        heights(12, 12, [&](auto, auto) { return std::optional<double>(random_() % 30); }));
    const auto outcome = simplify(source, of_surface(to(7.5)), nullptr);
    const auto& worst = outcome->report.worst;
    ASSERT_TRUE(worst.has_value());
    if (!worst->between) continue;
    ++between;
    EXPECT_GT(worst->between->along, 0);
    EXPECT_LT(worst->between->along, 1);
    EXPECT_FALSE(worst->source_index.has_value());
    EXPECT_EQ(worst->error, outcome->report.max_error);
  }
  EXPECT_GT(between, 0);
}

TEST_F(SurfaceTest, ThreadsAndTilesDoNotMatter) {
  const Terrain source = support::raster_terrain(heights(300, 260, [&](auto c, auto r) {
    return std::optional(
        std::round(50 * std::sin(c * 0.09) * std::cos(r * 0.07) + static_cast<double>(random_() % 5)));
  }));
  Options options = of_surface(to(4, Effort::kBalanced));
  const auto one = simplify(source, options, nullptr);
  options.threads = 2;
  const auto two = simplify(source, options, nullptr);
  ASSERT_TRUE(one.ok() && two.ok());
  EXPECT_EQ(one->removed, two->removed);
  EXPECT_EQ(one->report.max_error, two->report.max_error);
  EXPECT_EQ(one->report.crossings, two->report.crossings);
  EXPECT_EQ(tin::mesh::validate(applied(source, *one).mesh()).value_or(""), "");
}

TEST_F(SurfaceTest, PlateausAndProtectedVerticesGoWithIt) {
  const Terrain source = support::raster_terrain(heights(24, 20, [](auto c, auto r) {
    return std::optional(c > 4 && c < 15 && r > 4 && r < 15
                             ? 20.0
                             : std::round(20 + 9 * std::sin(c * 0.7) + 7 * std::cos(r * 0.9)));
  }));
  Options options = to(4, Effort::kBalanced);
  options.keep_flat = 20;
  options.protect.push_back(source.source_grid()->centre(2, 2));
  const Terrain result = expect_surface_kept(source, options);
  EXPECT_EQ(result.triangulation().locate(options.protect[0]).kind, tin::delaunay::Location::Kind::kOnVertex);
  EXPECT_GE(simplify(source, of_surface(options), nullptr)->report.level, 64U);
}

}  // namespace
