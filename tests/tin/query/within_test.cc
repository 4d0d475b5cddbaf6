#include "tin/query/within.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <optional>
#include <random>

#include "tests/support/point_sets.h"
#include "tin/exact/predicates.h"

namespace {

using tin::exact::orientation;
using tin::exact::Point;
using tin::query::Inside;
using tin::query::Ring;
using tin::terrain::VertexId;

bool on_segment(Point a, Point b, Point p) {
  return orientation(a, b, p) == 0 && p.x >= std::min(a.x, b.x) && p.x <= std::max(a.x, b.x) &&
         p.y >= std::min(a.y, b.y) && p.y <= std::max(a.y, b.y);
}

/// By the parity of the triangles of a fan that hold it; nothing when it lies on one of their sides.
std::optional<bool> in_odd_number_of_a_fan(const Ring& ring, Point p) {
  bool odd = false;
  for (std::size_t i = 1; i + 1 < ring.size(); ++i) {
    const Point a = ring[0], b = ring[i], c = ring[i + 1];
    if (on_segment(a, b, p) || on_segment(b, c, p) || on_segment(c, a, p)) return std::nullopt;
    const std::int64_t at_ab = orientation(a, b, p), at_bc = orientation(b, c, p),
                       at_ca = orientation(c, a, p);
    if ((at_ab > 0 && at_bc > 0 && at_ca > 0) || (at_ab < 0 && at_bc < 0 && at_ca < 0)) odd = !odd;
  }
  return odd;
}

TEST(InsideTest, ASquareHoldsItsSidesAndCorners) {
  const Inside square({{0, 0}, {10, 0}, {10, 10}, {0, 10}});
  for (const Point p :
       {Point{0, 0}, Point{10, 10}, Point{5, 0}, Point{0, 5}, Point{10, 7}, Point{3, 10}, Point{1, 1}})
    EXPECT_TRUE(square.holds(p)) << p.x << " " << p.y;
  for (const Point p : {Point{-1, 5}, Point{11, 5}, Point{5, -1}, Point{5, 11}, Point{-1, 0}, Point{11, 10}})
    EXPECT_FALSE(square.holds(p)) << p.x << " " << p.y;
}

TEST(InsideTest, DegenerateRingsHoldTheirSidesOnly) {
  const Inside line({{0, 0}, {10, 10}, {4, 4}});
  EXPECT_TRUE(line.holds({7, 7}));
  EXPECT_FALSE(line.holds({7, 6}));
  EXPECT_FALSE(Inside(Ring{}).holds({0, 0}));
  EXPECT_FALSE(Inside({{3, 3}, {3, 3}, {3, 3}}).holds({4, 3}));
}

TEST(InsideTest, AHoleIsOutsideAndItsSidesAreInside) {
  const std::vector<Ring> rings{{{0, 0}, {10, 0}, {10, 10}, {0, 10}}, {}, {{4, 4}, {4, 6}, {6, 6}, {6, 4}}};
  const Inside holed(rings);
  for (const Point p : {Point{0, 0}, Point{1, 5}, Point{9, 5}, Point{4, 5}, Point{6, 6}, Point{5, 4}})
    EXPECT_TRUE(holed.holds(p)) << p.x << " " << p.y;
  EXPECT_FALSE(holed.holds({5, 5}));
  EXPECT_FALSE(holed.holds({11, 5}));
}

TEST(InsideTest, AgreesWithTheFanOfAnyRingThatMayCrossItself) {
  const std::uint64_t seed = support::seed();
  std::mt19937_64 random(seed);
  int inside = 0, judged = 0;
  for (int round = 0; round < 400; ++round) {
    // Few values: many equal heights, horizontal sides and corners on the point's line.
    const std::int32_t range = round % 2 == 0 ? 8 : tin::exact::kLatticeHalf - 1;
    std::uniform_int_distribution<std::int32_t> value(-range, range);
    Ring ring(3 + random() % 12);
    for (Point& p : ring) p = {value(random), value(random)};
    const Inside polygon(ring);
    for (int i = 0; i < 200; ++i) {
      const Point p{value(random), value(random)};
      const auto expected = in_odd_number_of_a_fan(ring, p);
      if (!expected) continue;
      EXPECT_EQ(polygon.holds(p), *expected)
          << "seed " << seed << " round " << round << ": " << p.x << " " << p.y;
      inside += *expected ? 1 : 0;
      ++judged;
    }
  }
  EXPECT_GT(inside, judged / 20);
}

TEST(VerticesWithinTest, GivesIdsInOrderAndStopsPastTheMost) {
  std::vector<tin::terrain::Placement> placements;
  for (int y = 9; y >= 0; --y) {
    for (int x = 0; x < 10; ++x) placements.push_back({{x * 10, y * 10}, 0.0});
  }
  const auto terrain =
      tin::terrain::Terrain::build({}, placements, tin::terrain::Duplicates::kReject).value();
  const Ring ring{{20, 60}, {40, 60}, {40, 80}, {20, 80}};
  const std::vector<VertexId> expected{VertexId(13), VertexId(14), VertexId(15), VertexId(23), VertexId(24),
                                       VertexId(25), VertexId(33), VertexId(34), VertexId(35)};
  EXPECT_EQ(tin::query::vertices_within(terrain, ring, 9), expected);
  EXPECT_EQ(tin::query::vertices_within(terrain, ring, 8).size(), 9U);
  EXPECT_EQ(tin::query::vertices_within(terrain, ring, 3).size(), 4U);
}

}  // namespace
