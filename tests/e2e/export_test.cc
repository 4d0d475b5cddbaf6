// What is taken home, judged by the programs of GDAL: gdalinfo, gdal_translate, ogrinfo.
#include <cmath>

#include "tests/e2e/dem.h"
#include "tests/e2e/served.h"

namespace tests::e2e {
namespace {

using support::run;

class ExportTest : public ServedTest {
 protected:
  ExportTest() { start(); }

  void import(const std::filesystem::path& file, const std::string& query = "") {
    const RawAnswer answer = served_->upload("?id=dem" + query, file);
    ASSERT_EQ(answer.status, 201) << answer.body;
  }
  std::string geotiff(const std::string& query = "") {
    return save(served_->http().get("/tins/dem/export?f=geotiff" + query), "export.tif");
  }
  /// What gdalinfo says of a raster.
  static Json info(const std::string& file) {
    const auto said = run({"gdalinfo", "-json", "-checksum", "--config", "GDAL_PAM_ENABLED", "NO", file});
    EXPECT_EQ(said.status, 0) << said.err;
    EXPECT_EQ(said.err, "");
    return Json::parse(said.out, nullptr, false);
  }
  static bool has_crs(const Json& raster, const std::string& code) {
    return raster.at("coordinateSystem").at("wkt").get<std::string>().find("ID[\"EPSG\"," + code + "]]") !=
           std::string::npos;
  }
  /// The raster in the source's own data type, by gdal_translate.
  std::string translated(const std::string& file, const std::string& type) {
    const std::string to = folder_.path() / "translated.tif";
    const auto done = run({"gdal_translate", "-q", "-ot", type, file, to});
    EXPECT_EQ(done.status, 0) << done.err;
    return to;
  }

  /// An unsimplified terrain comes home as it was: place, size, nodata, and every pixel.
  void expect_source_again(const std::filesystem::path& file) {
    const Json source = info(file.string()), exported = info(geotiff());
    EXPECT_EQ(exported.at("driverShortName"), "GTiff");
    EXPECT_EQ(exported.at("size"), source.at("size"));
    EXPECT_EQ(exported.at("geoTransform"), source.at("geoTransform"));
    const Json &from = source.at("bands").at(0), &to = exported.at("bands").at(0);
    EXPECT_EQ(to.at("checksum"), from.at("checksum")) << file;
    if (from.contains("noDataValue")) {
      EXPECT_EQ(to.at("noDataValue"), from.at("noDataValue"));
    }
    const Json back = info(translated(folder_.path() / "export.tif", from.at("type")));
    EXPECT_EQ(back.at("bands").at(0).at("checksum"), from.at("checksum"));
    const Dem before(file), after(folder_.path() / "export.tif");  // gdalinfo rounds
    EXPECT_EQ(after.geotransform, before.geotransform);
    EXPECT_TRUE(after.values == before.values) << file;
  }
};

TEST_F(ExportTest, AProjectedDemComesHomeAsItWas) {
  import(sample_file("olinda"), "&crs=EPSG:32725");
  expect_source_again(sample_file("olinda"));
  EXPECT_TRUE(has_crs(info(geotiff()), "32725"));
}

TEST_F(ExportTest, ACrsWithoutACodeComesHomeAsItWas) {
  import(sample_file("olinda"));
  expect_source_again(sample_file("olinda"));
  const auto same = run({"gdalsrsinfo", "-o", "proj4", geotiff()}),
             source = run({"gdalsrsinfo", "-o", "proj4", sample_file("olinda")});
  EXPECT_EQ(same.out, source.out);
}

TEST_F(ExportTest, ADemWithVoidsComesHomeAsItWas) {
  import(sample_file("luxembourg"));
  expect_source_again(sample_file("luxembourg"));
  EXPECT_TRUE(has_crs(info(geotiff()), "4326"));
}

/// Larger ones, where a folder has them; the sample stands in for what is not there.
class LargeExportTest : public ExportTest, public testing::WithParamInterface<std::string> {};

TEST_P(LargeExportTest, ComesHomeAsItWas) {
  const auto file = terrain_file(GetParam()).value_or(sample_file("luxembourg"));
  import(file);
  expect_source_again(file);
}

INSTANTIATE_TEST_SUITE_P(Terrains, LargeExportTest,
                         testing::Values("N44W072.hgt", "SainteHelens.dem", "jacksboro_fault_dem.tif"),
                         [](const auto& one) { return one.param.substr(0, one.param.find('.')); });

TEST_F(ExportTest, ACrsThatGdalTranslateAssignedIsRecognised) {
  const std::string assigned = folder_.path() / "assigned.tif";
  const auto done = run({"gdal_translate", "-q", "-a_srs", "EPSG:31985", sample_file("olinda"), assigned});
  ASSERT_EQ(done.status, 0) << done.err;
  import(assigned);
  EXPECT_EQ(served_->get("/tins/dem").at("crs"), "EPSG:31985");
  expect_source_again(assigned);
  EXPECT_TRUE(has_crs(info(geotiff()), "31985"));
}

TEST_F(ExportTest, AnotherCellSizeLaysAnotherGridOverTheTerrain) {
  import(sample_file("olinda"), "&crs=EPSG:32725");
  const Dem dem(sample_file("olinda"));
  const Json raster = info(geotiff("&cell-size=50"));
  const auto cells = [](int pixels, double size) { return static_cast<int>(std::ceil(pixels * size / 50)); };
  EXPECT_EQ(raster.at("size"),
            (Json{cells(dem.width, dem.geotransform[1]), cells(dem.height, -dem.geotransform[5])}));
  const Dem grid(folder_.path() / "export.tif");
  EXPECT_EQ(grid.geotransform,
            (std::array<double, 6>{dem.geotransform[0], 50, 0, dem.geotransform[3], 0, -50}));
  EXPECT_TRUE(has_crs(raster, "32725"));
  const Json& band = raster.at("bands").at(0);
  EXPECT_EQ(band.at("noDataValue"), -9999.0);
}

TEST_F(ExportTest, ABoxCutsPixelsOutOfTheSourcesGrid) {
  import(sample_file("luxembourg"));
  const Dem dem(sample_file("luxembourg"));
  const std::string box = Json(dem.x(20)).dump() + "," + Json(dem.y(49)).dump() + "," +
                          Json(dem.x(59)).dump() + "," + Json(dem.y(30)).dump();
  const Dem part(geotiff("&bbox=" + box));
  ASSERT_EQ(part.width, 40);
  ASSERT_EQ(part.height, 20);
  EXPECT_NEAR(part.geotransform[0], dem.geotransform[0] + 20 * dem.geotransform[1], 1e-12);
  std::size_t wrong = 0;
  for (int row = 0; row < 20; ++row) {
    for (int column = 0; column < 40; ++column)
      wrong += part.value(column, row) != dem.value(column + 20, row + 30);
  }
  EXPECT_EQ(wrong, 0U);
}

TEST_F(ExportTest, AnotherCrsHasTheElevationsOfItsPixelsCentres) {
  import(sample_file("olinda"), "&crs=EPSG:32725");
  const Json raster = info(geotiff("&crs=EPSG:4326&cell-size=0.001"));
  EXPECT_TRUE(has_crs(raster, "4326"));
  EXPECT_EQ(raster.at("geoTransform").at(1), 0.001);
  const auto& corner = raster.at("cornerCoordinates").at("upperLeft");
  EXPECT_NEAR(corner.at(0).get<double>(), -34.9157, 2e-3);
  EXPECT_NEAR(corner.at(1).get<double>(), -7.9502, 2e-3);
  const Dem dem(folder_.path() / "export.tif");
  const int column = dem.width / 2, row = dem.height / 2;
  const std::string at =
      "/tins/dem/elevation?crs=EPSG:4326&x=" + Json(dem.x(column)).dump() + "&y=" + Json(dem.y(row)).dump();
  EXPECT_NEAR(served_->get(at).at("z").get<double>(), dem.value(column, row), 1e-4);
}

TEST_F(ExportTest, OgrinfoCountsTheFeaturesOfAGeojson) {
  import(sample_file("luxembourg"));
  const Json tin = served_->get("/tins/dem");
  for (const auto& [collection, count, geometry] :
       std::vector<std::tuple<std::string, std::string, std::string>>{
           {"vertices", "vertexCount", "3D Point"}, {"triangles", "triangleCount", "3D Polygon"}}) {
    const std::string file =
        save(served_->http().get("/tins/dem/export?f=geojson&voids=fill&collection=" + collection),
             collection + ".geojson");
    const auto said = run({"ogrinfo", "-ro", "-so", "-al", file});
    EXPECT_EQ(said.status, 0) << said.err;
    EXPECT_NE(said.out.find("Feature Count: " + tin.at(count).dump() + "\n"), std::string::npos) << said.out;
    EXPECT_NE(said.out.find("Geometry: " + geometry), std::string::npos) << said.out;
    EXPECT_NE(said.out.find("WGS 84"), std::string::npos);
  }
}

TEST_F(ExportTest, AGeojsonInTheTinsCrsSaysSo) {
  import(sample_file("olinda"), "&crs=EPSG:32725");
  const std::string file =
      save(served_->http().get("/tins/dem/export?f=geojson&crs=EPSG:32725"), "own.geojson");
  const auto said = run({"ogrinfo", "-ro", "-so", "-al", file});
  EXPECT_NE(said.out.find("WGS 84 / UTM zone 25S"), std::string::npos) << said.out;
  EXPECT_NE(said.out.find("Feature Count: " + served_->get("/tins/dem").at("triangleCount").dump()),
            std::string::npos);
}

TEST_F(ExportTest, AnExportLeavesNoFileBehind) {
  import(sample_file("olinda"));
  geotiff();
  EXPECT_EQ(served_->stop(), 0);
  for (const char* folder : {"exports", "uploads"}) {
    std::error_code none;
    const std::filesystem::directory_iterator files(data() / folder, none);
    EXPECT_TRUE(none || files == end(files)) << folder;
  }
}

}  // namespace
}  // namespace tests::e2e
