// What is exported, read by the programs of others; and read by the server itself again.
#include <array>
#include <cmath>
#include <cstdlib>

#include "tests/e2e/dem.h"
#include "tests/e2e/served.h"

namespace tests::interop {
namespace {

using e2e::Json;
using e2e::sample_file;
using support::RawAnswer;
using support::run;

class FormatsTest : public e2e::ServedTest {
 protected:
  FormatsTest() { start(); }

  Json import(const std::string& id, const std::filesystem::path& file, const std::string& query = "") {
    const RawAnswer answer = served_->upload("?id=" + id + query, file);
    EXPECT_EQ(answer.status, 201) << answer.body;
    return Json::parse(answer.body, nullptr, false);
  }
  /// The file of an export under its own name.
  std::string exported(const std::string& id, const std::string& format, const std::string& query = "") {
    const RawAnswer answer = served_->http().get("/tins/" + id + "/export?f=" + format + query);
    const std::string said = answer.header("content-disposition");
    const std::size_t begin = said.find('"') + 1;
    return save(answer, said.substr(begin, said.rfind('"') - begin));
  }
  static Json raster_info(const std::string& file) {
    const auto said = run({"gdalinfo", "-json", "-checksum", "--config", "GDAL_PAM_ENABLED", "NO", file});
    EXPECT_EQ(said.status, 0) << said.err;
    EXPECT_EQ(said.err, "");
    return Json::parse(said.out, nullptr, false);
  }
  /// What ogrinfo says of a layer.
  static std::string layer_info(const std::string& file, const std::vector<std::string>& more = {}) {
    std::vector<std::string> words{"ogrinfo", "-ro", "-so", "-al"};
    words.insert(words.end(), more.begin(), more.end());
    words.push_back(file);
    const auto said = run(words);
    EXPECT_EQ(said.status, 0) << said.err;
    return said.out;
  }
  static void expect_said(const std::string& all, const std::string& part) {
    EXPECT_NE(all.find(part), std::string::npos) << part << "\nis not in\n" << all.substr(0, 3000);
  }
};

TEST_F(FormatsTest, EveryRasterHasTheChecksumOfItsSource) {
  import("sea", sample_file("olinda"), "&crs=EPSG:32725");
  import("land", sample_file("luxembourg"));  // voids
  for (const auto& [id, source] : std::vector<std::pair<std::string, std::string>>{
           {"sea", sample_file("olinda")}, {"land", sample_file("luxembourg")}}) {
    const Json wanted = raster_info(source);
    for (const std::string format : {"geotiff", "cog", "aaigrid"}) {
      SCOPED_TRACE(id + " as " + format);
      const Json found = raster_info(exported(id, format));
      EXPECT_EQ(found.at("size"), wanted.at("size"));
      EXPECT_EQ(found.at("bands").at(0).at("checksum"), wanted.at("bands").at(0).at("checksum"));
      for (std::size_t i = 0; i < 6; ++i) {
        EXPECT_NEAR(found.at("geoTransform").at(i).get<double>(),
                    wanted.at("geoTransform").at(i).get<double>(), 1e-6);
      }
    }
    const Json cog =
        raster_info(exported(id, "cog", "&cell-size=" + std::string(id == "sea" ? "10" : "0.001")));
    EXPECT_EQ(cog.at("metadata").at("IMAGE_STRUCTURE").at("LAYOUT"), "COG");
    EXPECT_FALSE(cog.at("bands").at(0).at("overviews").empty());
  }
}

TEST_F(FormatsTest, OgrinfoCountsWhatAGeoPackageHolds) {
  const Json tin = import("land", sample_file("luxembourg"));
  const std::string file = exported("land", "gpkg", "&voids=fill");
  const std::string vertices = tin.at("vertexCount").dump(), triangles = tin.at("triangleCount").dump();
  for (const auto& [layer, geometry, count] :
       std::vector<std::array<std::string, 3>>{{"vertices", "3D Point", vertices},
                                               {"triangles", "3D Polygon", triangles},
                                               {"surface", "3D TIN", "1"}}) {
    const auto said = run({"ogrinfo", "-ro", "-so", file, layer});
    EXPECT_EQ(said.status, 0) << said.err;
    expect_said(said.out, "Geometry: " + geometry + "\nFeature Count: " + count + "\n");
    expect_said(said.out, "WGS 84");
  }
  const auto sum = run({"ogrinfo", "-ro", "-q", "-dialect", "SQLITE", "-sql",
                        "SELECT sum(triangles) AS all_of_them FROM surface", file});
  expect_said(sum.out, "= " + triangles);
  // OGR reads each triangle of the TIN.
  const auto surface = run({"ogrinfo", "-ro", "-al", "-geom=SUMMARY", file, "surface"});
  std::size_t read = 0;
  for (std::size_t at = 0; (at = surface.out.find("TRIANGLE : 4 points", at)) != std::string::npos; ++at)
    ++read;
  EXPECT_EQ(read, tin.at("triangleCount").get<std::size_t>());
}

TEST_F(FormatsTest, OgrinfoCountsFlatGeobufAndCsv) {
  const Json tin = import("sea", sample_file("olinda"), "&crs=EPSG:32725");
  const std::string triangles = layer_info(exported("sea", "flatgeobuf"));
  expect_said(triangles, "Geometry: 3D Polygon\nFeature Count: " + tin.at("triangleCount").dump());
  expect_said(triangles, "UTM zone 25S");
  const std::string vertices =
      layer_info(exported("sea", "flatgeobuf", "&collection=vertices&crs=EPSG:4326"));
  expect_said(vertices, "Geometry: 3D Point\nFeature Count: " + tin.at("vertexCount").dump());
  expect_said(vertices, "WGS 84");
  const std::string csv =
      layer_info(exported("sea", "csv"),
                 {"-oo", "X_POSSIBLE_NAMES=x", "-oo", "Y_POSSIBLE_NAMES=y", "-oo", "Z_POSSIBLE_NAMES=z"});
  expect_said(csv, "Geometry: 3D Point\nFeature Count: " + tin.at("vertexCount").dump());
}

TEST_F(FormatsTest, TrianglesOverVoidsAreInNoFile) {
  const Json tin = import("land", sample_file("luxembourg"));
  const auto count = [this](const std::string& query) {
    const std::string said = layer_info(exported("land", "flatgeobuf", query));
    const std::size_t at = said.find("Feature Count: ");
    EXPECT_NE(at, std::string::npos) << said;
    return std::stoul(said.substr(at + 15));
  };
  const std::size_t all = tin.at("triangleCount").get<std::size_t>();
  EXPECT_EQ(count("&voids=fill"), all);
  // The terrain is 54 % of the box, and a cell is two triangles.
  EXPECT_LT(count(""), all);
  EXPECT_GT(count(""), tin.at("vertexCount").get<std::size_t>() * 18 / 10);
}

TEST_F(FormatsTest, EveryFormatThatNotesTheLatticeComesHomeWithTheSameDigest) {
  import("sea", sample_file("olinda"), "&crs=EPSG:32725&vertical-unit=foot");
  import("land", sample_file("luxembourg"));
  served_->simplify({{"tin", "sea"}, {"tolerance", 0.5}});
  for (const std::string id : {"sea", "land"}) {
    const Json tin = served_->get("/tins/" + id);
    for (const std::string format : {"obj", "ply", "ply-ascii", "2dm", "landxml", "xyz", "gpkg", "geojson"}) {
      if (id == "land" && format == "landxml") continue;  // it knows no degrees
      SCOPED_TRACE(id + " as " + format);
      const std::string own = "&collection=vertices&crs=" + tin.at("crs").get<std::string>();
      const Json home = import(id + "-" + format, exported(id, format, format == "geojson" ? own : ""));
      EXPECT_EQ(home.at("digest"), tin.at("digest"));
      EXPECT_EQ(home.at("verticalUnit"), tin.at("verticalUnit"));
    }
  }
}

TEST_F(FormatsTest, GltfValidatorFindsNoError) {
  if (run({"sh", "-c", "command -v node"}).status != 0) GTEST_SKIP() << "node is not installed";
  import("sea", sample_file("olinda"), "&crs=EPSG:32725");
  import("land", sample_file("luxembourg"));
  for (const std::string id : {"sea", "land"}) {
    const auto said = run(
        {"node", std::string(TINSMITH_SOURCE_DIR) + "/tests/interop/gltf_validate.js", exported(id, "glb")});
    if (said.status == 3) GTEST_SKIP() << "gltf-validator is not installed";
    ASSERT_EQ(said.status, 0) << said.err;
    const Json report = Json::parse(said.out, nullptr, false);
    EXPECT_EQ(report.at("errors"), 0) << said.out;
    EXPECT_EQ(report.at("warnings"), 0) << said.out;
  }
}

}  // namespace
}  // namespace tests::interop
