#include "tin/query/touched.h"

#include <gtest/gtest.h>

#include <set>

#include "tests/support/point_sets.h"
#include "tin/mesh/validate.h"
#include "tin/query/order.h"

namespace {

using tin::exact::Point;
using tin::query::TouchedArea;
using tin::terrain::Duplicates;
using tin::terrain::Edit;
using tin::terrain::Placement;
using tin::terrain::Terrain;
using tin::terrain::VertexId;

struct Corner {
  Point at;
  double z;
  auto operator<=>(const Corner&) const = default;
};
using Facet = std::array<Corner, 3>;

/// All triangles with their heights, by position: what a surface is, whatever its ids.
std::set<Facet> facets(const Terrain& terrain) {
  std::set<Facet> out;
  tin::query::TriangleWalk walk(terrain, {});
  while (const auto triangle = walk.next()) {
    Facet facet;
    for (std::size_t i = 0; i < 3; ++i) facet[i] = {terrain.mesh().point(triangle->slots[i]), terrain.z(triangle->slots[i])};
    std::sort(facet.begin(), facet.end());
    out.insert(facet);
  }
  return out;
}

void expect_inside(const std::set<Facet>& some, const std::set<Facet>& others, const TouchedArea& area) {
  for (const Facet& facet : some) {
    if (others.contains(facet)) continue;
    for (const Corner& corner : facet) {
      EXPECT_TRUE(corner.at.x >= area.box.min.x && corner.at.x <= area.box.max.x && corner.at.y >= area.box.min.y &&
                  corner.at.y <= area.box.max.y)
          << corner.at.x << " " << corner.at.y;
    }
  }
}

/// Every triangle that came or went lies in the box, for random edits on random points and on a grid; and the outline is the
/// same where the area says so.
TEST(TouchedAreaTest, HoldsEveryTriangleThatCameOrWent) {
  support::Random random(support::seed());
  SCOPED_TRACE(support::seed());
  for (int round = 0; round < 60; ++round) {
    std::vector<Placement> placements;
    if (round % 2 == 0) {
      for (const Point p : support::random_points(random, 120, 300)) placements.push_back({p, 1.0});
    } else {
      for (int i = 0; i < 100; ++i) placements.push_back({{30 * (i % 10), 30 * (i / 10)}, 1.0});
    }
    Terrain terrain = *Terrain::build({}, placements, Duplicates::kReplace);
    for (int step = 0; step < 15; ++step) {
      std::vector<Edit> edits;
      std::vector<VertexId> ids;
      for (const auto& vertex : terrain.vertices_by_id()) ids.push_back(vertex.id);
      const auto some_id = [&] { return ids[random() % ids.size()]; };
      const Point somewhere{static_cast<std::int32_t>(random() % 400) - 50, static_cast<std::int32_t>(random() % 400) - 50};
      switch (random() % 4) {
        case 0:
          edits.emplace_back(tin::terrain::Insert{somewhere, 7});
          break;
        case 1:
          edits.emplace_back(tin::terrain::Remove{some_id()});
          break;
        case 2:
          edits.emplace_back(tin::terrain::Move{some_id(), somewhere});
          break;
        default:
          edits.emplace_back(tin::terrain::SetZ{some_id(), static_cast<double>(step)});
          edits.emplace_back(tin::terrain::Remove{some_id()});
          edits.emplace_back(tin::terrain::Insert{somewhere, 3});
      }
      const auto before = facets(terrain);
      const auto hull_before = terrain.bounds();
      const auto applied = terrain.apply(edits, Duplicates::kReplace);
      if (!applied) continue;  // moved onto another one, or removed twice
      const auto area = tin::query::touched_area(terrain, applied->change);
      if (applied->change.steps.empty()) continue;
      ASSERT_TRUE(area);
      const auto after = facets(terrain);
      expect_inside(before, after, *area);
      expect_inside(after, before, *area);
      if (!area->hull) {
        EXPECT_EQ(hull_before->min, terrain.bounds()->min);
        EXPECT_EQ(hull_before->max, terrain.bounds()->max);
      }
    }
    EXPECT_EQ(tin::mesh::validate(terrain.mesh()), std::nullopt);
  }
}

TEST(TouchedAreaTest, IsSmallForASmallChange) {
  std::vector<Placement> placements;
  for (int i = 0; i < 2500; ++i) placements.push_back({{30 * (i % 50), 30 * (i / 50)}, 1.0});
  Terrain terrain = *Terrain::build({}, placements, Duplicates::kReplace);
  const std::vector<Edit> edits{tin::terrain::SetZ{VertexId(1275), 5}};
  const auto area = tin::query::touched_area(terrain, terrain.apply(edits, Duplicates::kReplace)->change);
  ASSERT_TRUE(area);
  EXPECT_LE(area->box.max.x - area->box.min.x, 60);
  EXPECT_LE(area->box.max.y - area->box.min.y, 60);
  EXPECT_FALSE(area->hull);
}

TEST(TouchedAreaTest, IsNotKnownWithoutTriangles) {
  Terrain terrain{tin::frame::Frame{}};
  const std::vector<Edit> edits{tin::terrain::Insert{{1, 1}, 5}};
  EXPECT_FALSE(tin::query::touched_area(terrain, terrain.apply(edits, Duplicates::kReplace)->change));
}

}  // namespace
