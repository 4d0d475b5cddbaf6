// The table of export formats, the document, and what is sent: one and the same.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "proto/openapi.h"
#include "server/api/export_formats.h"
#include "tests/contract/contract.h"
#include "tests/contract/test_server.h"

namespace tests::contract {
namespace {

using Json = nlohmann::json;
using server::api::export_formats;
using server::api::ExportFamily;

class ExportsTest : public testing::Test {
 protected:
  ExportsTest() {
    server_.post_json(
        "/tins",
        R"({"id":"hill","crs":"EPSG:32632","title":"A hill","vertices":[[0,0,1],[100,0,2],[0,100,3],[100,100,4],[50,40,9]]})");
  }
  TestServer server_;
};

TEST_F(ExportsTest, TheDocumentListsTheFormatsOfTheTable) {
  Json names = Json::array();
  for (const auto& format : export_formats()) names.push_back(format.name);
  const Json document = Json::parse(proto::openapi_json());
  EXPECT_EQ(document.at("components").at("parameters").at("F").at("schema").at("enum"), names);
}

TEST_F(ExportsTest, EachFormatIsSentAsTheTableSays) {
  for (const auto& format : export_formats()) {
    SCOPED_TRACE(format.name);
    const Ask ask{"GET", "/tins/hill/export?f=" + std::string(format.name)};
    const RawAnswer answer = server_.ask(ask);
    ASSERT_EQ(answer.status, 200) << answer.body;
    EXPECT_EQ(answer.header("content-type"), format.media_type);
    EXPECT_EQ(answer.header("content-disposition"),
              "attachment; filename=\"hill" + std::string(format.suffix) + "\"");
    EXPECT_FALSE(answer.header("etag").empty());
    EXPECT_EQ(breaches(ask, answer), std::vector<std::string>{});
    EXPECT_GT(answer.body.size(), 50U);
    EXPECT_EQ(server_.ask(ask).body, answer.body) << "equal revisions give equal bytes";
  }
}

TEST_F(ExportsTest, ATinLinksToEachFormat) {
  const Json links = Json::parse(server_.get("/tins/hill").body).at("links");
  for (const auto& format : export_formats()) {
    const std::string href = "/tins/hill/export?f=" + std::string(format.name);
    const auto found = std::find_if(links.begin(), links.end(), [&](const Json& link) {
      return link.at("href").get<std::string>().ends_with(href);
    });
    ASSERT_NE(found, links.end()) << href;
    EXPECT_EQ(found->at("type"), format.media_type);
  }
}

TEST_F(ExportsTest, AnotherFormatIsRefusedWithTheNamesOfAll) {
  const RawAnswer answer = server_.get("/tins/hill/export?f=dwg");
  EXPECT_EQ(answer.status, 422);
  for (const auto& format : export_formats())
    EXPECT_NE(answer.body.find(format.name), std::string::npos) << format.name;
}

TEST_F(ExportsTest, ParametersWithoutEffectAreRefused) {
  for (const auto& format : export_formats()) {
    SCOPED_TRACE(format.name);
    const std::string path = "/tins/hill/export?f=" + std::string(format.name);
    const bool raster = format.family == ExportFamily::kRaster;
    EXPECT_EQ(server_.get(path + "&cell-size=10").status, raster ? 200 : 422);
    const bool features = takes_parameter(format, "collection");
    EXPECT_EQ(server_.get(path + "&collection=vertices").status, features ? 200 : 422);
    EXPECT_EQ(server_.get(path + "&voids=fill&bbox=0,0,60,60").status, 200);
    EXPECT_EQ(server_.get(path + "&crs=EPSG:32633").status, 200);
    EXPECT_EQ(server_.get(path + "&flavour=mint").status, 400);
  }
}

TEST_F(ExportsTest, LandXmlKnowsNoDegrees) {
  EXPECT_EQ(server_.get("/tins/hill/export?f=landxml&crs=EPSG:4326").status, 422);
}

TEST_F(ExportsTest, AnEmptyTinHasNoMesh) {
  server_.post_json("/tins", R"({"id":"empty"})");
  for (const auto& format : export_formats()) {
    if (format.family == ExportFamily::kFeatures || format.family == ExportFamily::kLayers) continue;
    EXPECT_EQ(server_.get("/tins/empty/export?f=" + std::string(format.name)).status, 422) << format.name;
    EXPECT_EQ(server_.get("/tins/hill/export?f=" + std::string(format.name) + "&bbox=1e6,1e6,1e6,1e6").status,
              format.family == ExportFamily::kRaster ? 200 : 422)
        << format.name;
  }
}

/// What is sent under a format's own name comes back with the same digest.
TEST_F(ExportsTest, MeshesComeHomeWithTheSameDigest) {
  const Json hill = Json::parse(server_.get("/tins/hill").body);
  for (const char* format : {"obj", "ply", "ply-ascii", "2dm", "landxml", "xyz", "gpkg",
                             "geojson&collection=vertices&crs=EPSG:32632"}) {
    SCOPED_TRACE(format);
    const std::string file = server_.get("/tins/hill/export?f=" + std::string(format)).body;
    const std::string id = "home-" + std::string(format).substr(0, std::string(format).find('&'));
    const RawAnswer made = server_.ask({"POST", "/tins?id=" + id, "application/octet-stream", file});
    ASSERT_EQ(made.status, 201) << made.body;
    const Json home = Json::parse(made.body);
    EXPECT_EQ(home.at("digest"), hill.at("digest"));
    EXPECT_EQ(home.at("crs"), hill.at("crs"));
  }
}

}  // namespace
}  // namespace tests::contract
