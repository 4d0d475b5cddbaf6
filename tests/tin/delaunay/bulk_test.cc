#include "tin/delaunay/bulk.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <new>

#include "tests/support/oracle.h"
#include "tests/support/point_sets.h"
#include "tin/delaunay/hilbert.h"
#include "tin/delaunay/hilbert_sort.h"
#include "tin/delaunay/triangulation.h"
#include "tin/mesh/validate.h"

namespace {

using support::Random;
using support::triangles;
using tin::delaunay::Triangulation;
using tin::exact::kLatticeHalf;
using tin::exact::Point;
using tin::mesh::Mesh;
using tin::mesh::VertexSlot;

class BulkTest : public testing::Test {
 protected:
  /// By build_bulk() itself, which shares out even small sets.
  static Mesh built(const std::vector<Point>& points, unsigned threads) {
    Mesh mesh;
    const auto sorted = tin::delaunay::hilbert_sorted(points, threads);
    mesh.begin_bulk(points.size());
    for (std::uint32_t i = 0; i < sorted.size(); ++i) mesh.set_point(VertexSlot(i + 1), points[sorted[i].index]);
    EXPECT_TRUE(tin::delaunay::build_bulk(mesh, threads, nullptr));
    return mesh;
  }

  Random random_{support::seed()};
  testing::ScopedTrace trace_{__FILE__, __LINE__, "TINSMITH_SEED=" + std::to_string(support::seed())};
};

TEST_F(BulkTest, AnyNumberOfThreadsGivesTheMeshOfInsertionOneByOne) {
  for (const std::size_t size : {5, 130, 3000}) {
    for (const auto& [name, points] : support::hard_sets(random_, size)) {
      SCOPED_TRACE(name);
      Triangulation one_by_one;
      for (const Point p : points) one_by_one.insert(p);
      const auto expected = triangles(one_by_one.mesh());
      for (const unsigned threads : {1U, 2U, 3U, 7U}) {
        const Mesh mesh = built(points, threads);
        EXPECT_EQ(tin::mesh::validate(mesh).value_or(""), "") << threads << " threads";
        EXPECT_EQ(triangles(mesh), expected) << threads << " threads";
      }
    }
  }
}

TEST_F(BulkTest, TwoThreadsUseTheSameVertexSlotsAsOne) {
  const auto points = support::random_points(random_, 100'000, kLatticeHalf - 1);
  Triangulation one, two;
  std::vector<VertexSlot> slots_of_one, slots_of_two;
  ASSERT_TRUE(one.insert_many(points, slots_of_one, nullptr, 1));
  ASSERT_TRUE(two.insert_many(points, slots_of_two, nullptr, 2));
  EXPECT_EQ(slots_of_one, slots_of_two);
  EXPECT_EQ(tin::mesh::validate(two.mesh()).value_or(""), "");
  EXPECT_EQ(triangles(one.mesh()), triangles(two.mesh()));
}

TEST_F(BulkTest, TranslationsAndPermutationsGiveTheSameMesh) {
  for (auto& [name, points] : support::hard_sets(random_, 400)) {
    SCOPED_TRACE(name);
    for (Point& p : points) p = {p.x / 4, p.y / 4};
    std::sort(points.begin(), points.end());
    points.erase(std::unique(points.begin(), points.end()), points.end());
    const auto expected = triangles(built(points, 1));
    const Point shift{123'456'789, -98'765'432};
    std::vector<Point> moved;
    for (const Point p : points) moved.push_back({p.x + shift.x, p.y + shift.y});
    std::shuffle(moved.begin(), moved.end(), random_);
    auto back = triangles(built(moved, 2));
    for (auto& corners : back) {
      for (Point& p : corners) p = {p.x - shift.x, p.y - shift.y};
    }
    EXPECT_EQ(back, expected);
  }
}

TEST_F(BulkTest, EqualPointsShareOneSlotAndSlotsHaveNoGaps) {
  auto points = support::random_points(random_, 1000, 40);
  points.insert(points.end(), points.begin(), points.begin() + 700);
  std::shuffle(points.begin(), points.end(), random_);
  Triangulation t;
  std::vector<VertexSlot> slots;
  ASSERT_TRUE(t.insert_many(points, slots));
  EXPECT_EQ(t.mesh().vertex_count(), 1000U);
  EXPECT_EQ(t.mesh().vertex_slots(), 1001U);
  for (std::size_t i = 0; i < points.size(); ++i) EXPECT_EQ(t.mesh().point(slots[i]), points[i]);
  EXPECT_EQ(tin::mesh::validate(t.mesh()).value_or(""), "");
}

TEST_F(BulkTest, EqualPointsShareOneSlotOnAnyNumberOfThreads) {
  auto points = support::random_points(random_, 30'000, kLatticeHalf - 1);
  for (std::size_t i = 0; i < 90'000; ++i) points.push_back(points[random_() % 30'000]);
  points.insert(points.end(), 20'000, points[7]);  // more than a thread's share of equal ones
  Triangulation one;
  std::vector<VertexSlot> expected;
  ASSERT_TRUE(one.insert_many(points, expected, nullptr, 1));
  EXPECT_EQ(one.mesh().vertex_count(), 30'000U);
  for (std::size_t i = 0; i < points.size(); ++i) ASSERT_EQ(one.mesh().point(expected[i]), points[i]);
  for (const unsigned threads : {2U, 3U, 7U}) {
    Triangulation several;
    std::vector<VertexSlot> slots;
    ASSERT_TRUE(several.insert_many(points, slots, nullptr, threads));
    EXPECT_EQ(slots, expected) << threads << " threads";
    EXPECT_EQ(tin::mesh::validate(several.mesh()).value_or(""), "") << threads << " threads";
    EXPECT_EQ(triangles(several.mesh()), triangles(one.mesh())) << threads << " threads";
    EXPECT_EQ(several.hierarchy().levels(), one.hierarchy().levels()) << threads << " threads";
    for (std::size_t i = 0; i < 1000; ++i) EXPECT_EQ(several.locate(points[i]).vertex, expected[i]);
  }
}

TEST_F(BulkTest, WhatIsToBeDoneMeanwhileIsDoneOnceAndItsFailureIsReported) {
  for (const std::size_t size : {2, 3000}) {
    for (const unsigned threads : {1U, 2U, 5U}) {
      const auto points = support::random_points(random_, size, kLatticeHalf - 1);
      const auto sorted = tin::delaunay::hilbert_sorted(points, threads);
      const auto empty = [&](Mesh& mesh) {
        mesh.begin_bulk(points.size());
        for (std::uint32_t i = 0; i < sorted.size(); ++i) mesh.set_point(VertexSlot(i + 1), points[sorted[i].index]);
      };
      int calls = 0;
      Mesh mesh, failed;
      empty(mesh);
      EXPECT_TRUE(tin::delaunay::build_bulk(mesh, threads, nullptr, [&] { ++calls; }));
      EXPECT_EQ(calls, 1);
      EXPECT_EQ(tin::mesh::validate(mesh).value_or(""), "");
      empty(failed);
      EXPECT_THROW(tin::delaunay::build_bulk(failed, threads, nullptr, [] { throw std::bad_alloc(); }), std::bad_alloc);
    }
  }
}

TEST_F(BulkTest, FewVerticesMakeALineOrNothing) {
  for (const std::vector<Point>& points : {std::vector<Point>{}, {{5, 5}}, {{5, 5}, {5, 5}}, {{0, 0}, {7, 1}}}) {
    Triangulation t;
    std::vector<VertexSlot> slots;
    ASSERT_TRUE(t.insert_many(points, slots, nullptr, 2));
    EXPECT_LT(t.mesh().dimension(), 2);
    EXPECT_EQ(tin::mesh::validate(t.mesh()).value_or(""), "");
    t.insert({100, 3});
    t.insert({-50, 90});
    t.insert({0, -90});
    EXPECT_EQ(t.mesh().dimension(), 2);
    EXPECT_EQ(tin::mesh::validate(t.mesh()).value_or(""), "");
  }
}

TEST_F(BulkTest, ACancelledBuildSaysSoOnAnyNumberOfThreads) {
  const auto points = support::random_points(random_, 60'000, kLatticeHalf - 1);
  for (const unsigned threads : {1U, 2U}) {
    tin::base::Progress progress;
    progress.cancel();
    Triangulation t;
    std::vector<VertexSlot> slots;
    EXPECT_FALSE(t.insert_many(points, slots, &progress, threads));
  }
  tin::base::Progress progress;
  Triangulation t;
  std::vector<VertexSlot> slots;
  EXPECT_TRUE(t.insert_many(points, slots, &progress, 2));
  EXPECT_GT(progress.fraction(), 0.5);
}

TEST_F(BulkTest, TheHilbertCurveVisitsNeighboursNext) {
  std::vector<Point> cells = support::grid_points(32, 32, 1, {-kLatticeHalf, -kLatticeHalf});
  const tin::delaunay::HilbertCurve curve(cells.front(), cells.back());
  EXPECT_EQ(curve.index_bits(), 10);
  std::sort(cells.begin(), cells.end(), [&](Point a, Point b) { return curve.index(a) < curve.index(b); });
  for (std::size_t i = 1; i < cells.size(); ++i) {
    EXPECT_EQ(std::abs(cells[i].x - cells[i - 1].x) + std::abs(cells[i].y - cells[i - 1].y), 1);
  }
}

TEST_F(BulkTest, SortingAlongTheCurveReachesTheLastBitAndKeepsTheOrderOfEqualPoints) {
  for (auto& [name, points] : support::hard_sets(random_, 5000)) {
    SCOPED_TRACE(name);
    points.insert(points.end(), points.begin(), points.begin() + static_cast<std::ptrdiff_t>(points.size() / 2));
    const auto one = tin::delaunay::hilbert_sorted(points, 1), three = tin::delaunay::hilbert_sorted(points, 3);
    ASSERT_EQ(one.size(), points.size());
    const auto [left, right] = std::minmax_element(points.begin(), points.end());
    const auto by_y = [](Point a, Point b) { return a.y < b.y; };
    const auto [bottom, top] = std::minmax_element(points.begin(), points.end(), by_y);
    const tin::delaunay::HilbertCurve curve({left->x, bottom->y}, {right->x, top->y});
    for (std::size_t i = 0; i < one.size(); ++i) {
      ASSERT_EQ(one[i].index, three[i].index);
      if (i == 0) continue;
      const auto before = std::pair(curve.index(points[one[i - 1].index]), one[i - 1].index);
      ASSERT_LT(before, std::pair(curve.index(points[one[i].index]), one[i].index));
    }
  }
}

}  // namespace
