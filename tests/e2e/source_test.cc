// The samples that a TIN was made of stay with it: over restarts, over simplifications, beside people's
// edits. Judged by code that shares nothing with the server's.
#include <cmath>
#include <fstream>
#include <sstream>

#include "tests/e2e/dem.h"
#include "tests/e2e/served.h"

namespace tests::e2e {
namespace {

constexpr const char* kTriangles = "/export?f=geojson&crs=EPSG:32725";

class SourceTest : public ServedTest {
 protected:
  SourceTest() { start(); }

  Json triangles(const std::string& tin) const { return served_->get("/tins/" + tin + kTriangles); }
  std::string digest(const std::string& tin) const { return served_->get("/tins/" + tin).at("digest"); }

  /// Every sample of the DEM within the tolerance, and the report agrees with the judge.
  void expect_kept(const Dem& dem, const std::string& tin, const Json& result, double tolerance) const {
    const Misses misses = compare(dem, triangles(tin), tolerance);
    EXPECT_EQ(misses.uncovered, 0U);
    EXPECT_EQ(misses.beyond, 0U) << misses.largest;
    EXPECT_NEAR(misses.largest, result.at("maxError").get<double>(), 1e-9);
    EXPECT_EQ(result.at("certifiedAgainst"), "original samples");
    EXPECT_EQ(result.at("samples"), dem.valid_count());
    std::uint64_t counted = 0;
    for (const Json& count : result.at("histogram").at("counts")) counted += count.get<std::uint64_t>();
    EXPECT_EQ(counted, dem.valid_count());
    EXPECT_LE(result.at("rmse"), result.at("maxError"));
  }

  /// The sample that the report names is that of the DEM.
  static void expect_worst_is_a_sample(const Dem& dem, const Json& result) {
    const Json& sample = result.at("maxErrorSample");
    const int column = sample.at("column"), row = sample.at("row");
    EXPECT_EQ(sample.at("z"), dem.value(column, row));
    EXPECT_NEAR(result.at("maxErrorAt").at(0).get<double>(), dem.x(column), 1e-6);
    EXPECT_NEAR(result.at("maxErrorAt").at(1).get<double>(), dem.y(row), 1e-6);
  }
};

TEST_F(SourceTest, ASecondSimplificationAfterARestartIsCertifiedAgainstTheOriginalSamples) {
  const Dem dem(sample_file("olinda"));
  ASSERT_EQ(served_->upload("?id=dem", dem.file).status, 201);
  expect_kept(dem, "dem", served_->simplify({{"tin", "dem"}, {"tolerance", 5}}), 5);
  ASSERT_EQ(served_->stop(), 0);
  start();
  const Json coarse = served_->simplify({{"tin", "dem"}, {"tolerance", 10}});
  expect_kept(dem, "dem", coarse, 10);
  expect_worst_is_a_sample(dem, coarse);
  served_->kill();
  start();
  // Samples that went come back where a tighter tolerance asks for them.
  const Json fine = served_->simplify({{"tin", "dem"}, {"tolerance", 2}});
  expect_kept(dem, "dem", fine, 2);
  EXPECT_GT(fine.at("verticesAfter"), coarse.at("verticesAfter"));
  // What comes out depends on the samples, not on what was done to them before.
  ASSERT_EQ(served_->upload("?id=again", dem.file).status, 201);
  served_->simplify({{"tin", "again"}, {"tolerance", 2}});
  EXPECT_EQ(digest("again"), digest("dem"));
}

TEST_F(SourceTest, ACopyHasTheSourceTooAndKeepsItWhenTheOtherIsGone) {
  const Dem dem(sample_file("olinda"));
  ASSERT_EQ(served_->upload("?id=dem", dem.file).status, 201);
  served_->simplify({{"tin", "dem"}, {"tolerance", 20}, {"as", "copy"}});
  ASSERT_EQ(served_->http().remove("/tins/dem").status, 204);
  ASSERT_EQ(served_->stop(), 0);
  start();
  expect_kept(dem, "copy", served_->simplify({{"tin", "copy"}, {"tolerance", 4}}), 4);
}

TEST_F(SourceTest, AStraightImportEqualsASimplificationOfTheWhole) {
  const Dem dem(sample_file("olinda"));
  const RawAnswer made = served_->upload("?id=straight&tolerance=5&effort=fast", dem.file);
  ASSERT_EQ(made.status, 201) << made.body;
  const Misses misses = compare(dem, triangles("straight"), 5);
  EXPECT_EQ(misses.beyond + misses.uncovered + misses.strangers, 0U);
  ASSERT_EQ(served_->upload("?id=whole", dem.file).status, 201);
  served_->simplify({{"tin", "whole"}, {"tolerance", 5}, {"effort", "fast"}});
  EXPECT_EQ(digest("straight"), digest("whole"));
  expect_kept(dem, "straight", served_->simplify({{"tin", "straight"}, {"tolerance", 2}}), 2);
  for (const char* query : {"?tolerance=-1", "?tolerance=x", "?effort=fast", "?tolerance=1&effort=most",
                            "?tolerance=1&effort=best", "?elevations=fit", "?tolerance=1&elevations=any",
                            "?keepFlat=true", "?against=surface", "?tolerance=1&keepFlat=0",
                            "?tolerance=1&keepFlat=yes", "?tolerance=1&against=points"}) {
    const RawAnswer refused = served_->upload(query, dem.file);
    EXPECT_TRUE(refused.status == 400 || refused.status == 422) << query << refused.status;
  }
}

TEST_F(SourceTest, WherePeopleEditedTheyHaveTheLastWordAndElsewhereTheOriginal) {
  Dem dem(sample_file("olinda"));
  ASSERT_EQ(served_->upload("?id=dem", dem.file).status, 201);
  served_->simplify({{"tin", "dem"}, {"tolerance", 10}});
  const int column = dem.width / 3, row = dem.height / 2;
  const double z = dem.value(column, row) + 300;
  const Json added = served_->edit(
      "dem", Json::array({{{"op", "insert"}, {"x", dem.x(column)}, {"y", dem.y(row)}, {"z", z}}}));
  // The truth by the words of the rule: the vertex, and no sample strictly inside its star.
  const Json id = added.at("results").at(0).at("id");
  Json star = triangles("dem");
  auto& features = star.at("features");
  for (std::size_t i = features.size(); i-- > 0;) {
    const auto& corners = features[i].at("properties").at("vertices");
    if (std::find(corners.begin(), corners.end(), id) == corners.end()) features.erase(i);
  }
  ASSERT_GE(features.size(), 3U);
  const std::size_t all = dem.valid_count();
  if (!dem.nodata) dem.nodata = -99999;
  const auto inside = strictly_inside(dem, star);
  ASSERT_GT(inside.size(), 5U);
  for (const auto& [c, r] : inside) dem.values[static_cast<std::size_t>(r) * dem.width + c] = *dem.nodata;
  dem.values[static_cast<std::size_t>(row) * dem.width + column] = z;
  served_->kill();
  start();
  for (const int tolerance : {20, 4}) {
    const Json result = served_->simplify({{"tin", "dem"}, {"tolerance", tolerance}});
    expect_kept(dem, "dem", result, tolerance);
    EXPECT_EQ(result.at("samplesOutOfForce"), all - dem.valid_count() + 1) << "and the one under the vertex";
  }
}

TEST_F(SourceTest, AnEditThatIsUndoneHasNeverBeen) {
  const Dem dem(sample_file("olinda"));
  ASSERT_EQ(served_->upload("?id=dem", dem.file).status, 201);
  served_->simplify({{"tin", "dem"}, {"tolerance", 10}});
  const double x = dem.x(dem.width / 3), y = dem.y(dem.height / 2);
  const Json added = served_->edit("dem", Json::array({{{"op", "insert"}, {"x", x}, {"y", y}, {"z", 300}}}));
  const Json raised = served_->edit(
      "dem", Json::array({{{"op", "set-z"}, {"id", added.at("results").at(0).at("id")}, {"z", 400}}}));
  const auto revert = [&](const Json& revision) {
    const auto answer = served_->http().post_json("/tins/dem/revisions/" + revision.dump() + "/revert", "");
    ASSERT_EQ(answer.status, 200) << answer.body;
  };
  revert(raised.at("revision"));
  EXPECT_GT(served_->simplify({{"tin", "dem"}, {"tolerance", 9}, {"as", "one"}}).at("samplesOutOfForce"), 0)
      << "the vertex still stands";
  revert(added.at("revision"));
  served_->kill();
  start();
  for (const int tolerance : {10, 3}) {
    const Json result = served_->simplify({{"tin", "dem"}, {"tolerance", tolerance}});
    expect_kept(dem, "dem", result, tolerance);
    EXPECT_EQ(result.at("samplesOutOfForce"), 0);
  }
}

TEST_F(SourceTest, PointsAreASourceToo) {
  Dem dem(sample_file("olinda"));
  std::ostringstream text;
  text.precision(17);
  text << "x,y,z\n";
  for (int row = 0; row < dem.height; ++row) {
    for (int column = 0; column < dem.width; ++column) {
      if (dem.valid(column, row))
        text << dem.x(column) << ',' << dem.y(row) << ',' << dem.value(column, row) << '\n';
    }
  }
  const std::string file = folder_.path() / "points.csv";
  std::ofstream(file) << text.str();
  ASSERT_EQ(served_->upload("?id=points&crs=EPSG:32725&format=csv", file).status, 201);
  ASSERT_EQ(served_->upload("?id=straight&crs=EPSG:32725&format=csv&tolerance=10", file).status, 201);
  served_->simplify({{"tin", "points"}, {"tolerance", 10}});
  EXPECT_EQ(digest("straight"), digest("points"));
  ASSERT_EQ(served_->stop(), 0);
  start();
  for (const char* tin : {"points", "straight"}) {
    const Json result = served_->simplify({{"tin", tin}, {"tolerance", 3}});
    expect_kept(dem, tin, result, 3);
    EXPECT_TRUE(result.at("maxErrorSample").contains("index"));
  }
}

TEST_F(SourceTest, VerticesOfJsonAreASourceAndThoseOfEditsStaySamples) {
  Json vertices = Json::array(), ops = Json::array();
  for (int i = 0; i < 400; ++i) {
    const double x = i % 20, y = i / 20, z = std::sin(x / 3) * 5 + y / 4;
    vertices.push_back({x, y, z});
    ops.push_back({{"op", "insert"}, {"x", x}, {"y", y}, {"z", z}});
  }
  ASSERT_EQ(served_->http().post_json("/tins", Json{{"id", "json"}, {"vertices", vertices}}.dump()).status,
            201);
  ASSERT_EQ(served_->http().post_json("/tins", R"({"id":"edits","origin":[0,0]})").status, 201);
  served_->edit("edits", ops);
  for (const char* tin : {"json", "edits"}) {
    const Json first = served_->simplify({{"tin", tin}, {"tolerance", 2}});
    EXPECT_LT(first.at("verticesAfter"), 200);
  }
  served_->kill();
  start();
  for (const char* tin : {"json", "edits"}) {
    const Json second = served_->simplify({{"tin", tin}, {"tolerance", 0}});
    EXPECT_EQ(second.at("samples"), 400) << tin;
    EXPECT_EQ(second.at("maxError"), 0);
    EXPECT_EQ(second.at("certifiedAgainst"), tin == std::string("json") ? "original samples" : "vertices");
    const Json positions = [&] {
      Json out = Json::array();
      for (const Json& v : vertices) out.push_back({v.at(0), v.at(1)});
      return out;
    }();
    const Json z = Json::parse(served_->http()
                                   .post_json(std::string("/tins/") + tin + "/elevation",
                                              Json{{"positions", positions}}.dump())
                                   .body)
                       .at("z");
    for (std::size_t i = 0; i < 400; ++i) EXPECT_NEAR(z.at(i), vertices.at(i).at(2), 1e-9) << tin << i;
  }
}

TEST_F(SourceTest, WhatIsProtectedStays) {
  const Dem dem(sample_file("olinda"));
  ASSERT_EQ(served_->upload("?id=dem", dem.file).status, 201);
  const auto corner = [&](int column, int row) { return Json::array({dem.x(column) - 1, dem.y(row) + 1}); };
  // A square of 10 x 10 pixels, two vertices by name, and all of the outline.
  const Json square = {{"type", "Polygon"},
                       {"coordinates", {{corner(20, 30), corner(30, 30), corner(30, 40), corner(20, 40)}}}};
  const Json result = served_->simplify(
      {{"tin", "dem"}, {"tolerance", 20}, {"effort", "fast"}, {"protect", {5000, "border", square, 7777}}});
  expect_kept(dem, "dem", result, 20);
  const Json vertices = served_->get("/tins/dem/export?f=geojson&collection=vertices&crs=EPSG:32725");
  int inside = 0, border = 0, named = 0;
  for (const Json& feature : vertices.at("features")) {
    const Json& at = feature.at("geometry").at("coordinates");
    const int column =
        static_cast<int>(std::lround((at.at(0).get<double>() - dem.x(0)) / dem.geotransform[1]));
    const int row = static_cast<int>(std::lround((at.at(1).get<double>() - dem.y(0)) / dem.geotransform[5]));
    inside += column >= 20 && column < 30 && row >= 30 && row < 40;
    border += column == 0 || row == 0 || column == dem.width - 1 || row == dem.height - 1;
    named += feature.at("id") == 5000 || feature.at("id") == 7777;
  }
  EXPECT_EQ(inside, 100);
  EXPECT_EQ(border, 2 * (dem.width + dem.height) - 4);
  EXPECT_EQ(named, 2);
  EXPECT_LT(vertices.at("features").size(), 1000U) << "the rest is thinned";
  const RawAnswer unknown = served_->http().post_json(
      "/processes/simplify/execution", R"({"inputs":{"tin":"dem","tolerance":1,"protect":[1,999999]}})");
  EXPECT_EQ(unknown.status, 422);
  EXPECT_NE(unknown.body.find("/inputs/protect/1"), std::string::npos) << unknown.body;
  const RawAnswer beyond = served_->http().post_json(
      "/processes/simplify/execution",
      R"({"inputs":{"tin":"dem","tolerance":1,"protect":[{"type":"Polygon","coordinates":[[[0,0],[1e9,0],[0,1e9]]]}]}})");
  EXPECT_EQ(beyond.status, 422) << beyond.body;
  EXPECT_NE(beyond.body.find("/inputs/protect"), std::string::npos) << beyond.body;
}

TEST_F(SourceTest, FittedElevationsLandAreCertifiedAndCanBeUndone) {
  const Dem dem(sample_file("olinda"));
  ASSERT_EQ(served_->upload("?id=dem", dem.file).status, 201);
  const std::string whole = digest("dem");
  const Json own = served_->simplify({{"tin", "dem"}, {"tolerance", 6}, {"as", "own"}});
  const Json fit = served_->simplify({{"tin", "dem"}, {"tolerance", 6}, {"elevations", "fit"}});
  expect_kept(dem, "dem", fit, 6);
  EXPECT_LT(fit.at("verticesAfter"), own.at("verticesAfter"));
  const std::string fitted = digest("dem");
  served_->kill();
  start();
  EXPECT_EQ(digest("dem"), fitted);
  const auto revert = [&](const Json& result) {
    const std::string revision = std::to_string(result.at("revision").get<int>());
    const RawAnswer undone = served_->http().post_json("/tins/dem/revisions/" + revision + "/revert", "{}");
    EXPECT_EQ(undone.status, 200) << undone.body;
  };
  // Once more over the fitted ones, and then both taken back.
  const Json finer = served_->simplify({{"tin", "dem"}, {"tolerance", 2}, {"elevations", "fit"}});
  expect_kept(dem, "dem", finer, 2);
  revert(finer);
  EXPECT_EQ(digest("dem"), fitted);
  revert(fit);
  EXPECT_EQ(digest("dem"), whole);
  expect_kept(dem, "dem", served_->simplify({{"tin", "dem"}, {"tolerance", 3}}), 3);
  // By the straight way, too.
  ASSERT_EQ(served_->upload("?id=straight&tolerance=6&elevations=fit", dem.file).status, 201);
  const Misses misses = compare(dem, triangles("straight"), 6);
  EXPECT_EQ(misses.beyond + misses.uncovered, 0U);
  EXPECT_EQ(digest("straight"), fitted);
}

TEST_F(SourceTest, APersonsVertexThatWasFittedStaysASampleWithItsOwnElevation) {
  const Dem dem(sample_file("olinda"));
  ASSERT_EQ(served_->upload("?id=dem", dem.file).status, 201);
  const double x = dem.x(40) + 3, y = dem.y(50) + 5, z = dem.value(40, 50) + 200;
  served_->edit("dem", Json::array({{{"op", "insert"}, {"x", x}, {"y", y}, {"z", z}}}));
  for (const int tolerance : {30, 8, 20}) {
    served_->simplify({{"tin", "dem"}, {"tolerance", tolerance}, {"elevations", "fit"}});
    const Json at = served_->get("/tins/dem/elevation?x=" + std::to_string(x) + "&y=" + std::to_string(y));
    EXPECT_NEAR(at.at("z").get<double>(), z, tolerance + 1e-6);
  }
}

TEST_F(SourceTest, APlateauStaysFlatAndASurfaceIsKept) {
  const std::string file = folder_.path() / "lake.asc";
  std::ofstream out(file);
  out << "ncols 60\nnrows 50\nxllcorner 500000\nyllcorner 5000000\ncellsize 10\n";
  for (int i = 0; i < 60 * 50; ++i) {
    const int column = i % 60, row = i / 60;
    const bool water = std::hypot(column - 30, row - 25) < 12;
    out << (water ? 100 : 100 + std::lround(20 + 15 * std::sin(column * 0.4) * std::cos(row * 0.3)))
        << (column == 59 ? '\n' : ' ');
  }
  out.close();
  ASSERT_EQ(served_->upload("?id=lake&crs=EPSG:32725", file).status, 201);
  const Json flat = served_->simplify({{"tin", "lake"}, {"tolerance", 12}, {"keepFlat", true}, {"as", "flat"}});
  EXPECT_GT(flat.at("levelSamples"), 250);
  for (const double away : {0.0, 40.0, 70.0, 95.0}) {
    const Json at = served_->get("/tins/flat/elevation?x=" + std::to_string(500305 + away) + "&y=5000255");
    EXPECT_EQ(at.at("z"), 100) << away;
  }
  const Json surface = served_->simplify({{"tin", "lake"}, {"tolerance", 4}, {"against", "surface"}, {"as", "surface"}});
  EXPECT_GT(surface.at("surfaceCrossings"), 100);
  EXPECT_LE(surface.at("maxError"), 4);
  // Between the pixels, where samples alone say nothing.
  for (int i = 0; i < 400; ++i) {
    const std::string at = "/elevation?x=" + std::to_string(500008 + (i * 37 % 580)) + ".3&y=" +
                           std::to_string(5000009 + (i * 53 % 480)) + ".7";
    const double before = served_->get("/tins/lake" + at).at("z"), after = served_->get("/tins/surface" + at).at("z");
    EXPECT_NEAR(before, after, 4 + 1e-9) << at;
  }
  // By the straight way, too.
  for (const auto& [query, as] : {std::pair("tolerance=12&keepFlat=true", "flat"),
                                  std::pair("tolerance=4&against=surface", "surface")}) {
    const std::string id = std::string("straight-") + as;
    ASSERT_EQ(served_->upload("?id=" + id + "&crs=EPSG:32725&" + query, file).status, 201);
    EXPECT_EQ(digest(id), digest(as)) << query;
  }
}

TEST_F(SourceTest, ATimeBudgetGivesACertifiedResult) {
  const Dem dem(sample_file("olinda"));
  ASSERT_EQ(served_->upload("?id=dem", dem.file).status, 201);
  const Json result =
      served_->simplify({{"tin", "dem"}, {"tolerance", 3}, {"effort", "best"}, {"maxSeconds", 0.5}});
  expect_kept(dem, "dem", result, 3);
  EXPECT_LT(result.at("seconds"), 10);
  EXPECT_TRUE(result.at("outOfTime"));
}

}  // namespace
}  // namespace tests::e2e
