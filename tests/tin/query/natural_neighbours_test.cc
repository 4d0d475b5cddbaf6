#include "tin/query/natural_neighbours.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "tests/tin/query/analytic.h"
#include "tests/tin/query/voronoi.h"
#include "tin/mesh/validate.h"
#include "tin/query/elevation.h"

namespace {

using tin::exact::Point;
using tin::query::ElevationQuery;
using tin::query::Interpolation;
using tin::query::NaturalNeighbours;
using tin::query::Voids;
using tin::terrain::Duplicates;
using tin::terrain::Edit;
using tin::terrain::Insert;
using tin::terrain::Remove;
using tin::terrain::Terrain;
using tin::terrain::VertexId;
using Kind = tin::delaunay::Location::Kind;

std::map<Point, double> weights_at(const Terrain& terrain, Point p) {
  NaturalNeighbours neighbours(terrain.mesh());
  const auto where = terrain.triangulation().locate(p);
  std::map<Point, double> out;
  if (where.kind == Kind::kOutsideHull) return out;
  for (const auto& [vertex, weight] : neighbours.at(p, where.triangle))
    out[terrain.mesh().point(vertex)] = weight;
  return out;
}

std::optional<double> natural_z(const Terrain& terrain, Point p) {
  ElevationQuery query(terrain, Voids::kKeep, Interpolation::kNaturalNeighbour);
  const auto found = query.at(p);
  return found ? std::optional(found->z) : std::nullopt;
}

/// Against the definition, at points of the inner half (the oracle's square cuts off what reaches far out).
void expect_sibson(const std::vector<Point>& points, const std::vector<Point>& at) {
  const Terrain terrain = support::terrain_of(points, support::plane);
  for (const Point p : at) {
    const auto found = weights_at(terrain, p);
    const auto expected = support::sibson_weights(points, p);
    double sum = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const auto weight = found.find(points[i]);
      EXPECT_NEAR(weight == found.end() ? 0 : weight->second, expected[i], 1e-9)
          << "at " << p.x << ' ' << p.y << " of " << points[i].x << ' ' << points[i].y;
      sum += expected[i];
    }
    ASSERT_NEAR(sum, 1, 1e-9) << "the oracle's square is too small";
  }
}

TEST(NaturalNeighboursTest, HaveTheWeightsOfTheDefinitionAmongRandomPoints) {
  support::Random random(support::seed());
  SCOPED_TRACE("TINSMITH_SEED=" + std::to_string(support::seed()));
  auto points = support::random_points(random, 60, 1000);
  for (const Point corner : {Point{-1001, -1001}, Point{1001, -1001}, Point{1001, 1001}, Point{-1001, 1001}})
    points.push_back(corner);
  std::vector<Point> at;
  for (const Point p : support::random_points(random, 300, 500)) {
    if (std::find(points.begin(), points.end(), p) == points.end()) at.push_back(p);
  }
  expect_sibson(points, at);
}

TEST(NaturalNeighboursTest, HaveTheWeightsOfTheDefinitionOnAGrid) {
  // Centres of cells, where four circles coincide, the middles of edges, and anything between.
  const std::vector<Point> at{{25, 25}, {25, 30}, {30, 25}, {23, 29}, {31, 33}, {34, 36}, {35, 40}, {29, 41}};
  expect_sibson(support::grid_points(7, 7, 10), at);
}

TEST(NaturalNeighboursTest, GiveBackThePositionAsTheMeanOfTheNeighbours) {
  support::Random random(support::seed());
  SCOPED_TRACE("TINSMITH_SEED=" + std::to_string(support::seed()));
  for (const auto& set : support::hard_sets(random, 120)) {
    const Terrain terrain = support::terrain_of(set.points, support::plane);
    if (terrain.mesh().dimension() < 2) continue;
    const auto box = *terrain.bounds();
    std::uniform_int_distribution<std::int32_t> x(box.min.x, box.max.x), y(box.min.y, box.max.y);
    const double size = std::max(double(box.max.x) - box.min.x, double(box.max.y) - box.min.y);
    for (int i = 0; i < 200; ++i) {
      const Point p{x(random), y(random)};
      const auto weights = weights_at(terrain, p);
      if (weights.empty()) continue;
      double mean_x = 0, mean_y = 0, sum = 0;
      for (const auto& [at, weight] : weights) {
        EXPECT_GE(weight, -1e-9);
        sum += weight;
        mean_x += weight * (double(at.x) - p.x);
        mean_y += weight * (double(at.y) - p.y);
      }
      EXPECT_NEAR(sum, 1, 1e-12);
      EXPECT_NEAR(mean_x, 0, 1e-9 * size) << set.name;
      EXPECT_NEAR(mean_y, 0, 1e-9 * size) << set.name;
    }
  }
}

TEST(NaturalNeighbourElevationTest, IsExactOnPlanesAndLevelGround) {
  support::Random random(support::seed());
  const auto points = support::random_points(random, 300, 1000);
  const Terrain sloping = support::terrain_of(points, support::plane);
  const Terrain level = support::terrain_of(points, [](Point) { return 0.1; });
  for (const Point p : support::random_points(random, 1000, 1000)) {
    const auto z = natural_z(sloping, p);
    if (!z) continue;
    EXPECT_NEAR(*z, support::plane(p), 1e-8);
    EXPECT_EQ(natural_z(level, p), 0.1);
  }
}

TEST(NaturalNeighbourElevationTest, IsTheVertexsOwnAtAVertexAndContinuousThere) {
  const auto wave = [](Point p) { return std::sin(p.x / 4000.0) * 30 + std::cos(p.y / 3000.0) * 20; };
  const auto points = support::grid_points(12, 12, 10'000);
  const Terrain terrain = support::terrain_of(points, wave);
  for (const Point v : points) {
    EXPECT_EQ(natural_z(terrain, v), wave(v));
    for (const Point step : {Point{1, 0}, Point{0, 1}, Point{-1, 0}, Point{0, -1}, Point{1, -1}}) {
      const auto beside = natural_z(terrain, {v.x + step.x, v.y + step.y});
      if (beside) {
        EXPECT_NEAR(*beside, wave(v), 0.05);
      }
    }
  }
}

TEST(NaturalNeighbourElevationTest, IsContinuousAcrossEdgesAndCoincidingCircles) {
  support::Random random(support::seed());
  const auto points = support::grid_points(5, 5, 10'000);
  std::uniform_real_distribution<double> height(0, 50);
  const Terrain terrain = support::terrain_of(points, [&](Point) { return height(random); });
  // Along a line through cells, diagonals and cell centres: no step is larger than a steep slope explains.
  std::optional<double> last;
  for (std::int32_t i = 0; i < 40'000; i += 7) {
    const auto z = natural_z(terrain, {i, i / 3 + 11'000});
    ASSERT_TRUE(z.has_value());
    if (last) {
      EXPECT_NEAR(*z, *last, 0.2);
    }
    last = z;
  }
}

TEST(NaturalNeighbourElevationTest, IsLinearAlongTheHull) {
  const Terrain terrain = support::terrain_of({{0, 0}, {1000, 0}, {1000, 1000}, {0, 1000}, {400, 300}},
                                              [](Point p) { return p.x * 0.5 + (p.y > 0 ? 90 : 0); });
  EXPECT_EQ(natural_z(terrain, {250, 0}), 125);
  EXPECT_NEAR(*natural_z(terrain, {250, 1}), 125, 0.5);
  EXPECT_EQ(natural_z(terrain, {250, -1}), std::nullopt);
}

TEST(NaturalNeighbourElevationTest, DoesNotDependOnTheHistory) {
  support::Random random(support::seed());
  SCOPED_TRACE("TINSMITH_SEED=" + std::to_string(support::seed()));
  const auto wave = [](Point p) { return std::sin(p.x) + std::cos(p.y); };
  auto points = support::random_points(random, 200, 300);
  const Terrain built = support::terrain_of(points, wave);
  std::shuffle(points.begin(), points.end(), random);
  Terrain edited = support::terrain_of({}, wave);
  for (const Point p : points)
    ASSERT_TRUE(edited
                    .apply(std::vector<Edit>{Insert{p, wave(p)}, Insert{{p.x + 1, p.y + 1000}, 5}},
                           Duplicates::kReject)
                    .ok());
  for (std::uint64_t id = 2; id <= 400; id += 2)
    ASSERT_TRUE(edited.apply(std::vector<Edit>{Remove{VertexId(id)}}, Duplicates::kReject).ok());
  ASSERT_EQ(tin::mesh::validate(edited.mesh()), std::nullopt);
  for (const Point p : support::random_points(random, 500, 300))
    EXPECT_EQ(natural_z(built, p), natural_z(edited, p));
}

TEST(NaturalNeighbourElevationTest, OfATerrainWithoutTrianglesIsTheLinearOne) {
  for (const auto& [name, terrain] : support::degenerate_terrains()) {
    ElevationQuery linear(terrain, Voids::kKeep);
    for (const Point p :
         {Point{4, 7}, Point{5, 10}, Point{6, 0}, Point{0, 6}, Point{3, -2}, Point{100, 100}}) {
      const auto found = linear.at(p);
      EXPECT_EQ(natural_z(terrain, p), found ? std::optional(found->z) : std::nullopt) << name;
    }
  }
}

}  // namespace
