#include <algorithm>

#include "tests/server/gdal/support.h"

namespace server::gdal::testing {
namespace {

using tin::base::Code;

class VectorImportTest : public ScratchTest {
 protected:
  std::filesystem::path geojson(const std::string& features) const {
    return file("upload", R"({"type":"FeatureCollection","features":[)" + features + "]}");
  }
};

constexpr const char* kTwo =
    R"({"type":"Feature","properties":{"h":100.5},"geometry":{"type":"Point","coordinates":[8.25,47.5,400]}},)"
    R"({"type":"Feature","properties":{"h":200},"geometry":{"type":"Point","coordinates":[8.5,47.75,410.5]}})";

TEST_F(VectorImportTest, ReadsGeoJson) {
  const Import import = imported(geojson(kTwo));
  EXPECT_EQ(import.driver, "GeoJSON");
  EXPECT_EQ(import.frame.crs, "EPSG:4326");
  ASSERT_EQ(import.placements.size(), 2U);
  EXPECT_EQ(import.placements[0].at, import.frame.to_lattice(8.25, 47.5).value());
  EXPECT_EQ(import.placements[0].z, 400);
  EXPECT_EQ(import.placements[1].z, 410.5);
  EXPECT_FALSE(import.grid);
}

TEST_F(VectorImportTest, TakesHeightsFromAField) {
  ImportOptions options;
  options.z_field = "h";
  EXPECT_EQ(imported(geojson(kTwo), options).placements[0].z, 100.5);
  options.z_field = "none";
  EXPECT_EQ(import_error(geojson(kTwo), options).where, "query:z-field");
  const Import flat = imported(geojson(
      R"({"type":"Feature","properties":{"elevation":7},"geometry":{"type":"Point","coordinates":[8,47]}})"));
  EXPECT_EQ(flat.placements.at(0).z, 7);
}

TEST_F(VectorImportTest, ReadsMultiPoints) {
  const Import import = imported(geojson(
      R"({"type":"Feature","properties":{},"geometry":{"type":"MultiPoint","coordinates":[[8,47,1],[9,47,2]]}})"));
  ASSERT_EQ(import.placements.size(), 2U);
  EXPECT_EQ(import.placements[1].z, 2);
}

TEST_F(VectorImportTest, NamesTheFeatureThatIsWrong) {
  auto problem = import_error(geojson(
      std::string(kTwo) +
      R"(,{"type":"Feature","properties":{},"geometry":{"type":"LineString","coordinates":[[8,47,1],[9,47,2]]}})"));
  EXPECT_EQ(problem.code, Code::kUnsupported);
  EXPECT_EQ(problem.where, "feature 3");
  problem =
      import_error(geojson(std::string(kTwo) + R"(,{"type":"Feature","properties":{},"geometry":null})"));
  EXPECT_EQ(problem.code, Code::kMalformed);
  EXPECT_EQ(problem.where, "feature 3");
  problem = import_error(
      geojson(R"({"type":"Feature","properties":{},"geometry":{"type":"Point","coordinates":[8,47]}})"));
  EXPECT_EQ(problem.code, Code::kInvalidValue);
  EXPECT_NE(problem.message.find("z-field"), std::string::npos);
}

TEST_F(VectorImportTest, ACoordinateThatIsNoNumberIsAnError) {
  for (const char* bad : {"NaN", "Infinity", "1e999", "\"8\"", "null"}) {
    const auto problem = import_error(
        geojson(std::string(kTwo) +
                R"(,{"type":"Feature","properties":{},"geometry":{"type":"Point","coordinates":[)" + bad +
                ",47,1]}}"));
    EXPECT_TRUE(problem.code == Code::kNotFinite || problem.code == Code::kMalformed)
        << bad << problem.message;
  }
}

TEST_F(VectorImportTest, RefusesDamagedAndEmptyGeoJson) {
  EXPECT_EQ(
      import_error(file("upload", R"({"type":"FeatureCollection","features":[)" + std::string(kTwo))).code,
      Code::kMalformed);
  EXPECT_EQ(import_error(file("upload", R"({"a":1})")).code, Code::kMalformed);
  const Code none = import_error(geojson("")).code;
  EXPECT_TRUE(none == Code::kInvalidValue || none == Code::kMalformed);
  EXPECT_EQ(import_error(file("upload", std::string(5000, '{'))).code, Code::kMalformed);
}

TEST_F(VectorImportTest, ReadsGeoPackagesAndFlatGeobufs) {
  const std::vector<PointLayer> layers{
      {"points", "EPSG:32632", {{500000, 5e6, 10}, {500010.5, 5000020.25, 20}}}};
  for (const auto& [driver, name] : {std::pair{"GPKG", "a.gpkg"}, std::pair{"FlatGeobuf", "a.fgb"}}) {
    make_vector(path(name), driver, layers);
    Import import = imported(path(name));
    EXPECT_EQ(import.driver, driver);
    EXPECT_EQ(import.frame.crs, "EPSG:32632");
    ASSERT_EQ(import.placements.size(), 2U);
    std::sort(import.placements.begin(), import.placements.end(), [](auto& a, auto& b) { return a.z < b.z; });
    EXPECT_EQ(import.placements[1].z, 20);
    EXPECT_EQ(import.frame.x.world(import.placements[1].at.x), 500010.5);
    EXPECT_EQ(import.frame.y.world(import.placements[1].at.y), 5000020.25);
    ImportOptions options;
    options.z_field = "twice";
    options.crs = "EPSG:32633";
    const Import other = imported(path(name), options);
    EXPECT_EQ(other.frame.crs, "EPSG:32633");
    EXPECT_EQ(other.placements.at(0).z + other.placements.at(1).z, 60);
  }
}

TEST_F(VectorImportTest, ChoosesTheLayer) {
  make_vector(path("a.gpkg"), "GPKG",
              {{"parcels", "EPSG:32632", {}, true},
               {"first", "EPSG:32632", {{1, 2, 3}}},
               {"second", "EPSG:32632", {{4, 5, 6}}}});
  EXPECT_EQ(imported(path("a.gpkg")).placements.at(0).z, 3);
  ImportOptions options;
  options.layer = "second";
  EXPECT_EQ(imported(path("a.gpkg"), options).placements.at(0).z, 6);
  options.layer = "third";
  EXPECT_EQ(import_error(path("a.gpkg"), options).where, "query:layer");
  options.layer = "parcels";
  EXPECT_EQ(import_error(path("a.gpkg"), options).code, Code::kInvalidValue);
}

TEST_F(VectorImportTest, HoldsItsLimitsAndCanBeCancelled) {
  ImportOptions options;
  options.max_samples = 1;
  EXPECT_EQ(import_error(geojson(kTwo), options).code, Code::kTooLarge);
  tin::base::Progress progress;
  progress.cancel();
  EXPECT_EQ(import_file(geojson(kTwo), {}, &progress).error().code, Code::kCancelled);
}

}  // namespace
}  // namespace server::gdal::testing
