// Real elevation data, where it is there (TINSMITH_TERRAIN): counts and values as its manifest gives them.
#include <algorithm>

#include "tests/server/gdal/support.h"

namespace server::gdal::testing {
namespace {

struct Expected {
  std::string file, driver, crs, data_type;
  int width, height;
  std::size_t voids;
  double z_min, z_max;
};

class RealTerrainTest : public ScratchTest, public ::testing::WithParamInterface<Expected> {};

TEST_P(RealTerrainTest, EveryValidPixelArrives) {
  const Expected& expected = GetParam();
  const auto upload = terrain(expected.file);
  if (!upload) GTEST_SKIP() << "the real data is not here";
  const Import import = imported(*upload, named(expected.file));
  ASSERT_TRUE(import.grid);
  EXPECT_EQ(import.driver, expected.driver);
  EXPECT_EQ(import.frame.crs.substr(0, expected.crs.size()), expected.crs);
  EXPECT_EQ(import.frame.crs.empty(), expected.crs.empty());
  EXPECT_EQ(import.grid->data_type, expected.data_type);
  EXPECT_EQ(import.grid->width, expected.width);
  EXPECT_EQ(import.grid->height, expected.height);
  const std::size_t pixels =
      static_cast<std::size_t>(expected.width) * static_cast<std::size_t>(expected.height);
  EXPECT_EQ(import.placements.size(), pixels - expected.voids);
  EXPECT_EQ(import.grid->valid.empty(), expected.voids == 0);
  const bool says_unit = import.driver == "SRTMHGT" || import.driver == "USGSDEM";
  EXPECT_EQ(import.frame.vertical_unit, says_unit ? "metre" : "");
  const auto [low, high] = std::minmax_element(import.placements.begin(), import.placements.end(),
                                               [](const auto& a, const auto& b) { return a.z < b.z; });
  EXPECT_NEAR(low->z, expected.z_min, 1e-6);
  EXPECT_NEAR(high->z, expected.z_max, 1e-6);

  std::filesystem::path readable = path(expected.file);  // an HGT needs its name
  std::filesystem::rename(*upload, readable);
  const ReadBack source = read_back(readable);
  EXPECT_EQ(import.grid->geotransform, source.geotransform);
  std::size_t next = 0;
  for (std::int32_t row = 0; row < expected.height; ++row) {
    for (std::int32_t column = 0; column < expected.width; ++column) {
      if (!import.grid->is_valid(column, row)) continue;
      const auto& placed = import.placements.at(next++);
      ASSERT_EQ(placed.at, import.grid->centre(column, row));
      ASSERT_EQ(placed.z,
                source.values[static_cast<std::size_t>(row) * static_cast<std::size_t>(expected.width) +
                              static_cast<std::size_t>(column)]);
      const auto& g = source.geotransform;
      ASSERT_EQ(placed.at,
                import.frame.to_lattice(g[0] + (column + 0.5) * g[1], g[3] + (row + 0.5) * g[5]).value());
    }
  }
  EXPECT_EQ(next, import.placements.size());
}

INSTANTIATE_TEST_SUITE_P(
    Manifest, RealTerrainTest,
    ::testing::Values(
        Expected{"N44W072.hgt", "SRTMHGT", "EPSG:4326", "Int16", 1201, 1201, 0, 115, 1908},
        Expected{"N53E027.hgt", "SRTMHGT", "EPSG:4326", "Int16", 1201, 1201, 0, 142, 354},
        Expected{"jacksboro_fault_dem.tif", "GTiff", "EPSG:4326", "Int16", 403, 344, 0, 236, 1076},
        Expected{"luxembourg_elev_terra.tif", "GTiff", "EPSG:4326", "Int16", 95, 90, 3942, 141, 547},
        Expected{"olinda_dem_utm25s.tif", "GTiff", "BOUNDCRS[", "Float32", 111, 111, 0, -1, 88},
        Expected{"SainteHelens.dem", "USGSDEM", "EPSG:26710", "Int16", 327, 468, 4151, 682, 2543},
        Expected{"landlab_zSW3_lidar.asc", "AAIGrid", "", "Float32", 300, 452, 35152, -2.609347, 8.461376}),
    [](const auto& test) {
      std::string name = test.param.file;
      std::replace_if(
          name.begin(), name.end(), [](unsigned char c) { return std::isalnum(c) == 0; }, '_');
      return name;
    });

class RealPointsTest : public ScratchTest {};

TEST_F(RealPointsTest, GroundPointsInFeetKeepTheirDecimals) {
  const auto upload = terrain("autzen_trim_ground.csv");
  if (!upload) GTEST_SKIP() << "the real data is not here";
  ImportOptions options = named("autzen_trim_ground.csv");
  options.crs = "EPSG:2994";
  const Import import = imported(*upload, options);
  ASSERT_EQ(import.placements.size(), 26107U);
  EXPECT_EQ(import.frame.crs, "EPSG:2994");
  const auto& first = import.placements[0];
  EXPECT_EQ(import.frame.x.world(first.at.x), 637176.34);
  EXPECT_EQ(import.frame.y.world(first.at.y), 849400.84);
  EXPECT_EQ(first.z, 411.01);
  EXPECT_FALSE(import.grid);
}

}  // namespace
}  // namespace server::gdal::testing
