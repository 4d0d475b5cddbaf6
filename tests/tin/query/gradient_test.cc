#include "tin/query/gradient.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/tin/query/analytic.h"

namespace {

using tin::exact::Point;
using tin::frame::Frame;
using tin::frame::Ground;
using tin::query::aspect_degrees;
using tin::query::Gradient;
using tin::query::GradientQuery;
using tin::query::Shade;
using tin::query::slope_degrees;
using tin::query::Sun;
using tin::query::Voids;
using tin::terrain::Terrain;

TEST(GradientTest, OfAPlaneIsThePlanesEverywhere) {
  support::Random random(support::seed());
  SCOPED_TRACE("TINSMITH_SEED=" + std::to_string(support::seed()));
  const Terrain terrain = support::terrain_of(support::random_points(random, 300, 1000), support::plane);
  const Ground ground = support::metre_ground();
  GradientQuery query(terrain, Voids::kKeep, ground);
  int inside = 0;
  for (const Point p : support::random_points(random, 1000, 1000)) {
    const auto found = query.at(p);
    if (!found) continue;
    ++inside;
    EXPECT_NEAR(found->east, 0.25, 1e-9);
    EXPECT_NEAR(found->north, -0.5, 1e-9);
  }
  EXPECT_GT(inside, 700);
  for (std::uint32_t v = 1; v < terrain.mesh().vertex_slots(); ++v) {
    EXPECT_NEAR(query.at_vertex(tin::mesh::VertexSlot(v)).north, -0.5, 1e-9);
  }
}

TEST(GradientTest, AtAVertexOfARegularGridIsTheCentralDifference) {
  const auto bowl = [](Point p) { return 0.01 * p.x * p.x + 0.02 * p.y * p.y; };
  const Terrain terrain = support::terrain_of(support::grid_points(9, 9, 10), bowl);
  const Ground ground = support::metre_ground();
  GradientQuery query(terrain, Voids::kKeep, ground);
  for (const Point p : support::grid_points(7, 7, 10, {10, 10})) {
    EXPECT_NEAR(query.at(p)->east, 0.02 * p.x, 1e-12);
    EXPECT_NEAR(query.at(p)->north, 0.04 * p.y, 1e-12);
  }
}

TEST(GradientTest, CountsInMetresOnTheGround) {
  // A degree of longitude at 60 degrees north is half as long as at the equator, about.
  Frame frame;
  frame.x = frame.y = {0, 1, 1'000'000};
  frame.y.origin = 60;
  frame.vertical_unit_m = 0.3048;
  std::vector<tin::terrain::Placement> placements;
  for (const Point p : support::grid_points(5, 5, 1000)) placements.push_back({p, p.x * 0.1 + p.y * 0.1});
  const Terrain terrain = *Terrain::build(frame, placements, tin::terrain::Duplicates::kReject);
  const Ground ground(frame, {.geographic = true});
  GradientQuery query(terrain, Voids::kKeep, ground);
  const auto found = query.at({1500, 1700});
  ASSERT_TRUE(found.has_value());
  const auto degree = tin::frame::degree_lengths(60.0017);
  EXPECT_NEAR(found->east, 0.1 * 1e6 * 0.3048 / degree.lon_m, 1e-9);
  EXPECT_NEAR(found->north, 0.1 * 1e6 * 0.3048 / degree.lat_m, 1e-9);
  EXPECT_NEAR(degree.lon_m, 55'800, 100);
}

TEST(GradientTest, IsNothingOutsideAndWithoutTriangles) {
  const Ground ground = support::metre_ground();
  for (const auto& [name, terrain] : support::degenerate_terrains()) {
    GradientQuery query(terrain, Voids::kKeep, ground);
    for (const Point p : {Point{4, 7}, Point{0, 0}, Point{6, 0}})
      EXPECT_EQ(query.at(p), std::nullopt) << name;
  }
  const Terrain terrain = support::terrain_of(support::grid_points(3, 3, 10), support::plane);
  GradientQuery query(terrain, Voids::kKeep, ground);
  EXPECT_EQ(query.at({21, 0}), std::nullopt);
}

TEST(SlopeTest, IsTheAngleAndAspectWhereTheSurfaceFaces) {
  EXPECT_DOUBLE_EQ(slope_degrees({1, 0}), 45);
  EXPECT_EQ(slope_degrees({0, 0}), 0);
  EXPECT_NEAR(slope_degrees({3, 4}), std::atan(5) * 180 / M_PI, 1e-12);
  EXPECT_EQ(aspect_degrees({0, 0}), std::nullopt);
  EXPECT_EQ(aspect_degrees({0, -1}), 0) << "falls to the north";
  EXPECT_EQ(aspect_degrees({-1, 0}), 90);
  EXPECT_EQ(aspect_degrees({0, 1}), 180);
  EXPECT_EQ(aspect_degrees({1, 0}), 270);
  EXPECT_EQ(aspect_degrees({1e-300, -1}), 0) << "a full turn is north";
}

TEST(ShadeTest, IsTheCosineOfTheLightsAngle) {
  const Shade north_west(Sun{});
  EXPECT_NEAR(north_west({0, 0}), std::sqrt(0.5), 1e-15);
  const double lean = std::sqrt(0.5);
  EXPECT_NEAR(north_west({lean, -lean}), 1, 1e-15) << "faces the sun";
  EXPECT_NEAR(north_west({-lean, lean}), 0, 1e-15) << "light grazes";
  EXPECT_EQ(north_west({-5, 5}), 0) << "in the shade";
  const Shade twice(Sun{315, 45, 2});
  EXPECT_NEAR(twice({lean / 2, -lean / 2}), 1, 1e-15);
}

}  // namespace
