#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "tests/support/oracle.h"
#include "tests/support/point_sets.h"
#include "tests/tin/delaunay/broken.h"
#include "tin/delaunay/triangulation.h"

namespace {

using support::broken;
using support::Random;
using support::triangles;
using tin::delaunay::Location;
using tin::delaunay::Triangulation;
using tin::exact::Point;
using tin::mesh::kNone;
using tin::mesh::TriangleSlot;
using tin::mesh::VertexSlot;

/// A triangulation with a record of which vertex stands where.
struct Tracked {
  Triangulation triangulation;
  std::map<Point, VertexSlot> present;

  void insert(const std::vector<Point>& points) {
    std::vector<VertexSlot> slots;
    ASSERT_TRUE(triangulation.insert_many(points, slots));
    for (std::size_t i = 0; i < points.size(); ++i) {
      ASSERT_EQ(triangulation.mesh().point(slots[i]), points[i]);
      const auto known = present.emplace(points[i], slots[i]).first;
      ASSERT_EQ(known->second, slots[i]);
    }
  }
  void remove(const std::vector<Point>& points, bool in_order) {
    std::vector<VertexSlot> slots;
    for (const Point p : points) {
      slots.push_back(present.at(p));
      present.erase(p);
    }
    ASSERT_TRUE(in_order ? triangulation.remove_in_order(slots) : triangulation.remove_many(slots));
  }
  std::vector<Point> points() const {
    std::vector<Point> result;
    for (const auto& [p, v] : present) result.push_back(p);
    return result;
  }
};

class BatchTest : public testing::Test {
 protected:
  Random random_{support::seed()};
  testing::ScopedTrace trace_{__FILE__, __LINE__, "TINSMITH_SEED=" + std::to_string(support::seed())};
};

TEST_F(BatchTest, BatchesInAnyOrderEqualEditsOneByOne) {
  for (auto& [name, points] : support::hard_sets(random_, 900)) {
    SCOPED_TRACE(name);
    Tracked batches;
    const std::size_t third = points.size() / 3;
    for (std::size_t i = 0; i < points.size(); i += third) {
      batches.insert({points.begin() + static_cast<std::ptrdiff_t>(i),
                      points.begin() + static_cast<std::ptrdiff_t>(std::min(points.size(), i + third))});
      ASSERT_EQ(broken(batches.triangulation), "");
    }
    EXPECT_EQ(triangles(batches.triangulation.mesh()), support::cgal_delaunay(points));
    std::shuffle(points.begin(), points.end(), random_);
    while (!points.empty()) {
      const auto half = points.begin() + static_cast<std::ptrdiff_t>(points.size() / 2);
      batches.remove({half, points.end()}, points.size() % 2 == 0);
      points.erase(half, points.end());
      ASSERT_EQ(broken(batches.triangulation), "");
      ASSERT_EQ(triangles(batches.triangulation.mesh()), support::cgal_delaunay(points));
    }
    EXPECT_EQ(batches.triangulation.mesh().dimension(), -1);
  }
}

TEST_F(BatchTest, LongHistoriesOfMixedBatchesStayCanonical) {
  for (const std::int32_t extent : {12, 300, 1 << 28}) {
    SCOPED_TRACE(extent);
    Tracked tracked;
    for (int round = 0; round < 60; ++round) {
      const std::size_t size = 1 + random_() % (round % 3 == 0 ? 400 : 60);
      if (round % 2 == 0) {
        tracked.insert(support::random_points(random_, std::min<std::size_t>(size, 300), extent));
      } else {
        auto points = tracked.points();
        std::shuffle(points.begin(), points.end(), random_);
        points.resize(std::min(points.size(), size));
        tracked.remove(points, round % 4 == 1);
      }
      ASSERT_EQ(broken(tracked.triangulation), "") << "round " << round;
      ASSERT_EQ(tracked.triangulation.mesh().vertex_count(), tracked.present.size());
    }
    const auto points = tracked.points();
    EXPECT_EQ(triangles(tracked.triangulation.mesh()), support::cgal_delaunay(points));
  }
}

TEST_F(BatchTest, ABatchThatDwarfsTheMeshIsInsertedInRounds) {
  Tracked tracked;
  tracked.insert({{0, 0}, {1000, 0}, {0, 1000}});
  const auto points = support::random_points(random_, 20'000, 1 << 25);
  tracked.insert(points);
  EXPECT_EQ(broken(tracked.triangulation), "");
  EXPECT_EQ(triangles(tracked.triangulation.mesh()), support::cgal_delaunay(tracked.points()));
}

TEST_F(BatchTest, ACancelledBatchSaysSo) {
  Tracked tracked;
  const auto points = support::random_points(random_, 10'000, 1 << 20);
  tracked.insert(points);
  tin::base::Progress progress;
  progress.cancel();
  std::vector<VertexSlot> slots;
  for (const auto& [p, v] : tracked.present) slots.push_back(v);
  EXPECT_FALSE(tracked.triangulation.remove_many(slots, &progress));
  EXPECT_EQ(broken(tracked.triangulation), "");
  EXPECT_FALSE(tracked.triangulation.insert_many(points, slots, &progress));
}

TEST_F(BatchTest, LocateManyEqualsLocate) {
  for (auto& [name, points] : support::hard_sets(random_, 2000)) {
    SCOPED_TRACE(name);
    Tracked tracked;
    tracked.insert(points);
    auto queries = support::random_points(random_, 5000, 1 << 28);
    for (const Point p : points) {
      queries.push_back(p);
      queries.push_back({p.x + (p.x < 0 ? 1 : -1), p.y});
    }
    for (const std::size_t count : {std::size_t{0}, std::size_t{1}, std::size_t{100}, queries.size()}) {
      std::vector<Location> found;
      tracked.triangulation.locate_many(std::span(queries).first(count), found);
      ASSERT_EQ(found.size(), count);
      for (std::size_t i = 0; i < count; ++i) {
        const Location expected = tracked.triangulation.locate(queries[i]);
        ASSERT_EQ(found[i].kind, expected.kind);
        ASSERT_EQ(found[i].vertex, expected.vertex);
        if (expected.kind == Location::Kind::kInTriangle) {
          ASSERT_EQ(found[i].triangle, expected.triangle);
        }
        if (expected.kind == Location::Kind::kOnVertex) {
          ASSERT_EQ(tracked.triangulation.mesh().point(found[i].vertex), queries[i]);
        }
      }
    }
  }
}

TEST_F(BatchTest, CompactionKeepsTheMeshAndTellsWhereEachSlotWent) {
  for (auto& [name, points] : support::hard_sets(random_, 1500)) {
    SCOPED_TRACE(name);
    Tracked tracked;
    for (const Point p : points) tracked.insert({p});
    std::shuffle(points.begin(), points.end(), random_);
    tracked.remove({points.begin(), points.begin() + static_cast<std::ptrdiff_t>(points.size() * 2 / 3)}, false);
    Triangulation& t = tracked.triangulation;
    const auto before = triangles(t.mesh());
    const auto old_mesh = t.mesh();
    const auto moved = t.compact();
    ASSERT_EQ(broken(t), "");
    EXPECT_EQ(triangles(t.mesh()), before);
    EXPECT_EQ(t.mesh().vertex_slots(), t.mesh().vertex_count() + 1);
    EXPECT_EQ(t.mesh().triangle_slots(), t.mesh().triangle_count());
    for (auto& [p, slot] : tracked.present) {
      slot = moved.vertices[slot.value()];
      EXPECT_EQ(t.mesh().point(slot), p);
    }
    for (std::uint32_t i = 0; i < old_mesh.triangle_slots(); ++i) {
      const TriangleSlot from(i), to = moved.triangles[i];
      ASSERT_EQ(old_mesh.is_alive(from), to.value() != kNone);
      if (!old_mesh.is_alive(from)) continue;
      for (int k = 0; k < 3; ++k) EXPECT_EQ(t.mesh().vertex(to, k), moved.vertices[old_mesh.vertex(from, k).value()]);
    }
    for (const auto& [p, slot] : tracked.present) ASSERT_EQ(t.locate(p).vertex, slot);
    tracked.insert(support::random_points(random_, 300, 1 << 20));
    EXPECT_EQ(broken(t), "");
    tracked.remove(tracked.points(), false);
    EXPECT_EQ(t.mesh().dimension(), -1);
  }
}

}  // namespace
