// Walking through features page by page.
#include <gtest/gtest.h>

#include "tests/contract/test_server.h"

namespace tests::contract {
namespace {

class PagingTest : public testing::Test {
 protected:
  PagingTest() {
    EXPECT_EQ(server_.upload("/tins?id=grid", "text/plain", ascii_grid(7, 5)).status, 201);
    EXPECT_EQ(server_.upload("/tins?id=geo&crs=EPSG:4326", "text/plain", ascii_grid(6, 6)).status, 201);
  }

  std::string edit(const std::string& ops) {
    const RawAnswer answer = server_.post_json("/tins/grid/edits", R"({"ops":[)" + ops + "]}");
    EXPECT_EQ(answer.status, 200) << answer.body;
    return answer.header("etag");
  }

  static std::string next_of(const Json& page) {
    for (const Json& link : page.at("links")) {
      if (link.at("rel") == "next") return link.at("href");
    }
    return {};
  }

  /// All features from `target` on as they come, page by page; `between` runs after each page.
  std::vector<Json> walk(std::string target, const std::function<void()>& between = {}) {
    std::vector<Json> features;
    std::size_t matched = 0;
    for (int pages = 0; !target.empty() && pages < 1000; ++pages) {
      const RawAnswer answer = server_.get(target);
      EXPECT_EQ(answer.status, 200) << target << "\n" << answer.body;
      if (answer.status != 200) break;
      const Json page = Json::parse(answer.body);
      EXPECT_EQ(page.at("numberReturned"), page.at("features").size());
      if (pages == 0) matched = page.at("numberMatched");
      EXPECT_EQ(page.at("numberMatched"), matched);
      for (const Json& feature : page.at("features")) features.push_back(feature);
      target = next_of(page);
      if (between) between();
    }
    if (target.empty()) {
      EXPECT_EQ(features.size(), matched);
    }
    return features;
  }

  static std::set<Json> ids(const std::vector<Json>& features) {
    std::set<Json> ids;
    for (const Json& feature : features) ids.insert(feature.at("id"));
    EXPECT_EQ(ids.size(), features.size()) << "a feature came twice";
    return ids;
  }

  TestServer server_;
};

TEST_F(PagingTest, EveryFeatureComesOnceWhateverThePageSize) {
  const Json tin = server_.tin("grid");
  const int vertices = tin.at("vertexCount"), triangles = tin.at("triangleCount");
  for (const auto& [collection, count] : std::vector<std::pair<std::string, int>>{
           {"vertices", vertices}, {"triangles", triangles}, {"edges", vertices + triangles - 1}}) {
    const std::string items = "/tins/grid/collections/" + collection + "/items";
    const auto whole = walk(items + "?limit=1000");
    EXPECT_EQ(whole.size(), count) << collection;
    ids(whole);
    for (const int limit : {1, 2, 3, 5, 34, 35, 36}) {
      EXPECT_EQ(walk(items + "?limit=" + std::to_string(limit)), whole) << collection << " by " << limit;
    }
  }
}

TEST_F(PagingTest, TheFeaturesOfABoxComeOnceToo) {
  for (const std::string collection : {"vertices", "triangles", "edges"}) {
    const std::string items = "/tins/grid/collections/" + collection + "/items?bbox=1,1,4,4";
    const auto whole = walk(items + "&limit=1000");
    EXPECT_GT(whole.size(), 0U);
    EXPECT_LT(whole.size(), collection == "edges" ? 82U : 48U);
    for (const int limit : {1, 2, 9})
      EXPECT_EQ(walk(items + "&limit=" + std::to_string(limit)), whole) << collection;
  }
}

TEST_F(PagingTest, ABoxWithAnExponentSurvivesTheLink) {
  const auto features = walk("/tins/grid/collections/vertices/items?limit=4&bbox=-1e%2B1,-10,1e%2B2,10");
  EXPECT_EQ(features.size(), 35U);
}

TEST_F(PagingTest, PagesGoOnInTheirRevisionWhenAnEditComesBetween) {
  for (const std::string collection : {"vertices", "triangles"}) {
    const std::string items = "/tins/grid/collections/" + collection + "/items?limit=4";
    const auto before = walk(items);
    bool edited = false;
    const auto during = walk(items, [&] {
      if (edited) return;
      edited = true;
      edit(R"({"op":"remove","id":20},{"op":"insert","x":2.2,"y":2.2,"z":7},{"op":"set-z","id":21,"z":-5})");
    });
    EXPECT_EQ(during, before) << collection;
    EXPECT_NE(walk(items), before) << collection;
    server_.remove("/tins/grid");
    EXPECT_EQ(server_.upload("/tins?id=grid", "text/plain", ascii_grid(7, 5)).status, 201);
  }
}

TEST_F(PagingTest, ARevisionThatIsNoLongerKeptIsGone) {
  const std::string items = "/tins/grid/collections/vertices/items?limit=4";
  const std::string oldest = next_of(Json::parse(server_.get(items).body));
  for (int z = 0; z < 10; ++z) {  // each page keeps its revision, and few are kept
    edit(R"({"op":"set-z","id":1,"z":)" + std::to_string(z) + "}");
    server_.get(items);
  }
  const RawAnswer answer = server_.get(oldest);
  EXPECT_EQ(answer.status, 410);
  EXPECT_EQ(slug(answer), "gone");
}

TEST_F(PagingTest, ATokenThatNoPageGaveIsRefusedOrEndsTheWalk) {
  const std::string items = "/tins/grid/collections/";
  for (const char* token : {"", "1", "1.", "1.2", "1.2.", "x.1.1.1", "1.1.1", "1.1.1.1.1", "-1.1.1.1",
                            "1.1.99999999999999999999.1", "1.1.4294967296.1", "%00", "1.1.1.1%20"}) {
    const int status = server_.get(items + "vertices/items?next=" + token).status;
    EXPECT_EQ(status, 400) << token;
  }
  for (const char* token : {"1.18446744073709551615.4294967295.1", "1.0.0.0", "1.36.7.0", "1.1.4000000000.9"}) {
    for (const std::string collection : {"vertices", "triangles"}) {
      EXPECT_EQ(server_.get(items + collection + "/items?next=" + token).status, 200) << token;
    }
  }
}

TEST_F(PagingTest, GeographicFeaturesAreInLongitudeAndLatitude) {
  const auto vertices = walk("/tins/geo/collections/vertices/items");
  ASSERT_EQ(vertices.size(), 36U);
  EXPECT_EQ(vertices.front().at("geometry").at("coordinates"), Json::parse("[0.5,5.5,100]"));
}

TEST_F(PagingTest, RingsAreCounterClockwiseAndClosed) {
  for (const Json& triangle : walk("/tins/grid/collections/triangles/items")) {
    const Json ring = triangle.at("geometry").at("coordinates").at(0);
    EXPECT_EQ(ring.at(0), ring.at(3));
    const auto x = [&](int i) { return ring.at(i).at(0).get<double>(); };
    const auto y = [&](int i) { return ring.at(i).at(1).get<double>(); };
    EXPECT_GT((x(1) - x(0)) * (y(2) - y(0)) - (x(2) - x(0)) * (y(1) - y(0)), 0);
  }
}

}  // namespace
}  // namespace tests::contract
