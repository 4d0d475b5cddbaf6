#include "server/tiles/picture.h"

#include <gtest/gtest.h>
#include <png.h>

#include "server/gdal/crs.h"
#include "tests/server/tiles/terrains.h"
#include "tin/query/elevation.h"

namespace {

using namespace server::tiles;
using tests::tiles::scattered;
using tin::terrain::Terrain;

std::vector<std::uint8_t> pixels(const std::string& file, png_uint_32 format) {
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  EXPECT_TRUE(png_image_begin_read_from_memory(&image, file.data(), file.size()));
  EXPECT_EQ(image.width, 256U);
  EXPECT_EQ(image.height, 256U);
  image.format = format;
  std::vector<std::uint8_t> read(PNG_IMAGE_SIZE(image));
  EXPECT_TRUE(png_image_finish_read(&image, nullptr, read.data(), 0, nullptr));
  return read;
}

/// The tile of a zoom that holds a place.
TileId tile_at(int z, double lon, double lat) {
  const double n = std::pow(2.0, z), rad = lat * M_PI / 180;
  return {z, static_cast<std::uint32_t>((lon + 180) / 360 * n),
          static_cast<std::uint32_t>((1 - std::asinh(std::tan(rad)) / M_PI) / 2 * n)};
}

/// Each pixel by MapLibre's formula against the elevation at its centre, found by the textbook's inverse of web mercator.
void check_elevations(const Terrain& terrain, const TileId& id) {
  const auto terrarium = pixels(*picture_tile(terrain, PictureKind::kTerrarium, id), PNG_FORMAT_RGB);
  const auto mapbox = pixels(*picture_tile(terrain, PictureKind::kMapbox, id), PNG_FORMAT_RGB);
  auto to_own = *server::gdal::CrsTransform::create("EPSG:4326", terrain.frame().crs);
  tin::query::ElevationQuery query(terrain, tin::query::Voids::kFill);
  const double n = std::pow(2.0, id.z);
  int inside = 0;
  for (int row = 0; row < 256; ++row) {
    for (int column = 0; column < 256; ++column) {
      double lon = (id.x + (column + 0.5) / 256) / n * 360 - 180;
      double lat = std::atan(std::sinh(M_PI * (1 - 2 * (id.y + (row + 0.5) / 256) / n))) * 180 / M_PI;
      std::uint8_t ok = 1;
      to_own.transform({&lon, 1}, {&lat, 1}, {&ok, 1});
      const auto at = terrain.frame().to_lattice(lon, lat);
      const auto found = at ? query.at(*at) : std::nullopt;
      const std::size_t i = 3 * static_cast<std::size_t>(row * 256 + column);
      const double t = terrarium[i] * 256.0 + terrarium[i + 1] + terrarium[i + 2] / 256.0 - 32768;
      const double m = -10000 + (mapbox[i] * 65536.0 + mapbox[i + 1] * 256.0 + mapbox[i + 2]) * 0.1;
      if (!found) continue;
      ++inside;
      // A pixel's centre may be off by a fiftieth of a pixel, where the ground may be as steep as 1 in 1.
      const double pixel_m = 40075016.7 / n / 256;
      ASSERT_NEAR(t, found->z, 1.0 / 512 + 0.03 * pixel_m + 0.002) << row << " " << column;
      ASSERT_NEAR(m, found->z, 0.05 + 0.03 * pixel_m + 0.002);
    }
  }
  EXPECT_GT(inside, 5000);
}

TEST(PictureTest, ElevationsAreThoseOfPixelCentres) {
  const Terrain terrain = scattered(5000);
  check_elevations(terrain, tile_at(12, 8.47, 47.31));
  check_elevations(terrain, tile_at(15, 8.47, 47.31));
}

TEST(PictureTest, BeyondTheTerrainIsTheGroundOrNothing) {
  const Terrain terrain = scattered(500);
  const TileId far = tile_at(12, -100, 30);
  for (const std::uint8_t byte : pixels(*picture_tile(terrain, PictureKind::kHillshade, far), PNG_FORMAT_GA)) EXPECT_EQ(byte, 0);
  const auto terrarium = pixels(*picture_tile(terrain, PictureKind::kTerrarium, far), PNG_FORMAT_RGB);
  for (std::size_t i = 0; i < terrarium.size(); i += 3) ASSERT_EQ(terrarium[i], 128);
}

TEST(PictureTest, ReliefIsBrightTowardsTheSunAndDarkAway) {
  // Two planes that meet in a ridge from south-west to north-east, whose end is drawn in so that no tie turns the edge.
  tin::frame::Frame frame;
  frame.crs = "EPSG:3857";
  frame.x = {0, 1, 1000};
  frame.y = {0, 1, 1000};
  const std::vector<tin::terrain::Placement> roof{
      {{-600000, -600000}, 500}, {{590000, 590000}, 500}, {{-600000, 600000}, 0}, {{600000, -600000}, 0}};
  const Terrain terrain = *Terrain::build(frame, roof, tin::terrain::Duplicates::kReplace);
  const auto relief = pixels(*picture_tile(terrain, PictureKind::kHillshade, {15, 16384, 16383}), PNG_FORMAT_GA);  // north-east of 0, 0
  const auto at = [&](int column, int row) { return relief[2 * static_cast<std::size_t>(row * 256 + column)]; };
  EXPECT_GT(at(10, 172), 200) << "north-west of the ridge";
  EXPECT_LT(at(120, 245), 140) << "south-east of it";
  EXPECT_EQ(at(10, 172), at(20, 150)) << "a plane has one shade";
  EXPECT_EQ(relief[1], 0) << "beyond the roof";
}

}  // namespace
