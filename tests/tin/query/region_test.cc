#include "tin/query/region.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/support/point_sets.h"
#include "tin/exact/predicates.h"

namespace {

using tin::base::Code;
using tin::exact::Point;
using tin::query::Region;
using tin::query::Ring;

std::int64_t twice_area(std::span<const Region::Triangle> triangles) {
  std::int64_t sum = 0;
  for (const auto& [a, b, c] : triangles) {
    EXPECT_GT(tin::exact::orientation(a, b, c), 0);
    sum += tin::exact::orientation(a, b, c);
  }
  return sum;
}

std::int64_t shoelace(const Ring& ring) {
  std::int64_t sum = 0;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const Point a = ring[i], b = ring[(i + 1) % ring.size()];
    sum += std::int64_t{a.x} * b.y - std::int64_t{a.y} * b.x;
  }
  return std::abs(sum);
}

/// By the winding of the ring around the centre of each triangle: it must be inside.
bool centre_inside(const Ring& ring, const Region::Triangle& t) {
  const double x = (double(t[0].x) + t[1].x + t[2].x) / 3, y = (double(t[0].y) + t[1].y + t[2].y) / 3;
  double turned = 0;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const Point a = ring[i], b = ring[(i + 1) % ring.size()];
    turned += std::remainder(std::atan2(b.y - y, b.x - x) - std::atan2(a.y - y, a.x - x), 2 * M_PI);
  }
  return std::abs(turned) > 1;
}

void expect_cut_well(const Ring& ring) {
  const auto region = Region::make(std::vector<Ring>{ring});
  ASSERT_TRUE(region.ok()) << region.error().message;
  EXPECT_EQ(twice_area(region->outline()), shoelace(ring));
  for (const auto& t : region->outline()) EXPECT_TRUE(centre_inside(ring, t));
}

TEST(RegionTest, CutsRingsOfEitherOrientationIntoTrianglesOfTheirArea) {
  Ring square{{0, 0}, {10, 0}, {10, 10}, {0, 10}};
  expect_cut_well(square);
  std::reverse(square.begin(), square.end());
  expect_cut_well(square);
  expect_cut_well({{0, 0}, {5, 0}, {10, 0}, {10, 10}, {5, 10}, {0, 10}, {0, 5}});
  expect_cut_well({{0, 0}, {10, 0}, {10, 1}, {1, 1}, {1, 9}, {10, 9}, {10, 10}, {0, 10}});
  expect_cut_well({{0, 0},
                   {30, 0},
                   {30, 30},
                   {6, 30},
                   {6, 10},
                   {18, 10},
                   {18, 20},
                   {12, 20},
                   {12, 14},
                   {14, 14},
                   {14, 18},
                   {16, 18},
                   {16, 12},
                   {8, 12},
                   {8, 26},
                   {26, 26},
                   {26, 4},
                   {0, 4}});
}

TEST(RegionTest, CutsStarsAndSpiralsOfManyCorners) {
  support::Random random(support::seed());
  SCOPED_TRACE("TINSMITH_SEED=" + std::to_string(support::seed()));
  std::uniform_real_distribution<double> radius(1e5, 1e6);
  for (const int n : {5, 50, 1000}) {
    Ring star;
    for (int i = 0; i < n; ++i) {
      const double r = radius(random), angle = 2 * M_PI * i / n;
      star.push_back(
          {static_cast<std::int32_t>(r * std::cos(angle)), static_cast<std::int32_t>(r * std::sin(angle))});
    }
    expect_cut_well(star);
  }
  Ring spiral;
  for (int i = 0; i <= 300; ++i)
    spiral.push_back({static_cast<std::int32_t>((1000 + 100 * i) * std::cos(i * 0.1)),
                      static_cast<std::int32_t>((1000 + 100 * i) * std::sin(i * 0.1))});
  for (int i = 300; i >= 0; --i)
    spiral.push_back({static_cast<std::int32_t>((3000 + 100 * i) * std::cos(i * 0.1)),
                      static_cast<std::int32_t>((3000 + 100 * i) * std::sin(i * 0.1))});
  expect_cut_well(spiral);
}

TEST(RegionTest, DropsRepeatedPositions) {
  const auto region = Region::make(std::vector<Ring>{{{0, 0}, {0, 0}, {10, 0}, {10, 10}, {10, 10}, {0, 0}}});
  ASSERT_TRUE(region.ok());
  EXPECT_EQ(twice_area(region->outline()), 100);
}

TEST(RegionTest, TakesHolesInside) {
  const Ring outline{{0, 0}, {100, 0}, {100, 100}, {0, 100}}, hole{{10, 10}, {20, 10}, {20, 30}},
      other{{50, 50}, {60, 50}, {60, 60}, {50, 60}};
  const auto region = Region::make(std::vector<Ring>{outline, hole, other});
  ASSERT_TRUE(region.ok());
  EXPECT_EQ(twice_area(region->holes()), 200 + 200);
}

TEST(RegionTest, RefusesRingsThatAreNoSimplePolygons) {
  const auto refused = [](const std::vector<Ring>& rings, const std::string& where) {
    const auto region = Region::make(rings);
    ASSERT_FALSE(region.ok());
    EXPECT_EQ(region.error().code, Code::kInvalidValue);
    EXPECT_EQ(region.error().where, where);
  };
  refused({}, "");
  refused({{{0, 0}, {1, 1}}}, "/0");
  refused({{{0, 0}, {5, 5}, {0, 0}, {5, 5}}}, "/0/1");
  refused({{{0, 0}, {10, 10}, {10, 0}, {0, 10}}}, "/0/2");
  refused({{{0, 0}, {10, 0}, {20, 0}}}, "/0/2");
  refused({{{0, 0}, {10, 0}, {5, 0}, {5, 9}}}, "/0/1");
  const Ring outline{{0, 0}, {100, 0}, {100, 100}, {0, 100}};
  refused({outline, {{200, 0}, {210, 0}, {210, 10}}}, "/1");
  refused({outline, {{10, 10}, {40, 10}, {10, 40}}, {{12, 12}, {20, 12}, {12, 20}}}, "/2");
  EXPECT_FALSE(Region::make(std::vector<Ring>{outline, {{0, 50}, {10, 40}, {10, 60}}}).ok()) << "touches";
  EXPECT_FALSE(Region::make(std::vector<Ring>{outline, {{-10, 50}, {10, 40}, {10, 60}}}).ok()) << "crosses";
}

}  // namespace
