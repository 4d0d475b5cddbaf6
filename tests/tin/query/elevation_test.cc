#include "tin/query/elevation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "tests/support/point_sets.h"
#include "tin/mesh/validate.h"

namespace {

using tin::exact::Point;
using tin::query::ElevationQuery;
using tin::query::Voids;
using tin::terrain::Duplicates;
using tin::terrain::Edit;
using tin::terrain::Insert;
using tin::terrain::Placement;
using tin::terrain::SourceGrid;
using tin::terrain::Terrain;
using tin::terrain::VertexId;

/// A terrain drawn as rows of digits (heights) and blanks (void cells), north up, ten lattice steps a cell.
Terrain drawn(const std::vector<std::string>& rows) {
  auto grid = std::make_shared<SourceGrid>();
  grid->width = static_cast<std::int32_t>(rows[0].size());
  grid->height = static_cast<std::int32_t>(rows.size());
  grid->dx = 10;
  grid->dy = -10;
  grid->valid.assign((rows.size() * rows[0].size() + 63) / 64, 0);
  std::vector<Placement> placements;
  for (std::int32_t r = 0; r < grid->height; ++r) {
    for (std::int32_t c = 0; c < grid->width; ++c) {
      const char symbol = rows[static_cast<std::size_t>(r)][static_cast<std::size_t>(c)];
      if (symbol == ' ') continue;
      const auto bit = static_cast<std::size_t>(r * grid->width + c);
      grid->valid[bit / 64] |= std::uint64_t{1} << (bit % 64);
      placements.push_back({grid->centre(c, r), static_cast<double>(symbol - '0')});
    }
  }
  auto terrain = Terrain::build({}, placements, Duplicates::kReject);
  terrain->set_source_grid(grid);
  return std::move(*terrain);
}

std::optional<double> z_at(const Terrain& terrain, Point p, Voids voids = Voids::kKeep) {
  ElevationQuery query(terrain, voids);
  const auto found = query.at(p);
  return found ? std::optional(found->z) : std::nullopt;
}

TEST(ElevationTest, IsTheVertexsOwnAtAVertexAndLinearBetween) {
  const Terrain t = drawn({"13", "57"});
  EXPECT_EQ(z_at(t, {0, 0}), 1);
  EXPECT_EQ(z_at(t, {10, -10}), 7);
  EXPECT_EQ(z_at(t, {5, 0}), 2);
  EXPECT_EQ(z_at(t, {0, -5}), 3);
  EXPECT_EQ(z_at(t, {5, -5}), 4);
}

TEST(ElevationTest, IsNothingOutsideTheHullAndWithoutTriangles) {
  const Terrain t = drawn({"13", "57"});
  EXPECT_EQ(z_at(t, {11, 0}), std::nullopt);
  EXPECT_EQ(z_at(t, {-1, 1}), std::nullopt);
  EXPECT_EQ(z_at(drawn({"1 3"}), {0, 0}), std::nullopt);
  EXPECT_EQ(z_at(Terrain{tin::frame::Frame{}}, {0, 0}), std::nullopt);
}

TEST(ElevationTest, OfAPlaneIsThePlaneEverywhere) {
  support::Random random(support::seed());
  SCOPED_TRACE("TINSMITH_SEED=" + std::to_string(support::seed()));
  std::vector<Placement> placements;
  for (const Point p : support::random_points(random, 400, 1000))
    placements.push_back({p, 3 + 0.25 * p.x - 0.5 * p.y});
  const Terrain t = *Terrain::build({}, placements, Duplicates::kReject);
  ElevationQuery query(t, Voids::kKeep);
  int inside = 0;
  for (const Point p : support::random_points(random, 4000, 1000)) {
    const auto found = query.at(p);
    if (!found) continue;
    ++inside;
    EXPECT_NEAR(found->z, 3 + 0.25 * p.x - 0.5 * p.y, 1e-9);
  }
  EXPECT_GT(inside, 3000);
}

TEST(ElevationTest, OfLevelGroundIsLevelToTheLastBit) {
  std::vector<Placement> placements;
  for (const Point p : support::grid_points(8, 8, 13)) placements.push_back({p, 0.1});
  const Terrain t = *Terrain::build({}, placements, Duplicates::kReject);
  ElevationQuery query(t, Voids::kKeep);
  for (const Point p : support::grid_points(90, 90, 1)) EXPECT_EQ(query.at(p)->z, 0.1);
}

TEST(ElevationTest, DoesNotDependOnTheHistoryNorOnTheWalk) {
  support::Random random(support::seed());
  SCOPED_TRACE("TINSMITH_SEED=" + std::to_string(support::seed()));
  std::vector<Placement> placements;
  for (const Point p : support::grid_points(12, 12, 3))
    placements.push_back({p, std::sin(p.x) + std::cos(p.y)});
  const Terrain bulk = *Terrain::build({}, placements, Duplicates::kReject);
  Terrain edited{tin::frame::Frame{}};
  std::shuffle(placements.begin(), placements.end(), random);
  for (const Placement& p : placements) {
    ASSERT_TRUE(edited.apply(std::vector<Edit>{Insert{p.at, p.z}}, Duplicates::kReject).ok());
  }
  ASSERT_EQ(tin::mesh::validate(edited.mesh()), std::nullopt);
  ElevationQuery walking(bulk, Voids::kKeep);
  for (const Point p : support::grid_points(34, 34, 1)) {
    const auto expected = walking.at(p);
    ASSERT_TRUE(expected.has_value());
    EXPECT_EQ(z_at(edited, p), expected->z);
  }
}

TEST(ElevationTest, NamesTheTriangleCounterClockwiseSmallestIdFirst) {
  const Terrain t = drawn({"13", "57"});
  ElevationQuery query(t, Voids::kKeep);
  const auto found = query.at({1, -5});
  ASSERT_TRUE(found.has_value());
  for (const VertexId id : found->triangle) EXPECT_TRUE(t.vertex(id).has_value());
  EXPECT_LT(found->triangle[0], found->triangle[1]);
  EXPECT_LT(found->triangle[0], found->triangle[2]);
}

TEST(VoidsTest, HaveNoElevationUnlessFilled) {
  const Terrain t = drawn({"11111", "1   1", "1   1", "1   1", "11111"});
  EXPECT_EQ(z_at(t, {20, -20}), std::nullopt);
  EXPECT_EQ(z_at(t, {20, -20}, Voids::kFill), 1);
  EXPECT_EQ(z_at(t, {0, -20}), 1);
  EXPECT_EQ(z_at(t, {4, -20}), 1) << "still the valid cell at the rim";
  EXPECT_EQ(z_at(t, {6, -20}), std::nullopt);
}

TEST(VoidsTest, BecomeTerrainAroundAVertexThatSomebodyPutsThere) {
  Terrain t = drawn({"11111", "1   1", "1   1", "1   1", "11111"});
  const auto applied = t.apply(std::vector<Edit>{Insert{{20, -20}, 9}}, Duplicates::kReject);
  ASSERT_TRUE(applied.ok());
  EXPECT_EQ(z_at(t, {20, -20}), 9);
  EXPECT_TRUE(z_at(t, {15, -20}).has_value());
  ASSERT_TRUE(t.replay(applied->change.inverse()).ok());
  EXPECT_EQ(z_at(t, {20, -20}), std::nullopt);
  EXPECT_EQ(tin::mesh::validate(t.mesh()), std::nullopt);
}

}  // namespace
