// A real DEM goes in: counts, elevations, edits.
#include <cstdio>
#include <fstream>
#include <random>
#include <sstream>

#include "tests/e2e/dem.h"
#include "tests/e2e/served.h"

namespace tests::e2e {
namespace {

class TerrainTest : public ServedTest {
 protected:
  TerrainTest() { start(); }

  Json import(const Dem& dem, const std::string& query = "") {
    const RawAnswer answer = served_->upload("?id=dem" + query, dem.file);
    EXPECT_EQ(answer.status, 201) << answer.body;
    return Json::parse(answer.body);
  }

  /// Asks for elevations at the centres of `count` pixels and holds them against the samples.
  void expect_samples(const Dem& dem, std::size_t count) {
    std::mt19937 random(7);
    std::vector<std::pair<int, int>> pixels;
    Json positions = Json::array();
    while (pixels.size() < count) {
      const auto [column, row] = pixels.emplace_back(static_cast<int>(random() % dem.width),
                                                     static_cast<int>(random() % dem.height));
      positions.push_back({dem.x(column), dem.y(row)});
    }
    const RawAnswer answer =
        served_->http().post_json("/tins/dem/elevation", Json{{"positions", positions}}.dump());
    ASSERT_EQ(answer.status, 200) << answer.body.substr(0, 300);
    const Json body = Json::parse(answer.body);
    std::size_t wrong = 0;
    for (std::size_t i = 0; i < count; ++i) {
      const auto [column, row] = pixels[i];
      const Json& z = body.at("z").at(i);
      wrong += dem.valid(column, row) ? z != dem.value(column, row) : !z.is_null();
    }
    EXPECT_EQ(wrong, 0U) << dem.file;
  }

  /// Removes `count` vertices and inserts them again as the server told them, in two requests.
  void expect_same_digest_after_reinsertion(const std::string& crs, std::size_t count) {
    const Json before = served_->get("/tins/dem");
    const Json all =
        served_->get("/tins/dem/export?f=geojson&collection=vertices" + (crs.empty() ? "" : "&crs=" + crs));
    std::vector<Json> chosen;
    std::sample(all.at("features").begin(), all.at("features").end(), std::back_inserter(chosen), count,
                std::mt19937(11));
    Json removals = Json::array(), insertions = Json::array();
    for (const Json& vertex : chosen) {
      const Json& at = vertex.at("geometry").at("coordinates");
      removals.push_back({{"op", "remove"}, {"id", vertex.at("id")}});
      insertions.push_back({{"op", "insert"}, {"x", at.at(0)}, {"y", at.at(1)}, {"z", at.at(2)}});
    }
    served_->edit("dem", removals);
    const Json between = served_->get("/tins/dem");
    EXPECT_EQ(between.at("vertexCount").get<std::size_t>() + chosen.size(), before.at("vertexCount"));
    EXPECT_NE(between.at("digest"), before.at("digest"));
    Json message{{"ops", insertions}, {"crs", crs.empty() ? "OGC:CRS84" : crs}};
    const RawAnswer inserted = served_->http().post_json("/tins/dem/edits", message.dump());
    ASSERT_EQ(inserted.status, 200) << inserted.body;
    const Json after = served_->get("/tins/dem");
    EXPECT_EQ(after.at("digest"), before.at("digest"));
    EXPECT_EQ(after.at("triangleCount"), before.at("triangleCount"));
    EXPECT_EQ(after.at("revision"), 3);
  }
};

TEST_F(TerrainTest, AProjectedDemIsServedAsItsSamples) {
  const Dem dem(sample_file("olinda"));
  const Json tin = import(dem, "&crs=EPSG:32725");
  EXPECT_EQ(tin.at("vertexCount"), dem.valid_count());
  EXPECT_EQ(tin.at("crs"), "EPSG:32725");
  EXPECT_EQ(tin.at("source").at("width"), dem.width);
  expect_samples(dem, 5000);
  expect_same_digest_after_reinsertion("EPSG:32725", 1500);
}

TEST_F(TerrainTest, ACrsThatHasNoCodeIsKept) {
  const Dem dem(sample_file("olinda"));
  const Json tin = import(dem);
  EXPECT_NE(tin.at("crs").get<std::string>().find("UTM Zone 25, Southern Hemisphere"), std::string::npos);
  expect_same_digest_after_reinsertion("", 1500);
}

TEST_F(TerrainTest, ADemInDegreesWithVoidsIsServedAsItsValidSamples) {
  const Dem dem(sample_file("luxembourg"));
  ASSERT_LT(dem.valid_count(), dem.values.size());
  const Json tin = import(dem);
  EXPECT_EQ(tin.at("vertexCount"), dem.valid_count());
  EXPECT_EQ(tin.at("crs"), "EPSG:4326");
  EXPECT_EQ(tin.at("source").at("nodata"), dem.nodata.value());
  expect_samples(dem, 5000);
  expect_same_digest_after_reinsertion("EPSG:4326", 1000);
}

TEST_F(TerrainTest, AVoidStaysAVoidUntilItIsToBeFilled) {
  const Dem dem(sample_file("luxembourg"));
  import(dem);
  std::size_t filled = 0;
  for (int row = 0; row < dem.height; row += 5) {
    for (int column = 0; column < dem.width; column += 5) {
      if (dem.valid(column, row)) continue;
      const std::string at =
          "/tins/dem/elevation?x=" + Json(dem.x(column)).dump() + "&y=" + Json(dem.y(row)).dump();
      EXPECT_TRUE(served_->get(at).at("z").is_null());
      filled += !served_->get(at + "&voids=fill").at("z").is_null();
    }
  }
  EXPECT_GT(filled, 0U) << "bays of the border lie within the hull";
}

TEST_F(TerrainTest, ADemWithoutNodataIsWholeAndAnEditShowsInItsElevations) {
  const Dem dem(sample_file("olinda"));
  import(dem, "&crs=EPSG:32725");
  const Json ops = Json::array({{{"op", "set-z"}, {"id", 1}, {"z", 999.5}}});
  served_->edit("dem", ops);
  const std::string at = "/tins/dem/elevation?x=" + Json(dem.x(0)).dump() + "&y=" + Json(dem.y(0)).dump();
  EXPECT_EQ(served_->get(at).at("z"), 999.5);
}

/// Larger terrains, where a folder has them.
class LargeTerrainTest : public TerrainTest, public testing::WithParamInterface<std::string> {};

TEST_P(LargeTerrainTest, IsServedAsItsSamplesAndComesBackAfterEdits) {
  const auto file = terrain_file(GetParam());
  if (!file) {
    const Dem sample(sample_file("luxembourg"));  // the smaller one stands in for it
    EXPECT_EQ(import(sample).at("vertexCount"), sample.valid_count());
    return;
  }
  const Dem dem(*file);
  const Json tin = import(dem);
  EXPECT_EQ(tin.at("vertexCount"), dem.valid_count());
  expect_samples(dem, 20'000);
  Json removals = Json::array(), insertions = Json::array();
  for (int id = 1; id < 140'000; id += 97) {
    removals.push_back({{"op", "remove"}, {"id", id}});
  }
  std::size_t id = 0;
  for (int row = 0; row < dem.height; ++row) {
    for (int column = 0; column < dem.width; ++column) {
      if (!dem.valid(column, row) || ++id >= 140'000 || id % 97 != 1) continue;
      insertions.push_back(
          {{"op", "insert"}, {"x", dem.x(column)}, {"y", dem.y(row)}, {"z", dem.value(column, row)}});
    }
  }
  ASSERT_EQ(removals.size(), insertions.size());
  served_->edit("dem", removals);
  EXPECT_NE(served_->get("/tins/dem").at("digest"), tin.at("digest"));
  served_->edit("dem", insertions);
  EXPECT_EQ(served_->get("/tins/dem").at("digest"), tin.at("digest"));
}

INSTANTIATE_TEST_SUITE_P(Terrains, LargeTerrainTest, testing::Values("N44W072.hgt", "SainteHelens.dem"),
                         [](const auto& one) { return one.param.substr(0, one.param.find('.')); });

/// Ground points of a survey in feet where a folder has them, else points like them.
TEST_F(TerrainTest, PointsInFeetAreServedInTheirCrs) {
  std::string points = "x,y,z\n";
  std::mt19937 random(3);
  for (int i = 0; i < 2000; ++i) {
    points += std::to_string(636000 + i / 40 * 20) + "." + std::to_string(10 + random() % 90) + "," +
              std::to_string(849000 + i % 40 * 20) + ".25," + std::to_string(400 + random() % 40) + ".5\n";
  }
  if (const auto file = terrain_file("autzen_trim_ground.csv")) {
    std::ostringstream text;
    text << std::ifstream(*file).rdbuf();
    points = text.str();
  }
  std::istringstream lines(points);
  std::string line;
  std::getline(lines, line);
  Json positions = Json::array(), z = Json::array();
  while (std::getline(lines, line)) {
    double x = 0, y = 0, height = 0;
    ASSERT_EQ(std::sscanf(line.c_str(), "%lf,%lf,%lf", &x, &y, &height), 3) << line;
    positions.push_back({x, y});
    z.push_back(height);
  }
  const RawAnswer answer = served_->http().post("/tins?id=ground&crs=EPSG:2994", "text/csv", points);
  ASSERT_EQ(answer.status, 201) << answer.body;
  const Json tin = Json::parse(answer.body);
  EXPECT_EQ(tin.at("crs"), "EPSG:2994");
  EXPECT_EQ(tin.at("vertexCount"), positions.size());
  const RawAnswer elevations =
      served_->http().post_json("/tins/ground/elevation", Json{{"positions", positions}}.dump());
  EXPECT_EQ(Json::parse(elevations.body).at("z"), z);
  const Json page = served_->get("/tins/ground/collections/vertices/items?limit=1");
  EXPECT_EQ(page.at("numberMatched"), positions.size());
  const Json& at = page.at("features").at(0).at("geometry").at("coordinates");
  EXPECT_NEAR(at.at(0).get<double>(), -123.07, 0.02) << "Eugene, Oregon";
  EXPECT_NEAR(at.at(1).get<double>(), 44.055, 0.02);
}

}  // namespace
}  // namespace tests::e2e
