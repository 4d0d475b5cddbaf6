// Plateaus that must stay flat.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/tin/simplify/judge.h"
#include "tests/tin/simplify/runs.h"
#include "tests/tin/simplify/terrains.h"
#include "tin/mesh/validate.h"

namespace {

using support::applied;
using support::at_most;
using support::expect_kept;
using support::heights;
using support::simplify;
using support::SimplifyTest;
using support::to;
using tin::exact::Point;
using tin::simplify::Effort;
using tin::simplify::Elevations;
using tin::simplify::Options;
using tin::terrain::Placement;
using tin::terrain::Terrain;

constexpr std::int32_t kWidth = 80, kHeight = 70;

/// A jagged lake at height 40 among hills, a sea at 0 along the north, and a pond of nine samples.
double lake_district(std::int32_t c, std::int32_t r) {
  const double hill = std::round(60 + 30 * std::sin(c * 0.35) * std::cos(r * 0.28));
  const double x = c - 40, y = r - 42, shore = 14 + 2.5 * std::sin(std::atan2(y, x) * 9);
  if (x * x + y * y < shore * shore) return 40;
  if (r < 12) return 0;
  if (c >= 5 && c < 8 && r >= 30 && r < 33) return 55;
  return hill;
}

Terrain lakes() {
  return support::raster_terrain(
      heights(kWidth, kHeight, [](auto c, auto r) { return std::optional(lake_district(c, r)); }));
}

/// The samples that are level with the up to eight around them, of the lake and of the sea.
std::vector<Point> level_samples(const Terrain& source) {
  std::vector<Point> out;
  const auto& grid = *source.source_grid();
  for (std::int32_t r = 0; r < kHeight; ++r) {
    for (std::int32_t c = 0; c < kWidth; ++c) {
      const double z = lake_district(c, r);
      bool level = z == 0 || z == 40;
      for (std::int32_t i = 0; i < 9 && level; ++i) {
        const std::int32_t column = c + i % 3 - 1, row = r + i / 3 - 1;
        if (column < 0 || row < 0 || column >= kWidth || row >= kHeight) continue;
        level = lake_district(column, row) == z;
      }
      if (level) out.push_back(grid.centre(c, r));
    }
  }
  return out;
}

/// How far the surface is from the heights at these places.
double largest_tilt(const Terrain& source, const Terrain& result, const std::vector<Point>& places) {
  std::vector<Placement> samples;
  for (const Point p : places) {
    const auto where = source.triangulation().locate(p);
    samples.push_back({p, source.z(where.vertex)});
  }
  const Terrain level = *Terrain::build({}, samples, tin::terrain::Duplicates::kReject);
  for (const double tilt : {0.0, 0.25, 1.0, 4.0, 16.0}) {
    if (!support::judge(level, result, tilt)) return tilt;
  }
  return 1e9;
}

Options flat(Options options, std::size_t least = 30) {
  options.keep_flat = least;
  return options;
}

class PlateauTest : public SimplifyTest {};

TEST_F(PlateauTest, ALakeAndTheSeaStayFlatWhileTheRestIsThinned) {
  const Terrain source = lakes();
  const auto level = level_samples(source);
  ASSERT_GT(level.size(), 1000U);
  for (Options options : {to(12), to(12, Effort::kThorough)}) {
    EXPECT_GT(largest_tilt(source, expect_kept(source, options), level), 0) << "or this test shows nothing";
    for (const Elevations elevations : {Elevations::kSource, Elevations::kFit}) {
      options.elevations = elevations;
      const Terrain result = expect_kept(source, flat(options));
      EXPECT_EQ(largest_tilt(source, result, level), 0);
      EXPECT_LT(result.vertex_count(), source.vertex_count() / 8);
      EXPECT_EQ(simplify(source, flat(options), nullptr)->report.level, level.size());
    }
  }
  EXPECT_EQ(simplify(source, flat(to(0)), nullptr)->report.level, level.size());
}

TEST_F(PlateauTest, SmallPlateausAndPondsMayBeTilted) {
  const Terrain source = lakes();
  const std::size_t all = level_samples(source).size();
  EXPECT_EQ(simplify(source, flat(to(12), 100'000), nullptr)->report.level, 0U);
  const auto lake_only = simplify(source, flat(to(12), 480), nullptr)->report.level;
  EXPECT_GT(lake_only, 480U);
  // The pond has one sample that is level with all around it.
  EXPECT_EQ(simplify(source, flat(to(12), 1), nullptr)->report.level, all + 1);
}

TEST_F(PlateauTest, HardRastersKeepTheTolerance) {
  for (const auto& [name, raster] : support::hard_rasters(random_, 26)) {
    SCOPED_TRACE(name);
    const Terrain source = support::raster_terrain(raster);
    for (const double tolerance : {0.0, 3.0, 1e9}) {
      Options options = flat(to(tolerance, Effort::kBalanced), 4);
      expect_kept(source, options);
      options.elevations = Elevations::kFit;
      expect_kept(source, options);
    }
  }
}

TEST_F(PlateauTest, ScatteredPointsHavePlateausToo) {
  std::vector<Placement> placements;
  for (const Point p : support::random_points(random_, 1500, 2000)) {
    const double far = std::hypot(p.x, p.y);
    placements.push_back({p, far < 900 ? 10.0 : std::round(far / 20 + static_cast<double>(random_() % 9))});
  }
  const Terrain source = *Terrain::build({}, placements, tin::terrain::Duplicates::kKeep);
  const auto outcome = simplify(source, flat(to(15, Effort::kBalanced)), nullptr);
  ASSERT_TRUE(outcome.ok());
  const Terrain result = applied(source, *outcome);
  EXPECT_EQ(support::judge(source, result, 15).value_or(""), "");
  EXPECT_GT(outcome->report.level, 100U);
  // Level by the words of the rule: all that the triangulation links them to has their height.
  std::vector<Placement> level;
  std::vector<tin::mesh::HalfEdge> link;
  for (std::uint32_t i = 1; i < source.mesh().vertex_slots(); ++i) {
    const tin::mesh::VertexSlot v(i);
    source.mesh().link(v, link);
    const bool same = std::all_of(link.begin(), link.end(), [&](auto e) {
      const auto other = source.mesh().origin(e);
      return other == tin::mesh::kInfinite || source.z(other) == source.z(v);
    });
    if (same && source.z(v) == 10) level.push_back({source.mesh().point(v), source.z(v)});
  }
  EXPECT_EQ(outcome->report.level, level.size());
  const Terrain samples = *Terrain::build({}, level, tin::terrain::Duplicates::kReject);
  EXPECT_EQ(support::judge(samples, result, 0).value_or(""), "");
}

TEST_F(PlateauTest, ABudgetThatIsTooSmallForThemSaysSo) {
  const Terrain source = lakes();
  const auto outcome = simplify(source, flat(at_most(12, Effort::kBalanced)), nullptr);
  ASSERT_TRUE(outcome.ok());
  EXPECT_LE(outcome->report.vertices_after, 12U);
  EXPECT_FALSE(outcome->report.tolerance_met);
  const auto enough = simplify(source, flat(at_most(3000, Effort::kFast)), nullptr);
  EXPECT_TRUE(enough->report.tolerance_met);
}

}  // namespace
