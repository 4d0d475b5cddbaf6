// OGC API EDR on a TIN's surface: what its queries answer, in which formats, and what the requirements say of
// bad ones.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/contract/test_server.h"

namespace tests::contract {
namespace {

// A plane over 100 m x 100 m near 81 W, 40.65 N: 10 m in the west, 20 m in the east.
constexpr const char* kPlane = R"({"id":"plane","crs":"EPSG:32617","verticalUnit":"metre",
  "vertices":[[500000,4500000,10],[500100,4500000,20],[500000,4500100,10],[500100,4500100,20]]})";
const std::string kSurface = "/tins/plane/collections/surface";
constexpr const char* kUtm = "&crs=EPSG:32617";

class EdrTest : public testing::Test {
 protected:
  EdrTest()
      : server_([](server::Config& config) {
          config.limits.positions_per_request = 100;
          config.limits.polygon_positions = 10;
          config.limits.answer_positions = 1000;
        }) {
    EXPECT_EQ(server_.post_json("/tins", kPlane).status, 201);
  }

  Json covjson(const std::string& target) {
    const RawAnswer answer = server_.get(kSurface + target);
    EXPECT_EQ(answer.status, 200) << target << "\n" << answer.body;
    EXPECT_EQ(answer.header("content-type"), "application/vnd.cov+json");
    return Json::parse(answer.body);
  }
  Json geojson(const std::string& target) {
    const RawAnswer answer = server_.get(kSurface + target + "&f=GeoJSON");
    EXPECT_EQ(answer.status, 200) << target << "\n" << answer.body;
    EXPECT_EQ(answer.header("content-type"), "application/geo+json");
    return Json::parse(answer.body);
  }
  static Json values(const Json& coverage, const std::string& parameter = "elevation") {
    const Json& range = coverage.at("ranges").at(parameter);
    std::size_t size = 1;
    for (const Json& length : range.at("shape")) size *= length.get<std::size_t>();
    EXPECT_EQ(range.at("values").size(), size);
    return range.at("values");
  }
  void expect_bad(const std::string& target, const std::string& where) {
    const RawAnswer answer = server_.get(kSurface + target);
    EXPECT_EQ(answer.status, 400) << target;
    if (answer.status == 400) {
      EXPECT_EQ(Json::parse(answer.body).value("where", ""), where) << answer.body;
    }
  }

  TestServer server_;
};

TEST_F(EdrTest, ThePositionOfAPoint) {
  const Json coverage = covjson(std::string("/position?coords=POINT(500025%204500050)") + kUtm);
  EXPECT_EQ(coverage.at("domain").at("domainType"), "Point");
  EXPECT_EQ(coverage.at("domain").at("axes").at("x").at("values"), Json({500025}));
  EXPECT_EQ(coverage.at("domain").at("referencing").at(0).at("system").at("id"),
            "http://www.opengis.net/def/crs/EPSG/0/32617");
  EXPECT_EQ(coverage.at("domain").at("referencing").at(0).at("system").at("type"), "ProjectedCRS");
  EXPECT_EQ(coverage.at("parameters").at("elevation").at("unit").at("symbol").at("value"), "m");
  EXPECT_EQ(values(coverage), Json({12.5}));
}

TEST_F(EdrTest, WithoutACrsCoordinatesAreLongitudeAndLatitude) {
  const Json coverage = covjson("/position?coords=POINT(-80.9995%2040.6513)");
  EXPECT_EQ(coverage.at("domain").at("referencing").at(0).at("system").at("id"),
            "http://www.opengis.net/def/crs/OGC/1.3/CRS84");
  EXPECT_NEAR(values(coverage).at(0).get<double>(), 14.23, 0.05);
  // EPSG:4326 has latitude first; x stays longitude in CoverageJSON, whose referencing says the order.
  const Json swapped = covjson("/position?coords=POINT(40.6513%20-80.9995)&crs=EPSG:4326");
  EXPECT_EQ(values(swapped), values(coverage));
  EXPECT_EQ(swapped.at("domain").at("referencing").at(0).at("coordinates"), Json({"y", "x"}));
  EXPECT_EQ(swapped.at("domain").at("axes"), coverage.at("domain").at("axes"));
  const Json features = geojson("/position?coords=POINT(40.6513%20-80.9995)&crs=EPSG:4326");
  EXPECT_EQ(features.at("features").at(0).at("geometry").at("coordinates").at(0), 40.6513);
  EXPECT_EQ(server_.get(kSurface + "/position?coords=POINT(40.6513%20-80.9995)&crs=EPSG:4326")
                .header("content-crs"),
            "<http://www.opengis.net/def/crs/EPSG/0/4326>");
}

TEST_F(EdrTest, ManyPositionsAreOneCoverage) {
  const std::string query =
      std::string("/position?coords=MULTIPOINT((500000%204500000),(500100%204500100),(499000%204500000))") +
      kUtm;
  const Json coverage = covjson(query);
  EXPECT_EQ(coverage.at("domain").at("domainType"), "MultiPoint");
  EXPECT_EQ(coverage.at("domain").at("axes").at("composite").at("values").at(1), Json({500100, 4500100}));
  EXPECT_EQ(values(coverage), Json({10, 20, nullptr})) << "null outside of the surface";
  const Json features = geojson(query).at("features");
  ASSERT_EQ(features.size(), 3u);
  EXPECT_EQ(features.at(1).at("geometry").at("coordinates"), Json({500100, 4500100, 20}));
  EXPECT_EQ(features.at(2).at("geometry").at("coordinates"), Json({499000, 4500000}));
  EXPECT_TRUE(features.at(2).at("properties").at("elevation").is_null());
}

TEST_F(EdrTest, ATrajectoryIsTheProfile) {
  const std::string line = "500025%204500010,500075%204500010";
  const Json coverage = covjson("/trajectory?coords=LINESTRING(" + line + ")" + kUtm);
  const Json profile =
      Json::parse(server_.get("/tins/plane/profile?coords=500025,4500010,500075,4500010").body);
  EXPECT_EQ(values(coverage), profile.at("z"));
  EXPECT_EQ(values(coverage, "distance"), profile.at("distance"));
  EXPECT_EQ(coverage.at("domain").at("axes").at("composite").at("values"), profile.at("positions"));
  EXPECT_NEAR(values(coverage, "distance").back().get<double>(), 50, 0.1);
  const Json only = covjson("/trajectory?coords=LINESTRING(" + line + ")&parameter-name=elevation" + kUtm);
  EXPECT_FALSE(only.at("ranges").contains("distance"));
  EXPECT_EQ(values(only), values(coverage));
  const Json far = covjson("/trajectory?coords=LINESTRING(" + line + ")&parameter-name=distance" + kUtm);
  EXPECT_FALSE(far.at("parameters").contains("elevation"));

  const Json several = covjson("/trajectory?coords=MULTILINESTRING((" + line +
                               "),(500010%204500020,500010%204500080))" + kUtm);
  EXPECT_EQ(several.at("type"), "CoverageCollection");
  ASSERT_EQ(several.at("coverages").size(), 2u);
  EXPECT_EQ(values(several.at("coverages").at(0)), values(coverage));
  EXPECT_EQ(values(several.at("coverages").at(1)).at(0), 11);
}

TEST_F(EdrTest, ATrajectoryOverTheEdgeHasTheStretchOfSurface) {
  const std::string query =
      std::string("/trajectory?coords=LINESTRING(499990%204500050,500110%204500050)") + kUtm;
  const Json z = values(covjson(query));
  EXPECT_TRUE(z.front().is_null());
  EXPECT_TRUE(z.back().is_null());
  const Json features = geojson(query).at("features");
  ASSERT_EQ(features.size(), 1u);
  const Json& feature = features.at(0);
  EXPECT_EQ(feature.at("geometry").at("type"), "LineString");
  EXPECT_EQ(feature.at("geometry").at("coordinates").front(), Json({500000, 4500050, 10}));
  EXPECT_EQ(feature.at("geometry").at("coordinates").back(), Json({500100, 4500050, 20}));
  EXPECT_EQ(feature.at("properties").at("elevation").size(), feature.at("geometry").at("coordinates").size());
  EXPECT_NEAR(feature.at("properties").at("distance").front().get<double>(), 10, 0.01)
      << "from the line's beginning";
}

TEST_F(EdrTest, ACubeIsAGridFromEndToEnd) {
  const Json coverage =
      covjson(std::string("/cube?bbox=500000,4500000,500100,4500100&resolution-x=3&resolution-y=2") + kUtm);
  EXPECT_EQ(coverage.at("domain").at("domainType"), "Grid");
  EXPECT_EQ(coverage.at("domain").at("axes").at("x"),
            Json({{"start", 500000}, {"stop", 500100}, {"num", 3}}));
  EXPECT_EQ(coverage.at("ranges").at("elevation").at("axisNames"), Json({"y", "x"}));
  EXPECT_EQ(values(coverage), Json({10, 15, 20, 10, 15, 20}));
  // Beyond the surface the box is cut.
  const Json wide =
      covjson(std::string("/cube?bbox=0,4500050,900000,9000000&resolution-x=2&resolution-y=1") + kUtm);
  EXPECT_EQ(wide.at("domain").at("axes").at("x").at("stop"), 500100);
  EXPECT_EQ(wide.at("domain").at("axes").at("y").at("values"), Json({4500075}))
      << "one row lies in the middle";
  EXPECT_EQ(values(wide), Json({10, 20}));
  const Json otherwise = covjson(std::string("/cube?bbox=500000,4500000,500100,4500100") + kUtm);
  EXPECT_EQ(otherwise.at("ranges").at("elevation").at("shape"), Json({17, 17}));
  const Json stored =
      covjson(std::string("/cube?bbox=500000,4500000,500100,4500100&resolution-x=0&resolution-y=0") + kUtm);
  EXPECT_EQ(stored.at("ranges").at("elevation").at("shape"), Json({3, 3})) << "as close as vertices lie";
  const Json lon_lat = covjson("/cube?bbox=-80.9999,40.6511,-80.9990,40.6515");
  EXPECT_EQ(lon_lat.at("domain").at("referencing").at(0).at("system").at("type"), "GeographicCRS");
  for (const Json& z : values(lon_lat)) EXPECT_TRUE(z.get<double>() >= 10 && z.get<double>() <= 20);
}

TEST_F(EdrTest, AnAreaIsTheGridWithinThePolygon) {
  // The half below the diagonal, with a hole in it, on a grid of 11 x 11.
  const std::string half = "(500000%204500000,500100%204500000,500100%204500100,500000%204500000)";
  const std::string hole =
      "(500055%204500015,500065%204500015,500065%204500025,500055%204500025,500055%204500015)";
  const std::string size = std::string("&resolution-x=11&resolution-y=11") + kUtm;
  const Json coverage = covjson("/area?coords=POLYGON(" + half + "," + hole + ")" + size);
  const Json z = values(coverage);
  for (int j = 0; j < 11; ++j) {
    for (int i = 0; i < 11; ++i) {
      if (i == j || j == 0 || i == 10) continue;  // on the boundary either is fine
      const Json& at = z.at(static_cast<std::size_t>(j * 11 + i));
      const bool inside = i > j && !(i == 6 && j == 2);
      EXPECT_EQ(at.is_null(), !inside) << i << ", " << j;
      if (inside) {
        EXPECT_NEAR(at.get<double>(), 10 + i, 1e-9);
      }
    }
  }
  const Json two =
      covjson("/area?coords=MULTIPOLYGON((" + half +
              "),((500000%204500050,500050%204500050,500000%204500100,500000%204500050)))" + size);
  EXPECT_EQ(values(two).at(6 * 11 + 1), 11) << "in the second polygon";
  EXPECT_EQ(values(two).at(2 * 11 + 6), 16) << "no hole now";
  std::size_t inside = 0;
  for (const Json& at : z) inside += at.is_null() ? 0 : 1;
  EXPECT_EQ(geojson("/area?coords=POLYGON(" + half + "," + hole + ")" + size).at("features").size(), inside);
}

TEST_F(EdrTest, WhereThereIsNothingTheAnswerIsEmpty) {
  for (const std::string target :
       {"/cube?bbox=10,10,11,11", "/area?coords=POLYGON((1%201,2%201,2%202,1%201))"}) {
    const RawAnswer answer = server_.get(kSurface + target);
    EXPECT_EQ(answer.status, 204) << target;
    EXPECT_TRUE(answer.body.empty());
  }
}

TEST_F(EdrTest, LevelsSelect) {
  const std::string grid = std::string("/cube?bbox=500000,4500000,500100,4500000&resolution-x=5") + kUtm;
  const Json all({10, 12.5, 15, 17.5, 20});
  EXPECT_EQ(values(covjson(grid)), all);
  EXPECT_EQ(values(covjson(grid + "&z=12/16")), Json({nullptr, 12.5, 15, nullptr, nullptr}));
  EXPECT_EQ(values(covjson(grid + "&z=20,12.5")), Json({nullptr, 12.5, nullptr, nullptr, 20}));
  EXPECT_EQ(values(covjson(grid + "&z=R3/10/5")), Json({10, nullptr, 15, nullptr, 20}));
  EXPECT_EQ(values(covjson(grid + "&z=15")), Json({nullptr, nullptr, 15, nullptr, nullptr}));
  EXPECT_EQ(geojson(grid + "&z=12/16").at("features").size(), 2u);
  const std::string box = std::string("/cube?bbox=500000,4500000,14,500100,4500000,18&resolution-x=5") + kUtm;
  EXPECT_EQ(values(covjson(box)), Json({nullptr, nullptr, 15, 17.5, nullptr}));
  EXPECT_EQ(values(covjson(box + "&z=10")), Json({10, nullptr, nullptr, nullptr, nullptr})) << "z wins";
  EXPECT_EQ(
      geojson(std::string("/position?coords=POINT(500025%204500050)&z=13/14") + kUtm).at("features").size(),
      0u);
}

TEST_F(EdrTest, BadQuestionsAre400) {
  for (const std::string target : {"/position", "/trajectory", "/area"}) {
    expect_bad(target, "query:coords");
    for (const char* coords :
         {"", "POINT", "POINT(1)", "POINT(1%202%203)", "POINT%20Z(1%202%203)", "POINT(1%20nan)",
          "POINT(1%202", "POINT(1%202))", "POINT%20EMPTY", "CIRCLE(1%202)", "LINESTRING(1%202)",
          "POINT(1%202,3%204)", "POLYGON((0%200,1%200,0%201))", "POLYGON((0%200,1%200,0%201,1%201))",
          "GEOMETRYCOLLECTION(POINT(1%202))"}) {
      expect_bad(target + "?coords=" + coords, "query:coords");
    }
  }
  expect_bad("/position?coords=LINESTRING(1%202,3%204)", "query:coords");
  expect_bad("/trajectory?coords=POINT(1%202)", "query:coords");
  expect_bad("/area?coords=MULTIPOINT(1%202,3%204)", "query:coords");
  expect_bad("/cube", "query:bbox");
  expect_bad("/cube?bbox=1,2,3", "query:bbox");
  expect_bad("/cube?bbox=170,-10,-170,10", "query:bbox");
  for (const char* z : {"", "x", "5/1", "1/", "R/1/2", "R0/1/2", "R2/1", "1,,2"})
    expect_bad(std::string("/cube?bbox=1,2,3,4&z=") + z, "query:z");
  expect_bad("/cube?bbox=1,2,3,4&resolution-x=-1", "query:resolution-x");
  expect_bad("/cube?bbox=1,2,3,4&f=netCDF", "query:f");
  expect_bad("/cube?bbox=1,2,3,4&crs=EPSG:2056", "query:crs");
  expect_bad("/cube?bbox=1,2,3,4&datetime=soon", "query:datetime");
  expect_bad("/cube?bbox=1,2,3,4&parameter-name=distance", "query:parameter-name");
  expect_bad("/cube?bbox=1,2,3,4&parameter-name=wind", "query:parameter-name");
  expect_bad("/cube?bbox=1,2,3,4&cords=1", "query:cords");
}

TEST_F(EdrTest, LimitsHold) {
  const auto points = [](int count) {
    std::string text = "MULTIPOINT(";
    for (int i = 0; i < count; ++i) text += (i == 0 ? "" : ",") + std::string("-81%2040.65");
    return text + ")";
  };
  EXPECT_EQ(server_.get(kSurface + "/position?coords=" + points(100)).status, 200);
  EXPECT_EQ(server_.get(kSurface + "/position?coords=" + points(101)).status, 413);
  const std::string box = std::string("/cube?bbox=500000,4500000,500100,4500100") + kUtm;
  EXPECT_EQ(server_.get(kSurface + box + "&resolution-x=50&resolution-y=20").status, 200);
  EXPECT_EQ(server_.get(kSurface + box + "&resolution-x=77&resolution-y=13").status, 413);
  expect_bad(box + "&resolution-x=10001&resolution-y=1", "query:resolution-x");
}

TEST_F(EdrTest, FormatsByNameAndByAccept) {
  const std::string target = kSurface + "/position?coords=POINT(-80.9995%2040.6513)";
  const RawAnswer geojson = server_.get(target, "Accept: application/geo+json\r\n");
  EXPECT_EQ(geojson.header("content-type"), "application/geo+json");
  EXPECT_EQ(geojson.header("vary").find("Accept") != std::string::npos, true);
  const RawAnswer page = server_.get(target, "Accept: text/html,application/xhtml+xml\r\n");
  EXPECT_EQ(page.header("content-type"), "text/html; charset=utf-8");
  EXPECT_NE(page.body.find("14.2"), std::string::npos);
  const RawAnswer plain = server_.get(target, "Accept: */*\r\n");
  EXPECT_EQ(plain.header("content-type"), "application/vnd.cov+json");
  EXPECT_EQ(server_.get(target + "&f=geojson", "Accept: text/html\r\n").header("content-type"),
            "application/geo+json");
  EXPECT_NE(plain.header("etag"), geojson.header("etag"));
  EXPECT_NE(plain.header("etag"), page.header("etag"));
  EXPECT_EQ(plain.body, server_.get(target).body) << "byte-stable";
}

TEST_F(EdrTest, EveryCollectionSaysHowItIsQueried) {
  const Json collections = Json::parse(server_.get("/tins/plane/collections").body);
  for (const Json& collection : collections.at("collections")) {
    EXPECT_TRUE(collection.contains("extent"));
    EXPECT_TRUE(collection.at("parameter_names").contains("elevation"));
    const Json& queries = collection.at("data_queries");
    ASSERT_FALSE(queries.empty());
    bool has_data_link = false;
    for (const Json& link : collection.at("links")) has_data_link = has_data_link || link.at("rel") == "data";
    EXPECT_TRUE(has_data_link);
    for (const auto& [type, query] : queries.items()) {
      const Json& link = query.at("link");
      EXPECT_EQ(link.at("variables").at("query_type"), type);
      EXPECT_TRUE(link.at("href").get<std::string>().starts_with("http://test/tins/plane/collections/"));
      const Json& formats = link.at("variables").at("output_formats");
      EXPECT_EQ(formats, collection.at("output_formats"));
      EXPECT_EQ(link.at("variables").at("default_output_format"), formats.at(0));
      EXPECT_EQ(type == "cube", link.at("variables").contains("height_units"));
    }
  }
  const Json surface = Json::parse(server_.get(kSurface).body);
  for (const char* type : {"position", "trajectory", "area", "cube"})
    EXPECT_TRUE(surface.at("data_queries").contains(type));
}

TEST_F(EdrTest, ConformanceIsDeclaredWhereEveryCollectionHasAnExtent) {
  const auto declared = [&](const std::string& tin) {
    const RawAnswer answer = server_.get("/tins/" + tin + "/conformance");
    return answer.body.find("ogcapi-edr-1/1.1/conf/core") != std::string::npos;
  };
  EXPECT_TRUE(declared("plane"));
  ASSERT_EQ(server_.post_json("/tins", R"({"id":"local","vertices":[[0,0,1],[9,0,2],[0,9,3]]})").status, 201);
  EXPECT_FALSE(declared("local"));
  EXPECT_EQ(server_.get("/tins/local/collections/surface/position?coords=POINT(1%201)").status, 404);
}

}  // namespace
}  // namespace tests::contract
