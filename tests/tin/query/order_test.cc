#include "tin/query/order.h"

#include <gtest/gtest.h>

#include <map>
#include <set>

#include "tests/support/point_sets.h"
#include "tin/mesh/validate.h"

namespace {

using tin::exact::Point;
using tin::query::TriangleCursor;
using tin::query::TriangleWalk;
using tin::terrain::Duplicates;
using tin::terrain::Edit;
using tin::terrain::Placement;
using tin::terrain::Remove;
using tin::terrain::Terrain;
using tin::terrain::VertexId;

using Ids = std::array<VertexId, 3>;

std::vector<Ids> all_triangles(const Terrain& terrain) {
  std::vector<Ids> out;
  TriangleWalk walk(terrain, {});
  while (const auto triangle = walk.next()) out.push_back(triangle->ids);
  return out;
}

Terrain random_terrain(std::size_t count) {
  support::Random random(support::seed());
  std::vector<Placement> placements;
  for (const Point p : support::random_points(random, count, 500)) placements.push_back({p, 0});
  return *Terrain::build({}, placements, Duplicates::kReject);
}

TEST(TriangleWalkTest, VisitsEveryFiniteTriangleOnceInOrder) {
  const Terrain t = random_terrain(300);
  const auto triangles = all_triangles(t);
  EXPECT_EQ(triangles.size(), t.triangle_count());
  EXPECT_TRUE(std::is_sorted(triangles.begin(), triangles.end()));
  EXPECT_EQ(std::set<Ids>(triangles.begin(), triangles.end()).size(), triangles.size());
  for (const Ids& ids : triangles) EXPECT_TRUE(ids[0] < ids[1] && ids[0] < ids[2]);
}

TEST(TriangleWalkTest, GoesOnFromAnyCursor) {
  const Terrain t = random_terrain(60);
  const auto whole = all_triangles(t);
  TriangleWalk walk(t, {});
  for (std::size_t i = 0; i <= whole.size(); ++i) {
    std::vector<Ids> rest;
    TriangleWalk later(t, walk.cursor());
    while (const auto triangle = later.next()) rest.push_back(triangle->ids);
    EXPECT_EQ(rest, std::vector<Ids>(whole.begin() + static_cast<std::ptrdiff_t>(i), whole.end()));
    walk.next();
  }
}

TEST(TriangleWalkTest, IsTheSameAfterARestore) {
  Terrain t = random_terrain(200);
  std::vector<Edit> edits;
  for (std::uint64_t id = 3; id < 200; id += 7) edits.push_back(Remove{VertexId(id)});
  ASSERT_TRUE(t.apply(edits, Duplicates::kReject).ok());
  const auto again = Terrain::restore(t.frame(), t.vertices_by_id(), t.next_id());
  ASSERT_TRUE(again.ok());
  EXPECT_EQ(all_triangles(*again), all_triangles(t));
  EXPECT_EQ(tin::mesh::validate(t.mesh()), std::nullopt);
}

TEST(TriangleWalkTest, FindsNothingBelowThePlane) {
  EXPECT_TRUE(all_triangles(Terrain{tin::frame::Frame{}}).empty());
  const std::vector<Placement> line{{{0, 0}, 1}, {{1, 1}, 2}, {{2, 2}, 3}};
  EXPECT_TRUE(all_triangles(*Terrain::build({}, line, Duplicates::kReject)).empty());
}

using Edge = std::array<VertexId, 2>;

std::vector<Edge> all_edges(const Terrain& terrain, TriangleCursor from = {}) {
  std::vector<Edge> out;
  tin::query::EdgeWalk walk(terrain, from);
  while (const auto edge = walk.next()) out.push_back(edge->ids);
  return out;
}

/// The sides of all triangles, and how many triangles each has.
std::map<Edge, int> sides(const Terrain& terrain) {
  std::map<Edge, int> found;
  for (const Ids& ids : all_triangles(terrain)) {
    for (std::size_t i = 0; i < 3; ++i) {
      const auto [a, b] = std::minmax(ids[i], ids[(i + 1) % 3]);
      ++found[{a, b}];
    }
  }
  return found;
}

TEST(EdgeWalkTest, VisitsEverySideOfEveryTriangleOnceInOrder) {
  const Terrain t = random_terrain(300);
  const auto expected = sides(t);
  std::vector<Edge> keys;
  for (const auto& [edge, count] : expected) keys.push_back(edge);
  EXPECT_EQ(all_edges(t), keys);
  EXPECT_EQ(tin::query::edge_count(t), keys.size());
  tin::query::EdgeWalk walk(t, {});
  while (const auto edge = walk.next()) EXPECT_EQ(edge->hull, expected.at(edge->ids) == 1);
}

TEST(EdgeWalkTest, GoesOnFromAnyCursor) {
  const Terrain t = random_terrain(40);
  const auto whole = all_edges(t);
  tin::query::EdgeWalk walk(t, {});
  for (std::size_t i = 0; i <= whole.size(); ++i) {
    EXPECT_EQ(all_edges(t, walk.cursor()), std::vector<Edge>(whole.begin() + static_cast<std::ptrdiff_t>(i), whole.end()));
    walk.next();
  }
}

TEST(EdgeWalkTest, JoinsNeighboursOnALine) {
  EXPECT_TRUE(all_edges(Terrain{tin::frame::Frame{}}).empty());
  EXPECT_EQ(tin::query::edge_count(Terrain{tin::frame::Frame{}}), 0u);
  const std::vector<Placement> line{{{2, 2}, 1}, {{0, 0}, 2}, {{5, 5}, 3}, {{4, 4}, 3}};
  const Terrain t = *Terrain::build({}, line, Duplicates::kReject);
  const auto id = [](std::uint64_t value) { return VertexId(value); };
  EXPECT_EQ(all_edges(t), (std::vector<Edge>{{id(1), id(2)}, {id(1), id(4)}, {id(3), id(4)}}));
  EXPECT_EQ(tin::query::edge_count(t), 3u);
  EXPECT_EQ(tin::mesh::validate(t.mesh()), std::nullopt);
}

TEST(WithoutTest, IsTheSameTerrainAsByRemovingOneByOne) {
  Terrain t = random_terrain(150);
  const std::vector<VertexId> gone{VertexId(1), VertexId(2), VertexId(77), VertexId(149), VertexId(150)};
  const Terrain rest = t.without(gone);
  std::vector<Edit> edits;
  for (const VertexId id : gone) edits.push_back(Remove{id});
  ASSERT_TRUE(t.apply(edits, Duplicates::kReject).ok());
  EXPECT_EQ(rest.digest(), t.digest());
  EXPECT_EQ(rest.next_id(), t.next_id());
  EXPECT_EQ(all_triangles(rest), all_triangles(t));
  EXPECT_EQ(tin::mesh::validate(rest.mesh()), std::nullopt);
}

}  // namespace
