#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "tests/support/oracle.h"
#include "tests/support/point_sets.h"
#include "tin/delaunay/triangulation.h"
#include "tin/mesh/validate.h"

namespace {

using support::Random;
using tin::delaunay::Hierarchy;
using tin::delaunay::Location;
using tin::delaunay::Triangulation;
using tin::exact::kLatticeHalf;
using tin::exact::Point;
using tin::mesh::VertexSlot;

/// Triangles crossed per query. Far below it means logarithmic: without help a walk crosses about the square root.
constexpr double kFewSteps = 60;

class LocateTest : public testing::Test {
 protected:
  static double steps_per_query(const Triangulation& t, const std::vector<Point>& queries) {
    std::uint64_t steps = 0;
    for (const Point p : queries) t.locate(p, &steps);
    return static_cast<double>(steps) / static_cast<double>(queries.size());
  }
  static double worst_steps(const Triangulation& t, const std::vector<Point>& queries) {
    std::uint64_t worst = 0;
    for (const Point p : queries) {
      std::uint64_t steps = 0;
      t.locate(p, &steps);
      worst = std::max(worst, steps);
    }
    return static_cast<double>(worst);
  }
  /// Clusters within clusters: each level a thousandth of the size of the one before.
  std::vector<Point> clustered(std::size_t count) {
    std::vector<Point> points;
    std::uniform_real_distribution<double> unit(-1, 1);
    std::uniform_int_distribution<int> depth(0, 2);
    while (points.size() < count) {
      double scale = 5e8 * std::pow(1e-3, depth(random_)) / 2;
      points.push_back({static_cast<std::int32_t>(scale * unit(random_) + 1e7), static_cast<std::int32_t>(scale * unit(random_) - 1e7)});
    }
    return points;
  }

  Random random_{support::seed()};
  testing::ScopedTrace trace_{__FILE__, __LINE__, "TINSMITH_SEED=" + std::to_string(support::seed())};
};

TEST_F(LocateTest, IsQuickOnClustersBuiltAtOnceOrGrownOneByOne) {
  const auto points = clustered(60'000);
  Triangulation bulk, grown;
  std::vector<VertexSlot> slots;
  ASSERT_TRUE(bulk.insert_many(points, slots));
  for (const Point p : points) grown.insert(p);
  auto queries = clustered(3000);
  const auto spread = support::random_points(random_, 3000, kLatticeHalf - 1);
  queries.insert(queries.end(), spread.begin(), spread.end());
  for (const Triangulation* t : {&bulk, &grown}) {
    EXPECT_LT(steps_per_query(*t, queries), kFewSteps);
    EXPECT_LT(worst_steps(*t, queries), 20 * kFewSteps);
  }
}

TEST_F(LocateTest, IsQuickWhenAClusterGrowsInOneCellOfTheGrid) {
  Triangulation t;
  std::vector<VertexSlot> slots;
  ASSERT_TRUE(t.insert_many(support::random_points(random_, 60'000, kLatticeHalf - 1), slots));
  // Fewer than would make the grid anew.
  const auto cluster = support::random_points(random_, 40'000, 5'000);
  for (const Point p : cluster) t.insert(p);
  EXPECT_LT(steps_per_query(t, support::random_points(random_, 3000, 5'000)), 2 * kFewSteps);
  EXPECT_EQ(tin::mesh::validate(t.mesh()).value_or(""), "");
}

TEST_F(LocateTest, IsQuickAfterMassDeletion) {
  const auto points = support::random_points(random_, 60'000, kLatticeHalf - 1);
  Triangulation t;
  std::vector<VertexSlot> slots;
  ASSERT_TRUE(t.insert_many(points, slots));
  std::shuffle(slots.begin(), slots.end(), random_);
  const auto queries = support::random_points(random_, 2000, kLatticeHalf - 1);
  for (const std::size_t keep : {30'000, 16'000, 5'000, 100}) {
    ASSERT_TRUE(t.remove_many(std::span(slots).subspan(keep)));
    slots.resize(keep);
    EXPECT_LT(steps_per_query(t, queries), kFewSteps) << keep;
  }
}

TEST_F(LocateTest, StaysQuickWhileVerticesComeAndGo) {
  std::vector<Point> present = support::random_points(random_, 20'000, kLatticeHalf - 1);
  Triangulation t;
  std::vector<VertexSlot> slots;
  ASSERT_TRUE(t.insert_many(present, slots));
  for (int round = 0; round < 60'000; ++round) {
    const std::size_t i = random_() % slots.size();
    t.remove(slots[i]);
    const Point p = support::random_points(random_, 1, kLatticeHalf - 1)[0];
    slots[i] = t.insert(p).vertex;
  }
  EXPECT_EQ(tin::mesh::validate(t.mesh()).value_or(""), "");
  EXPECT_LT(steps_per_query(t, support::random_points(random_, 3000, kLatticeHalf - 1)), kFewSteps);
}

TEST_F(LocateTest, AWalkFromAnyTriangleEndsAtTheSamePlace) {
  for (auto& [name, points] : support::hard_sets(random_, 150)) {
    SCOPED_TRACE(name);
    Triangulation t;
    for (const Point p : points) t.insert(p);
    if (t.mesh().dimension() < 2) continue;
    auto queries = support::random_points(random_, 15, 30);
    for (std::size_t i = 0; i < points.size(); i += 10) queries.push_back(points[i]);
    for (const Point p : queries) {
      const Location expected = t.locate(p);
      for (std::uint32_t i = 0; i < t.mesh().triangle_slots(); ++i) {
        const tin::mesh::TriangleSlot start(i);
        if (!t.mesh().is_alive(start)) continue;
        const Location found = t.locate_from(p, start);
        ASSERT_EQ(found.kind, expected.kind);
        ASSERT_EQ(found.vertex, expected.vertex);
        if (found.kind == Location::Kind::kInTriangle) {
          ASSERT_EQ(found.triangle, expected.triangle);
        }
      }
    }
  }
}

TEST_F(LocateTest, TheLevelsHoldExactlyTheVerticesOfTheirHeight) {
  std::map<Point, VertexSlot> present;
  Triangulation t;
  const auto check = [&] {
    std::vector<std::size_t> expected(8, 0);
    for (const auto& [p, v] : present) {
      for (std::size_t k = 0; k < Hierarchy::height_of(p); ++k) ++expected[k];
    }
    for (std::size_t k = 0; k < expected.size(); ++k) {
      const auto& hierarchy = t.hierarchy();
      ASSERT_EQ(k < hierarchy.levels() ? hierarchy.level(k).vertex_count() : 0, expected[k]);
      if (k < hierarchy.levels()) {
        ASSERT_EQ(tin::mesh::validate(hierarchy.level(k)).value_or(""), "");
      }
    }
  };
  for (int round = 0; round < 6; ++round) {
    const auto points = support::random_points(random_, 9000, 2000);
    std::vector<VertexSlot> slots;
    ASSERT_TRUE(t.insert_many(points, slots));
    for (std::size_t i = 0; i < points.size(); ++i) present[points[i]] = slots[i];
    check();
    for (auto it = present.begin(); it != present.end();) {
      if (random_() % 3 == 0) {
        ++it;
        continue;
      }
      t.remove(it->second);
      it = present.erase(it);
    }
    check();
  }
  std::vector<VertexSlot> rest;
  for (const auto& [p, v] : present) rest.push_back(v);
  ASSERT_TRUE(t.remove_many(rest));
  present.clear();
  check();
}

}  // namespace
