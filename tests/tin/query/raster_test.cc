#include "tin/query/raster.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/tin/query/analytic.h"
#include "tin/mesh/validate.h"
#include "tin/query/elevation.h"

namespace {

using tin::exact::Point;
using tin::query::ElevationQuery;
using tin::query::GradientQuery;
using tin::query::PixelCentres;
using tin::query::Rasteriser;
using tin::query::RasterLayer;
using tin::query::RasterOptions;
using tin::query::Voids;
using tin::terrain::Duplicates;
using tin::terrain::Edit;
using tin::terrain::Insert;
using tin::terrain::Terrain;

constexpr double kNone = -9999;

/// `count` centres from `first` on, `step` apart.
std::vector<std::int32_t> ordinates(std::int32_t first, std::int32_t step, std::size_t count) {
  std::vector<std::int32_t> out;
  for (std::size_t i = 0; i < count; ++i) out.push_back(first + step * static_cast<std::int32_t>(i));
  return out;
}

/// Each pixel against the query for its centre, bit for bit.
void expect_as_queried(const Terrain& terrain, const PixelCentres& centres, Voids voids,
                       const std::string& name) {
  const auto ground = support::metre_ground();
  for (const RasterLayer layer :
       {RasterLayer::kElevation, RasterLayer::kSlope, RasterLayer::kAspect, RasterLayer::kHillshade}) {
    RasterOptions options;
    options.layer = layer;
    options.voids = voids;
    options.ground = &ground;
    Rasteriser raster(terrain, centres, options, kNone);
    ElevationQuery elevation(terrain, voids);
    GradientQuery gradient(terrain, voids, ground);
    const tin::query::Shade shade(options.sun);
    std::vector<double> row(centres.x.size());
    for (std::size_t r = 0; r < centres.y.size(); ++r) {
      raster.row(r, row);
      for (std::size_t c = 0; c < row.size(); ++c) {
        const Point p{centres.x[c], centres.y[r]};
        double expected = kNone;
        if (layer == RasterLayer::kElevation) {
          if (const auto found = elevation.at(p)) expected = found->z;
        } else if (const auto found = gradient.at(p)) {
          expected = layer == RasterLayer::kSlope    ? tin::query::slope_degrees(*found)
                     : layer == RasterLayer::kAspect ? tin::query::aspect_degrees(*found).value_or(-1)
                                                     : 1 + 254 * shade(*found);
        }
        ASSERT_EQ(row[c], expected) << name << " at " << p.x << ' ' << p.y << " layer " << int(layer);
      }
    }
  }
}

/// Pixels over the terrain and a margin around it, so many each way.
PixelCentres over(const Terrain& terrain, std::int32_t count, bool north_up) {
  const auto box = terrain.bounds().value_or(tin::terrain::Box{{-5, -5}, {5, 5}});
  const std::int64_t width = std::int64_t{box.max.x} - box.min.x,
                     height = std::int64_t{box.max.y} - box.min.y;
  const auto step_x = static_cast<std::int32_t>(width / count + 1),
             step_y = static_cast<std::int32_t>(height / count + 1);
  const auto n = static_cast<std::size_t>(count) + 4;
  PixelCentres out{ordinates(box.min.x - step_x, step_x, n), ordinates(box.min.y - step_y, step_y, n)};
  if (north_up) std::reverse(out.y.begin(), out.y.end());
  return out;
}

TEST(RasterTest, EqualsTheQueriesOnHardSets) {
  support::Random random(support::seed());
  SCOPED_TRACE("TINSMITH_SEED=" + std::to_string(support::seed()));
  std::uniform_real_distribution<double> height(0, 50);
  for (const auto& set : support::hard_sets(random, 150)) {
    const Terrain terrain = support::terrain_of(set.points, [&](Point) { return height(random); });
    expect_as_queried(terrain, over(terrain, 61, true), Voids::kKeep, set.name);
    expect_as_queried(terrain, over(terrain, 7, false), Voids::kKeep, set.name);
  }
}

TEST(RasterTest, EqualsTheQueriesOnEveryLatticePointOfAGrid) {
  support::Random random(support::seed());
  std::uniform_real_distribution<double> height(0, 50);
  const Terrain terrain =
      support::terrain_of(support::grid_points(9, 7, 6), [&](Point) { return height(random); });
  expect_as_queried(terrain, {ordinates(-2, 1, 55), ordinates(40, -1, 45)}, Voids::kKeep, "grid");
}

TEST(RasterTest, EqualsTheQueriesWhereVoidsAre) {
  support::Random random(support::seed());
  SCOPED_TRACE("TINSMITH_SEED=" + std::to_string(support::seed()));
  for (const auto& [name, heights] : support::hard_rasters(random, 14)) {
    Terrain terrain = support::voided_terrain(heights, 7, 11);
    expect_as_queried(terrain, over(terrain, 90, true), Voids::kKeep, name);
    expect_as_queried(terrain, over(terrain, 31, true), Voids::kFill, name);
    const auto box = *terrain.bounds();
    ASSERT_TRUE(terrain
                    .apply(std::vector<Edit>{Insert{
                               {(box.min.x + box.max.x) / 2 + 1, (box.min.y + box.max.y) / 2}, 9}},
                           Duplicates::kReplace)
                    .ok());
    ASSERT_EQ(tin::mesh::validate(terrain.mesh()), std::nullopt);
    expect_as_queried(terrain, over(terrain, 31, true), Voids::kKeep, name + " edited");
  }
}

TEST(RasterTest, HasManyStripsAndTrianglesAcrossThem) {
  support::Random random(support::seed());
  std::uniform_real_distribution<double> height(0, 50);
  const Terrain terrain =
      support::terrain_of(support::random_points(random, 40, 1000), [&](Point) { return height(random); });
  expect_as_queried(terrain, {ordinates(-1000, 90, 23), ordinates(1050, -3, 700)}, Voids::kKeep, "tall");
  expect_as_queried(terrain, {ordinates(-1000, 90, 23), ordinates(-1050, 3, 700)}, Voids::kKeep,
                    "tall, south up");
}

TEST(RasterTest, GoesBackWhenAskedTo) {
  const Terrain terrain = support::terrain_of(support::grid_points(20, 20, 10), support::plane);
  Rasteriser raster(terrain, {ordinates(0, 5, 39), ordinates(190, -1, 191)}, {}, kNone);
  std::vector<double> first(39), last(39), again(39);
  raster.row(0, first);
  raster.row(190, last);
  raster.row(0, again);
  EXPECT_EQ(first, again);
  EXPECT_NE(first, last);
}

TEST(RasterTest, TakesCentresThatCoincideOrLieBeyondTheLattice) {
  const Terrain terrain = support::terrain_of(support::grid_points(3, 3, 10), support::plane);
  expect_as_queried(terrain, {{0, 0, 3, 3, 10, 20}, {20, 20, 9, 9, 0}}, Voids::kKeep, "twice");
  const std::int32_t far = std::int32_t{1} << 30;
  Rasteriser raster(terrain, {{-far, -far, 10, far}, {far, 10, -far}}, {}, kNone);
  std::vector<double> row(4);
  raster.row(0, row);
  EXPECT_EQ(row, std::vector<double>(4, kNone));
  raster.row(1, row);
  EXPECT_EQ(row, (std::vector<double>{kNone, kNone, support::plane({10, 10}), kNone}));
}

TEST(RasterTest, OfHugeTrianglesIsRoundedAsTheQueries) {
  const std::int32_t half = tin::exact::kLatticeHalf;
  const Terrain terrain = support::terrain_of(
      {{-half, -half}, {half - 1, -half + 3}, {half - 5, half - 1}, {-half + 9, half - 3}, {77, -13}},
      [](Point p) { return std::sin(p.x) * 1000; });
  expect_as_queried(terrain, over(terrain, 50, true), Voids::kKeep, "huge");
}

TEST(RasterTest, OfDegenerateTerrainsEqualsTheQueries) {
  for (const auto& [name, terrain] : support::degenerate_terrains()) {
    expect_as_queried(terrain, {ordinates(-3, 1, 40), ordinates(40, -1, 80)}, Voids::kKeep, name);
  }
  const Terrain terrain = support::terrain_of(support::grid_points(3, 3, 10), support::plane);
  Rasteriser nothing(terrain, {}, {}, kNone);
}

}  // namespace
