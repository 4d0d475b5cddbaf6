// Tiles over HTTP: what clients learn of them, what they may keep, and that an edit shows.
#include <gtest/gtest.h>

#include "server/tiles/tile_cache.h"
#include "tests/contract/test_server.h"
#include "tests/support/quantized_mesh.h"

namespace tests::contract {
namespace {

class TilesTest : public testing::Test {
 protected:
  TilesTest() {
    EXPECT_EQ(server_.upload("/tins?id=grid&crs=EPSG:4326", "text/plain", ascii_grid(12, 9)).status, 201);
  }
  Json layer() { return Json::parse(server_.get("/tins/grid/terrain/layer.json").body); }
  /// A tile of the lowest level.
  std::string lowest() {
    const Json available = layer().at("available");
    const Json range = available.back().at(0);
    return "/tins/grid/terrain/" + std::to_string(available.size() - 1) + "/" + range.at("startX").dump() + "/" +
           range.at("startY").dump() + ".terrain";
  }

  TestServer server_;
};

TEST_F(TilesTest, LayerJsonSaysWhatCesiumNeeds) {
  const Json document = layer();
  EXPECT_EQ(document.at("format"), "quantized-mesh-1.0");
  EXPECT_EQ(document.at("scheme"), "tms");
  EXPECT_EQ(document.at("projection"), "EPSG:4326");
  EXPECT_EQ(document.at("version"), "1");
  EXPECT_EQ(document.at("maxzoom").get<std::size_t>() + 1, document.at("available").size());
  EXPECT_EQ(document.at("available").at(0), Json::parse(R"([{"startX":0,"startY":0,"endX":1,"endY":0}])"));
}

TEST_F(TilesTest, TheLowestLevelHoldsTheTinAndOthersComeAsTheyAreAskedFor) {
  const RawAnswer plain = server_.get(lowest());
  EXPECT_EQ(plain.header("content-encoding"), "");
  const auto tile = support::decode_tile(plain.body);
  EXPECT_TRUE(tile.normals.empty());
  EXPECT_GT(Json::parse(tile.metadata).at("geometricerror"), 0);
  const RawAnswer packed = server_.get(lowest(), "Accept-Encoding: gzip, br\r\n");
  EXPECT_EQ(packed.header("content-encoding"), "gzip");
  EXPECT_EQ(server::tiles::gunzipped(packed.body), plain.body);
  EXPECT_NE(packed.header("etag"), plain.header("etag"));
  const RawAnswer rich = server_.get(lowest(), "Accept: application/vnd.quantized-mesh;extensions=octvertexnormals-metadata\r\n");
  EXPECT_EQ(support::decode_tile(rich.body).normals.size(), tile.u.size());
}

TEST_F(TilesTest, AnEditShowsInTheNextTileAndOnlyNearItself) {
  const std::string near = lowest(), far = "/tins/grid/dem/terrarium/9/20/20.png";
  const RawAnswer before = server_.get(near + "?v=1"), elsewhere = server_.get(far);
  EXPECT_NE(before.header("cache-control").find("immutable"), std::string::npos);
  EXPECT_EQ(server_.get(near + "?v=1", "If-None-Match: " + before.header("etag") + "\r\n").status, 304);
  ASSERT_EQ(server_.post_json("/tins/grid/edits", R"({"ops":[{"op":"set-z","id":97,"z":150}]})").status, 200);
  const RawAnswer after = server_.get(near + "?v=1");
  EXPECT_EQ(after.header("cache-control"), "no-cache") << "it is not the revision that was named";
  EXPECT_NE(after.body, before.body);
  EXPECT_EQ(server_.get(far, "If-None-Match: " + elsewhere.header("etag") + "\r\n").status, 304);
  EXPECT_EQ(layer().at("version"), "2");
}

TEST_F(TilesTest, TileJsonNamesTilesThatThereAre) {
  for (const std::string kind : {"dem/terrarium", "dem/mapbox", "hillshade"}) {
    const Json document = Json::parse(server_.get("/tins/grid/" + kind + "/tilejson.json").body);
    EXPECT_EQ(document.value("encoding", ""), kind == "hillshade" ? "" : kind.substr(4));
    std::string url = document.at("tiles").at(0);
    EXPECT_TRUE(url.starts_with("http://test/tins/grid/" + kind));
    for (const char* name : {"{z}", "{x}", "{y}"}) url.replace(url.find(name), 3, "0");
    const RawAnswer tile = server_.get(url);
    EXPECT_EQ(tile.header("content-type"), "image/png");
    EXPECT_EQ(tile.body.substr(1, 3), "PNG");
    EXPECT_LE(document.at("bounds").at(0), document.at("bounds").at(2));
  }
}

}  // namespace
}  // namespace tests::contract
