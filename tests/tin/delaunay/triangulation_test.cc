#include "tin/delaunay/triangulation.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "tests/support/oracle.h"
#include "tests/support/point_sets.h"
#include "tests/tin/delaunay/broken.h"
#include "tin/mesh/validate.h"

namespace {

using support::broken;
using support::Random;
using support::triangles;
using tin::delaunay::Location;
using tin::delaunay::Triangulation;
using tin::exact::Point;
using tin::mesh::VertexSlot;

class TriangulationTest : public testing::Test {
 protected:
  Random random_{support::seed()};
  testing::ScopedTrace trace_{__FILE__, __LINE__, "TINSMITH_SEED=" + std::to_string(support::seed())};
};

TEST_F(TriangulationTest, GrowsFromNothingToAPlaneAndBack) {
  Triangulation t;
  EXPECT_EQ(t.mesh().dimension(), -1);
  const auto a = t.insert({0, 0}).vertex;
  EXPECT_EQ(t.mesh().dimension(), 0);
  const auto b = t.insert({10, 0}).vertex;
  const auto c = t.insert({5, 0}).vertex;
  EXPECT_EQ(t.mesh().dimension(), 1);
  const auto d = t.insert({5, 5}).vertex;
  EXPECT_EQ(t.mesh().dimension(), 2);
  EXPECT_EQ(t.mesh().finite_triangle_count(), 2U);
  EXPECT_EQ(broken(t), "");
  t.remove(d);
  EXPECT_EQ(t.mesh().dimension(), 1);
  EXPECT_EQ(broken(t), "");
  t.remove(c);
  t.remove(a);
  EXPECT_EQ(t.mesh().dimension(), 0);
  t.remove(b);
  EXPECT_EQ(t.mesh().dimension(), -1);
  EXPECT_EQ(broken(t), "");
}

TEST_F(TriangulationTest, InsertingTwiceFindsTheFirstVertex) {
  Triangulation t;
  std::map<Point, VertexSlot> slots;
  for (const Point p : support::grid_points(4, 4, 2)) {
    const auto [v, fresh] = t.insert(p);
    EXPECT_TRUE(fresh);
    slots[p] = v;
    for (const auto& [q, slot] : slots) {
      const auto again = t.insert(q);
      EXPECT_FALSE(again.fresh);
      EXPECT_EQ(again.vertex, slot);
    }
  }
  EXPECT_EQ(broken(t), "");
}

TEST_F(TriangulationTest, EqualsTheBruteForceOracleOnTinySets) {
  for (int round = 0; round < 12; ++round) {
    for (auto& [name, points] : support::hard_sets(random_, 16)) {
      SCOPED_TRACE(name);
      points.resize(std::min<std::size_t>(points.size(), 20));
      Triangulation t;
      for (const Point p : points) t.insert(p);
      EXPECT_EQ(broken(t), "");
      EXPECT_EQ(triangles(t.mesh()), support::brute_force_delaunay(points));
    }
  }
}

TEST_F(TriangulationTest, EqualsCgalTriangleByTriangleTiesIncluded) {
  for (auto& [name, points] : support::hard_sets(random_, 3000)) {
    SCOPED_TRACE(name);
    Triangulation one_by_one, bulk;
    for (const Point p : points) one_by_one.insert(p);
    std::vector<VertexSlot> slots;
    ASSERT_TRUE(bulk.insert_many(points, slots));
    const auto expected = support::cgal_delaunay(points);
    EXPECT_EQ(triangles(one_by_one.mesh()), expected);
    EXPECT_EQ(triangles(bulk.mesh()), expected);
    EXPECT_EQ(broken(one_by_one), "");
    EXPECT_EQ(broken(bulk), "");
  }
}

TEST_F(TriangulationTest, RemovingWhatWasInsertedRestoresTheMesh) {
  for (auto& [name, points] : support::hard_sets(random_, 60)) {
    SCOPED_TRACE(name);
    Triangulation t;
    for (const Point p : points) t.insert(p);
    const auto before = triangles(t.mesh());
    for (const Point extra : support::random_points(random_, 60, 40)) {
      const auto [v, fresh] = t.insert(extra);
      if (!fresh) continue;
      ASSERT_EQ(broken(t), "");
      t.remove(v);
      ASSERT_EQ(broken(t), "");
      ASSERT_EQ(triangles(t.mesh()), before) << extra.x << " " << extra.y;
    }
  }
}

TEST_F(TriangulationTest, RemovingEveryVertexInAnyOrderStaysCanonical) {
  for (auto& [name, points] : support::hard_sets(random_, 80)) {
    SCOPED_TRACE(name);
    Triangulation t;
    std::map<Point, VertexSlot> slots;
    for (const Point p : points) slots[p] = t.insert(p).vertex;
    std::vector<Point> left = points;
    std::shuffle(left.begin(), left.end(), random_);
    while (!left.empty()) {
      t.remove(slots[left.back()]);
      left.pop_back();
      ASSERT_EQ(broken(t), "") << left.size() << " left";
      ASSERT_EQ(triangles(t.mesh()), support::cgal_delaunay(left)) << left.size() << " left";
    }
    EXPECT_EQ(t.mesh().dimension(), -1);
  }
}

TEST_F(TriangulationTest, AnyOrderOfEditsGivesTheSameMesh) {
  for (auto& [name, points] : support::hard_sets(random_, 200)) {
    SCOPED_TRACE(name);
    const std::vector<Point> extra = support::random_points(random_, 100, 300);
    Triangulation straight;
    for (const Point p : points) straight.insert(p);
    Triangulation detour;
    std::map<Point, VertexSlot> slots;
    std::vector<Point> all = points;
    all.insert(all.end(), extra.begin(), extra.end());
    std::shuffle(all.begin(), all.end(), random_);
    for (const Point p : all) slots[p] = detour.insert(p).vertex;
    for (const Point p : extra) {
      if (std::find(points.begin(), points.end(), p) == points.end()) detour.remove(slots[p]);
    }
    EXPECT_EQ(broken(detour), "");
    EXPECT_EQ(triangles(detour.mesh()), triangles(straight.mesh()));
  }
}

TEST_F(TriangulationTest, VerticesOfHighDegreeAreRemovedExactly) {
  for (const bool with_outer : {false, true}) {
    auto ring = support::circle_points(1000);
    if (with_outer) {
      for (const Point p : support::random_points(random_, 500, 30000)) ring.push_back({p.x * 40000 / 30000, p.y});
    }
    ring.erase(std::remove(ring.begin(), ring.end(), Point{0, 0}), ring.end());
    Triangulation t;
    for (const Point p : ring) t.insert(p);
    const auto before = triangles(t.mesh());
    const auto centre = t.insert({0, 0}).vertex;
    t.remove(centre);
    EXPECT_EQ(broken(t), "");
    EXPECT_EQ(triangles(t.mesh()), before);
  }
}

TEST_F(TriangulationTest, LongRandomHistoriesStayValid) {
  for (const std::int32_t extent : {5, 60, 1 << 20}) {
    SCOPED_TRACE(extent);
    Triangulation t;
    std::map<Point, VertexSlot> present;
    std::uniform_int_distribution<std::int32_t> coordinate(-extent, extent);
    for (int step = 0; step < 20000; ++step) {
      const bool grow = present.size() < 3 || random_() % 100 < (step / 4000 % 2 == 0 ? 60 : 40);
      if (grow) {
        const Point p{coordinate(random_), coordinate(random_)};
        const auto [v, fresh] = t.insert(p);
        ASSERT_EQ(fresh, present.emplace(p, v).second);
      } else {
        auto it = present.lower_bound({coordinate(random_), coordinate(random_)});
        if (it == present.end()) it = present.begin();
        t.remove(it->second);
        present.erase(it);
      }
      if (step % 500 == 0) {
        ASSERT_EQ(broken(t), "");
      }
    }
    std::vector<Point> points;
    for (const auto& [p, v] : present) points.push_back(p);
    EXPECT_EQ(broken(t), "");
    EXPECT_EQ(triangles(t.mesh()), support::cgal_delaunay(points));
  }
}

TEST_F(TriangulationTest, LocateTellsInsideEdgeVertexAndOutside) {
  Triangulation t;
  for (const Point p : {Point{0, 0}, Point{10, 0}, Point{0, 10}}) t.insert(p);
  EXPECT_EQ(t.locate({2, 2}).kind, Location::Kind::kInTriangle);
  EXPECT_EQ(t.locate({5, 5}).kind, Location::Kind::kOnEdge);
  EXPECT_EQ(t.locate({5, 0}).kind, Location::Kind::kOnEdge);
  EXPECT_EQ(t.locate({10, 0}).kind, Location::Kind::kOnVertex);
  EXPECT_EQ(t.locate({11, 0}).kind, Location::Kind::kOutsideHull);
  EXPECT_EQ(t.locate({6, 5}).kind, Location::Kind::kOutsideHull);
  EXPECT_EQ(t.locate({-1, -1}).kind, Location::Kind::kOutsideHull);
  EXPECT_EQ(broken(t), "");
}

TEST_F(TriangulationTest, LocateFindsEveryVertexAfterManyRemovals) {
  Triangulation t;
  auto points = support::random_points(random_, 5000, 1 << 28);
  std::map<Point, VertexSlot> slots;
  for (const Point p : points) slots[p] = t.insert(p).vertex;
  std::shuffle(points.begin(), points.end(), random_);
  for (std::size_t i = 0; i < 4900; ++i) t.remove(slots[points[i]]);
  for (std::size_t i = 4900; i < points.size(); ++i) {
    const Location where = t.locate(points[i]);
    ASSERT_EQ(where.kind, Location::Kind::kOnVertex);
    EXPECT_EQ(where.vertex, slots[points[i]]);
  }
  EXPECT_EQ(broken(t), "");
}

TEST_F(TriangulationTest, ValidateSeesAFlippedDiagonal) {
  Triangulation t;
  for (const Point p : {Point{0, 0}, Point{10, 0}, Point{10, 10}, Point{0, 10}}) t.insert(p);
  tin::mesh::Mesh mesh = t.mesh();
  ASSERT_EQ(tin::mesh::validate(mesh), std::nullopt);
  // Exchange the diagonal by hand: still a triangulation, but not the canonical one.
  for (std::uint32_t i = 0; i < mesh.triangle_slots(); ++i) {
    const tin::mesh::TriangleSlot t1(i);
    if (!mesh.is_alive(t1) || mesh.is_infinite(t1)) continue;
    for (int j = 0; j < 3; ++j) {
      const auto twin = mesh.twin(t1, j);
      if (mesh.is_infinite(twin.triangle())) continue;
      const auto a = mesh.vertex(t1, j), b = mesh.vertex(t1, tin::mesh::next3(j)), c = mesh.vertex(t1, tin::mesh::prev3(j));
      const auto d = mesh.apex(twin);
      const auto ab = mesh.twin(t1, tin::mesh::prev3(j)), ca = mesh.twin(t1, tin::mesh::next3(j));
      const auto bd = mesh.twin(twin.triangle(), tin::mesh::next3(twin.index()));
      const auto dc = mesh.twin(twin.triangle(), tin::mesh::prev3(twin.index()));
      const auto t2 = twin.triangle();
      mesh.set_triangle(t1, a, b, d);
      mesh.set_triangle(t2, a, d, c);
      mesh.join({t1, 2}, ab);
      mesh.join({t1, 0}, bd);
      mesh.join({t1, 1}, {t2, 2});
      mesh.join({t2, 0}, dc);
      mesh.join({t2, 1}, ca);
      const auto verdict = tin::mesh::validate(mesh);
      ASSERT_TRUE(verdict.has_value());
      EXPECT_EQ(verdict->substr(0, 2), "I6") << *verdict;
      return;
    }
  }
  FAIL() << "no inner edge found";
}

}  // namespace
