// Each TIN as an OGC API of its own: what its conformance classes ask for, one test a requirement or a few.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/contract/test_server.h"

namespace tests::contract {
namespace {

constexpr const char* kTitledHill =
    R"({"id":"hill","title":"A <hill>","crs":"EPSG:32617","duplicates":"reject",
  "vertices":[[500000,4500000,10],[500100,4500000,12.5],[500000,4500100,11],[500100,4500100,14],[500050,4500040,20]]})";
constexpr const char* kCrs84 = "http://www.opengis.net/def/crs/OGC/1.3/CRS84";
constexpr const char* kUtm = "http://www.opengis.net/def/crs/EPSG/0/32617";
constexpr const char* kLatLon = "http://www.opengis.net/def/crs/EPSG/0/4326";
constexpr const char* kHtml = "Accept: text/html,application/xhtml+xml\r\n";
const std::string kCollections = "/tins/hill/collections";
const std::string kVertices = kCollections + "/vertices/items";

class OgcTest : public testing::Test {
 protected:
  OgcTest() { EXPECT_EQ(server_.post_json("/tins", kTitledHill).status, 201); }

  Json json(const std::string& target) {
    const RawAnswer answer = server_.get(target);
    EXPECT_EQ(answer.status, 200) << target << "\n" << answer.body;
    return Json::parse(answer.body);
  }
  static std::string href(const Json& document, const std::string& rel, const std::string& type = "") {
    for (const Json& link : document.at("links")) {
      if (link.at("rel") == rel && (type.empty() || link.value("type", "") == type)) return link.at("href");
    }
    ADD_FAILURE() << "no link " << rel << " in " << document;
    return "/";
  }
  static Json coordinates(const Json& page, int i) {
    return page.at("features").at(static_cast<std::size_t>(i)).at("geometry").at("coordinates");
  }
  RawAnswer send(const std::string& method, const std::string& target, const std::string& body,
                 const std::string& fields = "If-Match: *\r\n") {
    return server_.ask({method, target, body.empty() ? "" : "application/geo+json", body, fields});
  }
  static std::string point(const std::string& at) {
    return R"({"type":"Feature","geometry":{"type":"Point","coordinates":[)" + at + R"(]},"properties":null})";
  }

  TestServer server_;
};

// Common Part 1, Features Part 1: core ------------------------------------------------------------------------------

TEST_F(OgcTest, TheLandingPageLeadsToContractConformanceAndData) {
  const Json landing = json("/tins/hill");
  EXPECT_EQ(landing.at("title"), "A <hill>");
  for (const Json& link : landing.at("links")) {
    EXPECT_TRUE(link.at("href").get<std::string>().starts_with("http://test/tins/hill")) << link;
  }
  const Json contract = json(href(landing, "service-desc"));
  EXPECT_TRUE(contract.at("openapi").get<std::string>().starts_with("3.0"));
  EXPECT_EQ(contract.at("servers").at(0).at("url"), "http://test/tins/hill");
  EXPECT_TRUE(contract.at("paths").contains("/collections/{collection}/items"));
  for (const auto& [path, operations] : contract.at("paths").items()) {
    EXPECT_EQ(path.find("{tin}"), std::string::npos) << "no path of the whole server: " << path;
  }
  const Json classes = json(href(landing, "conformance")).at("conformsTo");
  EXPECT_NE(std::find(classes.begin(), classes.end(), "http://www.opengis.net/spec/ogcapi-features-1/1.0/conf/core"),
            classes.end());
  EXPECT_EQ(href(landing, "data"), "http://test/tins/hill/collections");
}

TEST_F(OgcTest, ASlashTooManyLeadsToTheLandingPage) {
  const RawAnswer answer = server_.get("/tins/hill/?a=b/");
  EXPECT_EQ(answer.status, 308);
  EXPECT_EQ(answer.header("location"), "/tins/hill?a=b/");
  EXPECT_EQ(server_.get("/tins/hill/").header("location"), "/tins/hill");
  EXPECT_EQ(server_.get("//").header("location"), "/");
  EXPECT_EQ(server_.ask({"DELETE", "/tins/hill/"}).status, 404);
}

TEST_F(OgcTest, EveryCollectionSaysWhereItsFeaturesAre) {
  const Json collections = json("/tins/hill/collections");
  ASSERT_EQ(collections.at("collections").size(), 4u);
  for (const Json& listed : collections.at("collections")) {
    const Json alone = json(href(listed, "self"));
    EXPECT_EQ(alone, listed);
    if (listed.at("id") == "surface") continue;  // no features: see below
    EXPECT_EQ(listed.at("itemType"), "feature");
    EXPECT_EQ(listed.at("crs").at(0), kCrs84);
    EXPECT_EQ(listed.at("storageCrs"), kUtm);
    const Json items = json(href(listed, "items", "application/geo+json"));
    EXPECT_EQ(items.at("numberMatched"), items.at("features").size());
    const Json box = listed.at("extent").at("spatial").at("bbox").at(0);
    EXPECT_NEAR(box.at(0).get<double>(), -81, 1e-6);
    EXPECT_LT(box.at(0), box.at(2));
    const Json schema = json(href(listed, "describedby"));
    EXPECT_TRUE(schema.at("properties").contains("geometry"));
    for (const auto& [name, value] : items.at("features").at(0).at("properties").items()) {
      EXPECT_TRUE(schema.at("properties").contains(name)) << name;
    }
  }
}

TEST_F(OgcTest, EachFeatureIsAResourceToo) {
  for (const std::string collection : {"vertices", "triangles", "edges"}) {
    const Json page = json(kCollections + "/" + collection + "/items");
    for (Json feature : page.at("features")) {
      const std::string id = feature.at("id").is_string() ? feature.at("id").get<std::string>() : feature.at("id").dump();
      Json alone = json(kCollections + "/" + collection + "/items/" + id);
      EXPECT_EQ(href(alone, "self"), "http://test" + kCollections + "/" + collection + "/items/" + id);
      EXPECT_EQ(href(alone, "collection"), "http://test" + kCollections + "/" + collection);
      alone.erase("links");
      EXPECT_EQ(alone, feature);
    }
  }
  for (const char* wrong : {"vertices/items/0", "vertices/items/01", "vertices/items/1-2", "vertices/items/x",
                            "triangles/items/1-2", "triangles/items/3-2-1", "edges/items/2-1", "edges/items/1-1",
                            "edges/items/1-2-", "edges/items/1-99999999999999999999999"}) {
    EXPECT_EQ(server_.get(kCollections + "/" + wrong).status, 404) << wrong;
  }
}

TEST_F(OgcTest, WrongParametersAre400) {
  for (const char* query : {"limit=0", "limit=-1", "limit=x", "bbox=1,2,3", "bbox=1,2,x,4", "bbox=1,9,2,3", "bbox=1,2,inf,4",
                            "bbox=1,1,1,1,1", "datetime=yesterday", "datetime=", "crs=EPSG:1", "crs=http://x", "bbox-crs=EPSG:1",
                            "crs=EPSG:2056", "unknown=1", "limit=1&limit=1", "next=x"}) {
    EXPECT_EQ(server_.get(kVertices + "?" + query).status, 400) << query;
  }
  EXPECT_EQ(server_.get(kVertices + "?limit=10001").status, 200) << "more than the most is the most";
  for (const char* fine : {"2018-02-12T23:20:50Z", "2018-02-12T00:00:00Z/2018-03-18T12:31:12Z", "2018-02-12T00:00:00Z/..",
                           "../2018-03-18T12:31:12Z", "2018-02-12"}) {
    EXPECT_EQ(json(kVertices + "?datetime=" + fine).at("numberMatched"), 5) << fine;
  }
}

TEST_F(OgcTest, ABoxSelectsWhatTouchesIt) {
  // 100 m are about 0.00118 degrees of longitude and 0.0009 of latitude here.
  const Json near = json(kVertices + "?bbox=-81.0001,40.649,-80.9999,40.6510");
  EXPECT_EQ(near.at("numberMatched"), 1);
  EXPECT_EQ(near.at("features").at(0).at("id"), 1);
  EXPECT_EQ(json(kVertices + "?bbox=-81.0001,40.649,15,-80.9,40.66,30").at("numberMatched"), 1) << "by elevation";
  EXPECT_EQ(json(kVertices + "?bbox=10,10,11,11").at("numberMatched"), 0);
  EXPECT_EQ(json(kVertices + "?bbox=-180,-90,180,90").at("numberMatched"), 5);
  EXPECT_EQ(json(kVertices + "?bbox=170,-90,-80,90").at("numberMatched"), 5) << "over the antimeridian";
  EXPECT_EQ(json(kVertices + "?bbox=-70,-90,-90,90").at("numberMatched"), 0) << "all but where it is";
  // A sliver across the middle, between all vertices: triangles and edges cross it, no vertex lies in it.
  const std::string sliver = "?bbox=-80.9998,40.6513,-80.99945,40.65131";
  EXPECT_EQ(json(kVertices + sliver).at("numberMatched"), 0);
  EXPECT_GT(json(kCollections + "/triangles/items" + sliver).at("numberMatched"), 0);
  EXPECT_GT(json(kCollections + "/edges/items" + sliver).at("numberMatched"), 0);
  EXPECT_LT(json(kCollections + "/edges/items" + sliver).at("numberMatched"), 8);
}

// Features Part 2 ---------------------------------------------------------------------------------------------------

TEST_F(OgcTest, CoordinatesComeInTheCrsAndTheOrderOfItsAuthority) {
  const Json plain = json(kVertices);
  EXPECT_EQ(server_.get(kVertices).header("content-crs"), std::string("<") + kCrs84 + ">");
  const RawAnswer utm = server_.get(kVertices + "?crs=" + kUtm);
  EXPECT_EQ(utm.header("content-crs"), std::string("<") + kUtm + ">");
  EXPECT_EQ(coordinates(Json::parse(utm.body), 4), Json::parse("[500050,4500040,20]"));
  const RawAnswer lat_lon = server_.get(kVertices + "?crs=" + kLatLon);
  EXPECT_EQ(lat_lon.header("content-crs"), std::string("<") + kLatLon + ">");
  for (int i = 0; i < 5; ++i) {
    const Json a = coordinates(plain, i), b = coordinates(Json::parse(lat_lon.body), i);
    EXPECT_EQ(a.at(0), b.at(1));
    EXPECT_EQ(a.at(1), b.at(0));
    EXPECT_EQ(a.at(2), b.at(2));
  }
  const Json mercator = json(kVertices + "?crs=http://www.opengis.net/def/crs/EPSG/0/3857");
  EXPECT_NEAR(coordinates(mercator, 0).at(0).get<double>(), -81 * 6378137 * M_PI / 180, 1e-3);
  const RawAnswer one = server_.get(kVertices + "/5?crs=" + kUtm);
  EXPECT_EQ(one.header("content-crs"), std::string("<") + kUtm + ">");
  EXPECT_EQ(Json::parse(one.body).at("geometry").at("coordinates"), Json::parse("[500050,4500040,20]"));
}

TEST_F(OgcTest, ABoxMayBeInAnotherCrs) {
  const std::string utm = std::string("&bbox-crs=") + kUtm, lat_lon = std::string("&bbox-crs=") + kLatLon;
  EXPECT_EQ(json(kVertices + "?bbox=500040,4500030,500060,4500050" + utm).at("features").at(0).at("id"), 5);
  EXPECT_EQ(json(kVertices + "?bbox=500000,4500000,500100,4500000" + utm).at("numberMatched"), 2) << "its sides belong to it";
  EXPECT_EQ(json(kVertices + "?bbox=40.649,-81.0001,40.6510,-80.9999" + lat_lon).at("features").at(0).at("id"), 1);
  const Json both = json(kVertices + "?bbox=500040,4500030,500060,4500050" + utm + "&crs=" + kUtm + "&limit=1");
  EXPECT_EQ(coordinates(both, 0), Json::parse("[500050,4500040,20]"));
}

TEST_F(OgcTest, PagesKeepCrsAndBox) {
  const std::string box = "?limit=1&bbox=499999,4499999,500101,4500050&bbox-crs=" + std::string(kUtm) + "&crs=" + kUtm;
  std::string target = kVertices + box;
  std::vector<Json> seen;
  while (!target.empty() && seen.size() < 10) {
    const RawAnswer answer = server_.get(target);
    EXPECT_EQ(answer.header("content-crs"), std::string("<") + kUtm + ">");
    const Json page = Json::parse(answer.body);
    EXPECT_EQ(page.at("numberMatched"), 3);
    seen.push_back(coordinates(page, 0));
    target.clear();
    for (const Json& link : page.at("links")) {
      if (link.at("rel") == "next") target = link.at("href");
    }
  }
  EXPECT_EQ(Json(seen), Json::parse("[[500000,4500000,10],[500100,4500000,12.5],[500050,4500040,20]]"));
}

TEST_F(OgcTest, ATinWithoutCrsKeepsItsCoordinatesToItself) {
  ASSERT_EQ(server_.post_json("/tins", R"({"id":"local","vertices":[[0,0,1],[9,0,2],[0,9,3]]})").status, 201);
  const std::string items = "/tins/local/collections/vertices/items";
  const RawAnswer answer = server_.get(items + "?bbox=8,-1,10,1");
  EXPECT_EQ(answer.header("content-crs"), "");
  EXPECT_EQ(coordinates(Json::parse(answer.body), 0), Json::parse("[9,0,2]"));
  EXPECT_EQ(server_.get(items + "?crs=" + kCrs84).status, 400);
  EXPECT_EQ(json("/tins/local/collections/vertices").at("crs"), Json::array());
}

// Features Part 4 ---------------------------------------------------------------------------------------------------

TEST_F(OgcTest, AVertexIsCreatedWhereTheBodySays) {
  const RawAnswer made = send("POST", kVertices, point("-80.9995,40.6504,33.5"), "");
  ASSERT_EQ(made.status, 201) << made.body;
  EXPECT_EQ(made.header("location"), "http://test" + kVertices + "/6");
  const RawAnswer got = server_.get(made.header("location"));
  EXPECT_EQ(got.header("etag").substr(0, 30), made.header("etag").substr(0, 30)) << "the same state";
  const Json at = Json::parse(got.body).at("geometry").at("coordinates");
  EXPECT_NEAR(at.at(0).get<double>(), -80.9995, 2e-8);
  EXPECT_NEAR(at.at(1).get<double>(), 40.6504, 2e-8);
  EXPECT_EQ(at.at(2), 33.5);
  const std::string in_utm = std::string("Content-Crs: <") + kUtm + ">\r\n";
  const RawAnswer second = send("POST", kVertices, point("500070,4500060,1"), in_utm);
  EXPECT_EQ(coordinates({{"features", {json(second.header("location") + "?crs=" + kUtm)}}}, 0),
            Json::parse("[500070,4500060,1]"));
  const std::string swapped = std::string("Content-Crs: ") + kLatLon + "\r\n";
  const RawAnswer third = send("POST", kVertices, point("40.6502,-80.9993,2"), swapped);
  EXPECT_NEAR(json(third.header("location")).at("geometry").at("coordinates").at(0).get<double>(), -80.9993, 2e-8);
  EXPECT_EQ(send("POST", kVertices, point("1,1,1"), "Content-Crs: <EPSG:1>\r\n").status, 400);
}

TEST_F(OgcTest, AVertexIsChangedOnlyInTheStateThatTheClientSaw) {
  const std::string before = server_.tin("hill").at("digest"), vertex = kVertices + "/5";
  const std::string tag = server_.get(vertex).header("etag");
  // An edit elsewhere leaves the vertex as it is.
  EXPECT_EQ(server_.post_json("/tins/hill/edits", R"({"ops":[{"op":"set-z","id":1,"z":5}]})").status, 200);
  EXPECT_EQ(server_.get(vertex).header("etag"), tag);
  EXPECT_EQ(send("PATCH", vertex, R"({"properties":{"z":21}})", "").status, 428);
  const RawAnswer patched = send("PATCH", vertex, R"({"properties":{"z":21}})", "If-Match: " + tag + "\r\n");
  EXPECT_EQ(patched.status, 204);
  EXPECT_NE(server_.get(vertex).header("etag"), tag);
  EXPECT_EQ(send("DELETE", vertex, "", "If-Match: " + tag + "\r\n").status, 412);
  const std::string moved = std::string("Content-Crs: <") + kUtm + ">\r\nIf-Match: \"other\", " + patched.header("etag") + "\r\n";
  EXPECT_EQ(send("PUT", vertex, point("500060,4500045,22"), moved).status, 204);
  EXPECT_EQ(coordinates({{"features", {json(vertex + "?crs=" + kUtm)}}}, 0), Json::parse("[500060,4500045,22]"));
  EXPECT_EQ(send("PATCH", vertex, R"({"geometry":{"type":"Point","coordinates":[500050,4500040]}})",
                 std::string("If-Match: *\r\nContent-Crs: ") + kUtm + "\r\n").status, 204);
  EXPECT_EQ(json(vertex).at("properties").at("z"), 22) << "what a patch does not name stays";
  EXPECT_EQ(send("PATCH", vertex, R"({"properties":{"z":20}})").status, 204);
  EXPECT_EQ(send("PATCH", kVertices + "/1", R"({"properties":{"z":10}})").status, 204);
  EXPECT_EQ(server_.tin("hill").at("digest"), before);
  EXPECT_EQ(send("DELETE", vertex, "").status, 204);
  EXPECT_EQ(server_.get(vertex).status, 404);
  EXPECT_EQ(send("DELETE", vertex, "").status, 404);
}

TEST_F(OgcTest, AnHtmlTagNamesTheSameState) {
  const std::string shown = server_.get(kVertices + "/5", kHtml).header("etag");
  EXPECT_NE(shown, server_.get(kVertices + "/5").header("etag"));
  EXPECT_EQ(send("PATCH", kVertices + "/5", R"({"properties":{"z":21}})", "If-Match: " + shown + "\r\n").status, 204);
}

TEST_F(OgcTest, BodiesThatMakeNoVertexChangeNothing) {
  const std::string before = server_.state();
  const auto refused = [&](const std::string& body, int status, const std::string& where) {
    const RawAnswer answer = send("POST", kVertices, body, "");
    EXPECT_EQ(answer.status, status) << body << answer.body;
    EXPECT_EQ(Json::parse(answer.body).value("where", ""), where) << body;
  };
  refused("[]", 400, "");
  refused(R"({"type":"Feature"})", 400, "");
  refused(R"({"type":"Point","geometry":null})", 422, "/type");
  refused(R"({"type":"Feature","geometry":null})", 400, "/geometry");
  refused(R"({"type":"Feature","geometry":{"type":"LineString","coordinates":[]}})", 422, "/geometry/type");
  refused(point("1"), 400, "/geometry/coordinates");
  refused(point("1,2,3,4"), 400, "/geometry/coordinates");
  refused(point("1,2,\"3\""), 400, "/geometry/coordinates/2");
  refused(point("1,2,1e999"), 422, "/geometry/coordinates/2");
  refused(point("1,2"), 422, "/geometry");
  refused(R"({"type":"Feature","geometry":{"type":"Point","coordinates":[1,2,3]},"properties":{"z":4}})", 422, "/properties/z");
  refused(R"({"type":"Feature","geometry":{"type":"Point","coordinates":[1,2,3]},"properties":{"name":"x"}})", 422,
          "/properties/name");
  refused(point("-81,91,0"), 422, "/geometry/coordinates");
  refused(point("0,0,0"), 422, "/geometry/coordinates");
  EXPECT_EQ(server_.state(), before);
}

TEST_F(OgcTest, OptionsTellWhatCanBeDone) {
  EXPECT_EQ(server_.ask({"OPTIONS", kVertices}).header("allow"), "GET, HEAD, POST, OPTIONS");
  EXPECT_EQ(server_.ask({"OPTIONS", kVertices + "/1"}).header("allow"), "GET, HEAD, PUT, PATCH, DELETE, OPTIONS");
  EXPECT_EQ(server_.ask({"OPTIONS", kCollections + "/edges/items"}).header("allow"), "GET, HEAD, OPTIONS");
}

// Coverages -----------------------------------------------------------------------------------------------------------

TEST_F(OgcTest, TheSurfaceIsACoverageOnTheGridThatIsAskedFor) {
  const Json surface = json(kCollections + "/surface");
  EXPECT_FALSE(surface.contains("itemType"));
  const std::string relations = "http://www.opengis.net/def/rel/ogc/1.0/";
  const Json domain = json(href(surface, relations + "coverage-domainset")).at("generalGrid");
  EXPECT_EQ(domain.at("srsName"), kCrs84);
  EXPECT_EQ(json(href(surface, relations + "coverage-rangetype")).at("field").size(), 1u);
  const std::string target = href(surface, relations + "coverage");
  const RawAnswer whole = server_.get(target);
  EXPECT_EQ(whole.header("content-type"), "image/tiff; application=geotiff");
  EXPECT_EQ(whole.header("content-crs"), std::string("<") + kCrs84 + ">");
  const std::string part = "?subset=Long(-80.9999:-80.9990),Lat(40.6501:40.6508)";
  const std::string one = server_.get(target + part + "&scale-size=Long(8),Lat(4)").body;
  EXPECT_EQ(server_.get(target + part + "&scaleSize=Lat(4),Long(8)").body, one);
  EXPECT_EQ(server_.get(target + "?bbox=-80.9999,40.6501,-80.9990,40.6508&scale-size=Long(8),Lat(4)").body, one);
  EXPECT_EQ(server_.get(target + "?crs=" + kLatLon + "&bbox=40.6501,-80.9999,40.6508,-80.9990").header("content-crs"),
            std::string("<") + kLatLon + ">");
  for (const char* wrong : {"?subset=Long(1:2", "?subset=Height(1:2)", "?subset=Long(2:1)", "?subset=Long(1:1),Lat(1:1)",
                            "?scale-size=Long(0)", "?scale-size=Long(1.5)", "?scale-size=Long(1),Long(2)", "?bbox=1,2,3",
                            "?bbox=1,1,2,2&subset=Long(1:2)", "?crs=EPSG:1", "?scale-size=Long(x)", "?subset=,"}) {
    EXPECT_EQ(server_.get(target + wrong).status, 400) << wrong;
  }
  EXPECT_EQ(server_.get(target + "?scale-size=Long(1000000),Lat(1000000)").status, 413);
  EXPECT_EQ(server_.leftovers(), std::set<std::string>{});
}

// Pages for people --------------------------------------------------------------------------------------------------

TEST_F(OgcTest, PeopleGetPagesUnderTheSameUrls) {
  for (const std::string path : {"", "/conformance", "/collections", "/collections/edges", "/collections/vertices/items",
                                 "/collections/vertices/items/5"}) {
    const RawAnswer page = server_.get("/tins/hill" + path, kHtml);
    EXPECT_EQ(page.status, 200) << path;
    EXPECT_EQ(page.header("content-type"), "text/html; charset=utf-8");
    EXPECT_EQ(page.header("vary"), "Accept");
    EXPECT_NE(page.body.find("<h1>"), std::string::npos);
    EXPECT_EQ(page.body.find("<hill>"), std::string::npos) << "texts are escaped";
    const RawAnswer data = server_.get("/tins/hill" + path, "Accept: application/json;q=0.9, text/html;q=0.1\r\n");
    EXPECT_NE(data.header("content-type"), page.header("content-type"));
    if (!page.header("etag").empty()) {
      EXPECT_NE(data.header("etag"), page.header("etag"));
    }
  }
  EXPECT_NE(server_.get("/tins/hill", kHtml).body.find("A &lt;hill&gt;"), std::string::npos);
}

TEST(PublicUrlTest, StandsBeforeEveryLink) {
  TestServer server([](server::Config& config) { config.public_url = "https://terrain.example.org/t"; });
  ASSERT_EQ(server.post_json("/tins", kTitledHill).status, 201);
  const Json document = server.tin("hill");
  for (const Json& link : document.at("links")) {
    EXPECT_TRUE(link.at("href").get<std::string>().starts_with("https://terrain.example.org/t/tins/hill")) << link;
  }
}

}  // namespace
}  // namespace tests::contract
