// Slopes, profiles, contours, volumes and sight lines over the wire: their numbers, limits and units, and
// that each process says what its resource says.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/contract/test_server.h"

namespace tests::contract {
namespace {

/// A roof over 100 x 100 m: z = 10 + x / 2 up to x = 50, then down again.
constexpr const char* kRoof =
    R"({"id":"roof","crs":"EPSG:32617","verticalUnit":"metre","origin":[500000,4500000],
  "vertices":[[500000,4500000,10],[500050,4500000,35],[500100,4500000,10],
              [500000,4500100,10],[500050,4500100,35],[500100,4500100,10]]})";

class SurfaceTest : public testing::Test {
 protected:
  SurfaceTest() : server_([](server::Config& config) { adjust(config); }) {
    EXPECT_EQ(server_.post_json("/tins", kRoof).status, 201);
  }
  static void adjust(server::Config& config) {
    config.limits.polygon_positions = 8;
    config.limits.contour_levels = 5;
    config.limits.answer_positions = 40;
    config.limits.positions_per_request = 6;
  }

  Json get(const std::string& target) {
    const RawAnswer answer = server_.get(target);
    EXPECT_EQ(answer.status, 200) << target << '\n' << answer.body;
    EXPECT_FALSE(answer.header("etag").empty());
    return Json::parse(answer.body);
  }
  RawAnswer execute(const std::string& process, const Json& inputs) {
    return server_.post_json("/processes/" + process + "/execution", Json{{"inputs", inputs}}.dump());
  }
  Json result(const std::string& process, const Json& inputs) {
    const RawAnswer answer = execute(process, inputs);
    EXPECT_EQ(answer.status, 200) << answer.body;
    return Json::parse(answer.body);
  }
  void refuse(const RawAnswer& answer, int status, const std::string& kind, const std::string& where) {
    EXPECT_EQ(answer.status, status) << answer.body;
    EXPECT_EQ(slug(answer), kind);
    EXPECT_EQ(Json::parse(answer.body).value("where", ""), where) << answer.body;
  }

  TestServer server_;
};

TEST_F(SurfaceTest, SlopeAndAspectOfARoof) {
  const Json east = get("/tins/roof/slope?x=500075&y=4500050"),
             west = get("/tins/roof/slope?x=500020&y=4500050");
  EXPECT_NEAR(east.at("slope").get<double>(), std::atan(0.5) * 180 / std::numbers::pi, 1e-9);
  EXPECT_EQ(east.at("aspect"), 90);
  EXPECT_EQ(west.at("aspect"), 270);
  EXPECT_EQ(west.at("unit"), "degree");
  EXPECT_EQ(west.at("revision"), 1);
  EXPECT_TRUE(get("/tins/roof/slope?x=0&y=0").at("slope").is_null());
  const Json many = Json::parse(
      server_.post_json("/tins/roof/slope", R"({"positions":[[500075,4500050],[0,0],[500020,4500050]]})")
          .body);
  EXPECT_EQ(many.at("aspect"), Json({90, nullptr, 270}));
}

TEST_F(SurfaceTest, ProfileAcrossARoof) {
  const Json profile = get("/tins/roof/profile?coords=499990,4500025,500110,4500025");
  EXPECT_EQ(profile.at("length"), 120);
  EXPECT_EQ(profile.at("lengthUnit"), "m");
  EXPECT_EQ(profile.at("verticalUnit"), "metre");
  const auto& z = profile.at("z");
  const auto& d = profile.at("distance");
  EXPECT_TRUE(z.front().is_null());
  EXPECT_TRUE(z.back().is_null());
  double highest = 0, at = 0;
  for (std::size_t i = 0; i < z.size(); ++i) {
    if (z[i].is_null() || z[i] <= highest) continue;
    highest = z[i];
    at = d[i];
  }
  EXPECT_EQ(highest, 35);
  EXPECT_EQ(at, 60);
  EXPECT_EQ(result("profile", {{"tin", "roof"}, {"positions", {{499990, 4500025}, {500110, 4500025}}}}),
            profile);
  const Json posted = Json::parse(
      server_.post_json("/tins/roof/profile", R"({"positions":[[499990,4500025],[500110,4500025]]})").body);
  EXPECT_EQ(posted, profile);
}

TEST_F(SurfaceTest, ProfilesTakeAndGivePositionsInTheCrsAskedFor) {
  const Json profile = get("/tins/roof/profile?coords=-81,40.65053,-80.999,40.65053&crs=EPSG:4326");
  EXPECT_NEAR(profile.at("positions").front().at(0).get<double>(), -81, 1e-7);
  EXPECT_NEAR(profile.at("positions").back().at(0).get<double>(), -80.999, 1e-7);
  EXPECT_NEAR(profile.at("length").get<double>(), 84.5, 0.5) << "metres of the map, not degrees";
}

TEST_F(SurfaceTest, LineOfSightOverARoof) {
  const std::string path = "/tins/roof/line-of-sight?observer=500000,4500050&target=500100,4500050";
  const Json blocked = get(path + "&observer-height=5&target-height=5");
  EXPECT_EQ(blocked.at("visible"), false);
  EXPECT_NEAR(blocked.at("closest").at("clearance").get<double>(), -20, 1e-9);
  EXPECT_NEAR(blocked.at("closest").at("position").at(0).get<double>(), 500050, 1e-6);
  EXPECT_NEAR(blocked.at("blockedAt").at("distance").get<double>(), 10, 1e-5);
  const Json seen = get(path + "&observer-height=26&target-height=25");
  EXPECT_EQ(seen.at("visible"), true);
  EXPECT_TRUE(seen.at("blockedAt").is_null());
  EXPECT_EQ(result("line-of-sight", {{"tin", "roof"},
                                     {"observer", {500000, 4500050}},
                                     {"target", {500100, 4500050}},
                                     {"observerHeight", 26},
                                     {"targetHeight", 25}}),
            seen);
  refuse(server_.get("/tins/roof/line-of-sight?observer=500000,4500050&target=0,0"), 422, "outside-lattice",
         "query:target");
  refuse(server_.get("/tins/roof/line-of-sight?observer=500000,4500050&target=500100.5,4500050"), 422,
         "invalid-value", "query:target");
  refuse(server_.get(path + "&refraction=1"), 422, "invalid-value", "query:refraction");
  refuse(server_.get(path + "&curvature=yes"), 422, "invalid-value", "query:curvature");
}

TEST_F(SurfaceTest, ContoursOfARoof) {
  const RawAnswer answer = server_.get("/tins/roof/contours?interval=10&base=5&crs=EPSG:32617");
  EXPECT_EQ(answer.header("content-type"), "application/geo+json");
  const Json contours = Json::parse(answer.body);
  ASSERT_EQ(contours.at("features").size(), 6U) << "15, 25 and 35 on both sides of the ridge";
  const Json& first = contours.at("features")[0];
  EXPECT_EQ(first.at("properties").at("elevation"), 15);
  EXPECT_EQ(first.at("properties").at("closed"), false);
  for (const Json& p : first.at("geometry").at("coordinates")) {
    EXPECT_TRUE(p[0] == 500010 || p[0] == 500090);
    EXPECT_EQ(p[2], 15);
  }
  EXPECT_EQ(result("contours", {{"tin", "roof"}, {"interval", 10}, {"base", 5}, {"crs", "EPSG:32617"}}),
            contours);
  const Json degrees = get("/tins/roof/contours?levels=20");
  EXPECT_NEAR(degrees.at("features")[0].at("geometry").at("coordinates")[0][0].get<double>(), -81, 0.01);
  const Json cut = get("/tins/roof/contours?levels=20&crs=EPSG:32617&bbox=500000,4500000,500050,4500040");
  ASSERT_EQ(cut.at("features").size(), 1U);
  for (const Json& p : cut.at("features")[0].at("geometry").at("coordinates")) EXPECT_LE(p[1], 4500040);
  refuse(server_.get("/tins/roof/contours?interval=1&levels=3"), 422, "invalid-value", "query:interval");
  refuse(server_.get("/tins/roof/contours?levels=3,2"), 422, "invalid-value", "query:levels");
  refuse(execute("contours", {{"tin", "roof"}, {"interval", 0}}), 422, "invalid-value", "/inputs/interval");
}

TEST_F(SurfaceTest, VolumesOfARoof) {
  // Above 10 a prism of 100 x 25 / 2 x 100; above 22.5 a quarter of it.
  const Json all = get("/tins/roof/volume?level=10");
  EXPECT_NEAR(all.at("volumeAbove").get<double>(), 125'000, 1e-4);
  EXPECT_EQ(all.at("volumeBelow"), 0);
  EXPECT_EQ(all.at("volumeUnit"), "m3");
  EXPECT_EQ(all.at("areaUnit"), "m2");
  const Json half = get("/tins/roof/volume?level=22.5");
  EXPECT_NEAR(half.at("volumeAbove").get<double>(), 31'250, 1e-4);
  EXPECT_NEAR(half.at("areaBelow").get<double>(), 5000, 1e-6);
  const Json west =
      get("/tins/roof/volume?level=10&polygon=500000,4500000,500050,4500000,500050,4500100,500000,4500100");
  EXPECT_NEAR(west.at("volumeAbove").get<double>(), 62'500, 1e-4);
  EXPECT_EQ(get("/tins/roof/volume?level=10&bbox=500000,4500000,500050,4500100"), west);
  EXPECT_EQ(
      result("volume",
             {{"tin", "roof"},
              {"level", 10},
              {"polygon", {{500000, 4500000}, {500050, 4500000}, {500050, 4500100}, {500000, 4500100}}}}),
      west);
  // A hole takes its part away.
  const Json holed =
      result("volume", {{"tin", "roof"},
                        {"level", 0},
                        {"polygon",
                         {{{500000, 4500000}, {500050, 4500000}, {500050, 4500100}, {500000, 4500100}},
                          {{500010, 4500010}, {500020, 4500010}, {500020, 4500020}}}}});
  EXPECT_NEAR(holed.at("areaAbove").get<double>(), 4950, 1e-6);
  refuse(server_.get(
             "/tins/roof/volume?level=1&polygon=500000,4500000,500050,4500050,500050,4500000,500000,4500050"),
         422, "invalid-value", "query:polygon");
  const Json area = get("/tins/roof/surface-area");
  EXPECT_NEAR(area.at("planarArea").get<double>(), 10'000, 1e-6);
  EXPECT_NEAR(area.at("surfaceArea").get<double>(), 10'000 * std::sqrt(1.25), 1e-6);
  EXPECT_EQ(result("surface-area", {{"tin", "roof"}}), area);
}

TEST_F(SurfaceTest, CutAndFillAfterAnEdit) {
  ASSERT_EQ(
      server_
          .post_json(
              "/tins",
              R"({"id":"plan","crs":"EPSG:32617","vertices":[[500000,4500000,20],[500100,4500000,20],[500100,4500100,20],[500000,4500100,20]]})")
          .status,
      201);
  const Json inputs = {{"tin", "roof"}, {"after", "plan"}};
  // The roof stands above 20 for 60 of its 100 m: 60 x 15 / 2 x 100 to cut, and two wedges of 20 x 10 / 2 x
  // 100 to fill.
  const Json before = result("cut-fill", inputs);
  EXPECT_NEAR(before.at("cutVolume").get<double>(), 45'000, 1e-4);
  EXPECT_NEAR(before.at("fillVolume").get<double>(), 20'000, 1e-4);
  EXPECT_EQ(before.at("afterRevision"), 1);
  ASSERT_EQ(
      server_
          .post_json(
              "/tins/plan/edits",
              R"({"ops":[{"op":"set-z","id":1,"z":0},{"op":"set-z","id":2,"z":0},{"op":"set-z","id":3,"z":0},{"op":"set-z","id":4,"z":0}]})")
          .status,
      200);
  const Json after = result("cut-fill", inputs);
  EXPECT_NEAR(after.at("cutVolume").get<double>(), 125'000 + 100'000, 1e-4);
  EXPECT_EQ(after.at("fillVolume"), 0);
  EXPECT_EQ(after.at("afterRevision"), 2);
  refuse(execute("cut-fill", {{"tin", "roof"}, {"after", "none"}}), 404, "not-found", "/inputs/after");
  ASSERT_EQ(server_.post_json("/tins", R"({"id":"elsewhere"})").status, 201);
  refuse(execute("cut-fill", {{"tin", "roof"}, {"after", "elsewhere"}}), 422, "invalid-value",
         "/inputs/after");
}

TEST_F(SurfaceTest, NaturalNeighboursRoundTheSurfaceOff) {
  const std::string at = "/tins/roof/elevation?x=500040&y=4500040";
  const Json linear = get(at), natural = get(at + "&interpolation=natural-neighbour");
  EXPECT_NEAR(linear.at("z").get<double>(), 30, 1e-9);
  EXPECT_LT(natural.at("z").get<double>(), 30);
  EXPECT_GT(natural.at("z").get<double>(), 10);
  const Json many =
      Json::parse(server_
                      .post_json("/tins/roof/elevation",
                                 R"({"positions":[[500040,4500040]],"interpolation":"natural-neighbour"})")
                      .body);
  EXPECT_EQ(many.at("z")[0], natural.at("z"));
  refuse(server_.get(at + "&interpolation=cubic"), 422, "invalid-value", "query:interpolation");
}

TEST_F(SurfaceTest, LimitsHoldAndNotBefore) {
  const auto ring = [](int count) {
    std::string text;
    for (int i = 0; i < count; ++i) {
      const double angle = 2 * std::numbers::pi * i / count;
      text += (i > 0 ? "," : "") + std::to_string(500050 + 20 * std::cos(angle)) + "," +
              std::to_string(4500050 + 20 * std::sin(angle));
    }
    return text;
  };
  EXPECT_EQ(server_.get("/tins/roof/volume?level=1&polygon=" + ring(8)).status, 200);
  refuse(server_.get("/tins/roof/volume?level=1&polygon=" + ring(9)), 413, "too-large", "query:polygon");
  EXPECT_EQ(server_.get("/tins/roof/contours?interval=5&base=10.5").status, 200) << "five levels";
  refuse(server_.get("/tins/roof/contours?interval=5"), 413, "too-large", "query:interval");
  EXPECT_EQ(server_.get("/tins/roof/contours?levels=11,12,13,14,15").status, 200);
  refuse(server_.get("/tins/roof/contours?levels=11,12,13,14,15,16"), 413, "too-large", "query:levels");
  EXPECT_EQ(server_.get("/tins/roof/profile?coords=" + ring(6)).status, 200);
  refuse(server_.get("/tins/roof/profile?coords=" + ring(7)), 413, "too-large", "query:coords");
  Json positions = Json::array();
  for (int i = 0; i < 6; ++i) positions.push_back({500000 + 100 * (i % 2), 4500000 + 13 * i});
  const RawAnswer long_profile = execute("profile", {{"tin", "roof"}, {"positions", positions}});
  EXPECT_EQ(long_profile.status, 200) << long_profile.body;
}

TEST_F(SurfaceTest, TinsWithoutACrsCountInUnitsNobodyKnows) {
  ASSERT_EQ(server_.post_json("/tins", R"({"id":"local","vertices":[[0,0,1],[9,0,2],[0,9,3]]})").status, 201);
  EXPECT_EQ(get("/tins/local/volume?level=0").at("volumeUnit"), "unit3");
  EXPECT_EQ(get("/tins/local/profile?coords=0,0,3,3").at("lengthUnit"), "unit");
  EXPECT_TRUE(get("/tins/local/profile?coords=0,0,3,3").at("verticalUnit").is_null());
  EXPECT_EQ(get("/tins/local/contours?interval=1").at("features").size(), 2U);
}

TEST_F(SurfaceTest, RastersShowSlopeAspectAndShade) {
  for (const std::string layer : {"slope", "aspect", "hillshade", "elevation"}) {
    const RawAnswer answer = server_.get("/tins/roof/export?cell-size=1&layer=" + layer);
    EXPECT_EQ(answer.status, 200);
    EXPECT_EQ(answer.body.substr(0, 2), "II");
  }
  refuse(server_.get("/tins/roof/export?layer=soil"), 422, "invalid-value", "query:layer");
  refuse(server_.get("/tins/roof/export?azimuth=3"), 422, "invalid-value", "query:azimuth");
  refuse(server_.get("/tins/roof/export?layer=hillshade&altitude=91"), 422, "invalid-value",
         "query:altitude");
  refuse(server_.get("/tins/roof/export?layer=slope&interpolation=linear"), 422, "invalid-value",
         "query:interpolation");
  refuse(server_.get("/tins/roof/export?f=geojson&layer=slope"), 422, "invalid-value", "query:layer");
}

}  // namespace
}  // namespace tests::contract
