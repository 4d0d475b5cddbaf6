#include <gtest/gtest.h>

#include <cmath>

#include "tests/tin/query/analytic.h"
#include "tin/query/elevation.h"
#include "tin/query/profile.h"

namespace {

using tin::base::Code;
using tin::exact::Point;
using tin::query::ElevationQuery;
using tin::query::line_of_sight;
using tin::query::Sight;
using tin::query::SightRequest;
using tin::query::Voids;
using tin::terrain::Terrain;

Sight sight(const Terrain& terrain, const SightRequest& request) {
  const auto found = line_of_sight(terrain, support::metre_ground(), request, 100'000);
  EXPECT_TRUE(found.ok());
  return *found;
}

/// A ridge across the middle of level ground: 10 high at x = 500.
Terrain ridge() {
  return support::terrain_of({{0, 0},
                              {400, 0},
                              {500, 0},
                              {600, 0},
                              {1000, 0},
                              {0, 100},
                              {400, 100},
                              {500, 100},
                              {600, 100},
                              {1000, 100}},
                             [](Point p) { return p.x == 500 ? 10.0 : 0.0; });
}

TEST(LineOfSightTest, IsBlockedByARidgeAndPassesOverIt) {
  const Terrain terrain = ridge();
  const Sight low = sight(terrain, {{0, 50}, {1000, 50}, 5, 5});
  EXPECT_FALSE(low.visible);
  ASSERT_TRUE(low.blocked_at.has_value());
  EXPECT_NEAR(low.blocked_at->distance, 450, 1e-3) << "halfway up the slope";
  EXPECT_NEAR(low.closest.distance, 500, 1e-9);
  EXPECT_NEAR(low.closest.clearance, -5, 1e-9);
  EXPECT_DOUBLE_EQ(low.distance, 1000);
  const Sight high = sight(terrain, {{0, 50}, {1000, 50}, 12, 11});
  EXPECT_TRUE(high.visible);
  EXPECT_NEAR(high.closest.clearance, 1.5, 1e-9);
  EXPECT_FALSE(high.blocked_at.has_value());
}

TEST(LineOfSightTest, TouchingTheGroundDoesNotBlock) {
  const Terrain terrain = ridge();
  EXPECT_TRUE(sight(terrain, {{0, 50}, {1000, 50}, 10, 10}).visible);
  EXPECT_TRUE(sight(terrain, {{0, 50}, {400, 50}}).visible);
  support::Random random(support::seed());
  const Terrain slope = support::terrain_of(support::random_points(random, 300, 1000), support::plane);
  ElevationQuery query(slope, Voids::kKeep);
  for (const Point p : support::random_points(random, 200, 700)) {
    if (query.at(p)) {
      EXPECT_TRUE(sight(slope, {{0, 0}, p}).visible);
    }
  }
}

TEST(LineOfSightTest, IsTheSameFromBothEnds) {
  support::Random random(support::seed());
  SCOPED_TRACE("TINSMITH_SEED=" + std::to_string(support::seed()));
  std::uniform_real_distribution<double> height(0, 50);
  const Terrain terrain =
      support::terrain_of(support::random_points(random, 200, 1000), [&](Point) { return height(random); });
  const auto at = support::random_points(random, 60, 600);
  ElevationQuery query(terrain, Voids::kKeep);
  int blocked = 0;
  for (std::size_t i = 1; i < at.size(); ++i) {
    if (!query.at(at[i - 1]) || !query.at(at[i])) continue;
    const Sight there = sight(terrain, {at[i - 1], at[i], 20, 15, true}),
                back = sight(terrain, {at[i], at[i - 1], 15, 20, true});
    EXPECT_EQ(there.visible, back.visible);
    EXPECT_NEAR(there.closest.clearance, back.closest.clearance, 1e-9);
    // The least clearance, by trying many places.
    double least = 1e9;
    const double length = there.distance;
    for (int k = 0; k <= 2000; ++k) {
      const double u = k / 2000.0;
      const Point p{static_cast<std::int32_t>(std::lround(at[i - 1].x + u * (at[i].x - at[i - 1].x))),
                    static_cast<std::int32_t>(std::lround(at[i - 1].y + u * (at[i].y - at[i - 1].y)))};
      const double d = std::hypot(double(p.x) - at[i - 1].x, double(p.y) - at[i - 1].y);
      const double line = there.observer_z + (there.target_z - there.observer_z) * d / length;
      least = std::min(least, line - query.at(p)->z);
    }
    EXPECT_NEAR(there.closest.clearance, least, 2.0);
    EXPECT_LE(there.closest.clearance, least + 1e-3 + 0.5)
        << "no place tried is lower, but for rounding to the lattice";
    if (!there.visible) ++blocked;
  }
  EXPECT_GT(blocked, 5);
}

TEST(LineOfSightTest, OverASeaEndsAtTheHorizon) {
  // From 2 m above the sea the horizon without refraction is sqrt(2 R h) = 5048.2 m away.
  const Terrain sea =
      support::terrain_of({{0, -10}, {20'000, -10}, {20'000, 10}, {0, 10}}, [](Point) { return 0.0; });
  SightRequest request{{0, 0}, {0, 0}, 2, 0, true, 0};
  request.target = {5040, 0};
  EXPECT_TRUE(sight(sea, request).visible);
  request.target = {5060, 0};
  const Sight beyond = sight(sea, request);
  EXPECT_FALSE(beyond.visible);
  EXPECT_NEAR(beyond.closest.distance, 5048.2, 0.1) << "the sea bulges between the vertices";
  request.curvature = false;
  EXPECT_TRUE(sight(sea, request).visible);
  request.curvature = true;
  request.refraction = 0.13;  // 5412 m
  EXPECT_TRUE(sight(sea, request).visible);
  request.target = {5420, 0};
  EXPECT_FALSE(sight(sea, request).visible);
}

TEST(LineOfSightTest, NeedsASurfaceAtBothEnds) {
  const Terrain terrain = ridge();
  const auto ground = support::metre_ground();
  const auto out = line_of_sight(terrain, ground, {{-1, 50}, {1000, 50}}, 1000);
  EXPECT_EQ(out.error().code, Code::kInvalidValue);
  EXPECT_EQ(out.error().where, "observer");
  EXPECT_EQ(line_of_sight(terrain, ground, {{0, 50}, {1001, 50}}, 1000).error().where, "target");
  for (const auto& [name, degenerate] : support::degenerate_terrains()) {
    const auto found = line_of_sight(degenerate, ground, {{0, 0}, {6, 0}}, 1000);
    if (found) {
      EXPECT_TRUE(found->visible) << name;
    }
  }
  const Sight here = sight(terrain, {{10, 10}, {10, 10}, 1, 2});
  EXPECT_TRUE(here.visible);
  EXPECT_EQ(here.distance, 0);
}

}  // namespace
