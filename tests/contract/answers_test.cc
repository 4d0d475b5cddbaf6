// Every operation, with every status that the document lists for it; TestServer holds each answer against its
// schema.
#include <gtest/gtest.h>

#include <thread>

#include "tests/contract/test_server.h"

namespace tests::contract {
namespace {

constexpr const char* kHill = R"({"id":"hill","crs":"EPSG:32617","duplicates":"reject",
  "vertices":[[500000,4500000,10],[500100,4500000,12.5],[500000,4500100,11],[500100,4500100,14],[500050,4500040,20]]})";

struct Row {
  Ask ask;
  int status;
};

class AnswersTest : public testing::Test {
 protected:
  AnswersTest()
      : server_([](server::Config& config) {
          config.limits.body_bytes_memory = 2048;
          config.limits.export_pixels = 1000;
          config.limits.positions_per_request = 5;
          config.limits.polygon_positions = 5;
          config.limits.contour_levels = 20;
          config.limits.answer_positions = 6;
        }) {
    EXPECT_EQ(server_.post_json("/tins", kHill).status, 201);
    EXPECT_EQ(server_.upload("/tins?id=grid&crs=EPSG:32617", "text/plain", ascii_grid(5, 4)).status, 201);
    EXPECT_EQ(server_.post_json("/tins", R"({"id":"empty"})").status, 201);
    EXPECT_EQ(server_.post_json("/tins", R"({"id":"local","vertices":[[0,0,1],[9,0,2],[0,9,3]]})").status,
              201);
  }

  void expect(const std::vector<Row>& rows) {
    for (const Row& row : rows) {
      const RawAnswer answer = server_.ask(row.ask);
      EXPECT_EQ(answer.status, row.status) << row.ask.method << " " << row.ask.target << "\n"
                                           << answer.body.substr(0, 300);
    }
  }

  std::string job_of(const RawAnswer& accepted) {
    EXPECT_EQ(accepted.status, 201) << accepted.body;
    return accepted.header("location");
  }

  void ask_service() {
    expect({{{"GET", "/"}, 200},
            {{"GET", "/", "", "", "Accept: text/html\r\n"}, 200},
            {{"GET", "/?a=1"}, 400},
            {{"GET", "/healthz"}, 200},
            {{"GET", "/healthz?a=1"}, 400},
            {{"GET", "/readyz"}, 200},
            {{"GET", "/readyz?a=1"}, 400},
            {{"GET", "/metrics"}, 200},
            {{"GET", "/metrics?a=1"}, 400},
            {{"GET", "/api"}, 200},
            {{"GET", "/api?a=1"}, 400},
            {{"GET", "/conformance"}, 200},
            {{"GET", "/conformance?a=1"}, 400},
            {{"GET", "/nothing"}, 404},
            {{"GET", "/tins/"}, 308},
            {{"GET", "/nothing/"}, 404},
            {{"POST", "/tins/", "application/json", "{}"}, 404},
            {{"OPTIONS", "/tins"}, 204},
            {{"HEAD", "/tins/hill"}, 200}});
  }

  void ask_tins() {
    const std::string big(3000, ' ');
    expect({{{"GET", "/tins"}, 200},
            {{"GET", "/tins?limit=1"}, 200},
            {{"GET", "/tins?limit=x"}, 400},
            {{"GET", "/tins?limit=0"}, 422},
            {{"POST", "/tins", "application/json", R"({"id":"new"})"}, 201},
            {{"POST", "/tins", "application/json", "{"}, 400},
            {{"POST", "/tins?id=x", "application/json", "{}"}, 400},
            {{"POST", "/tins", "application/json", R"({"id":"new"})"}, 409},
            {{"POST", "/tins", "application/json", big}, 413},
            {{"POST", "/tins", "image/tiff", "no terrain at all"}, 415},
            {{"POST", "/tins", "application/json", R"({"vertices":[[1e300,0,0],[0,0,0]]})"}, 422},
            {{"GET", "/tins/hill"}, 200},
            {{"GET", "/tins/empty"}, 200},
            {{"GET", "/tins/hill?a=1"}, 400},
            {{"GET", "/tins/none"}, 404},
            {{"PATCH", "/tins/hill", "application/json", R"({"title":"The hill"})"}, 200},
            {{"PATCH", "/tins/hill", "application/json", R"({"name":"x"})"}, 400},
            {{"PATCH", "/tins/none", "application/json", R"({"title":"x"})"}, 404},
            {{"PATCH", "/tins/hill", "text/plain", R"({"title":"x"})"}, 415},
            {{"PATCH", "/tins/hill", "application/json", R"({"title":"a\nb"})"}, 422},
            {{"DELETE", "/tins/new"}, 204},
            {{"DELETE", "/tins/new"}, 404},
            {{"DELETE", "/tins/hill?a=1"}, 400},
            {{"PUT", "/tins/hill", "application/json", "{}"}, 405}});
  }

  void ask_edits() {
    const std::string path = "/tins/hill/edits", json = "application/json";
    const std::string set_z = R"({"ops":[{"op":"set-z","id":1,"z":11}]})";
    expect({{{"POST", path, json, set_z}, 200},
            {{"POST", path, json, R"({"ops":[]})"}, 200},
            {{"POST", path, json,
              R"({"crs":"EPSG:4326","ops":[{"op":"insert","x":-80.9999,"y":40.651,"z":3}]})"},
             200},
            {{"POST", path, json, "[]"}, 400},
            {{"POST", "/tins/none/edits", json, set_z}, 404},
            {{"POST", path, json, R"({"ops":[{"op":"insert","x":500000,"y":4500000,"z":1}]})"}, 409},
            {{"POST", path, json, set_z, "If-Match: \"0-0\"\r\n"}, 412},
            {{"POST", path, json, set_z + std::string(3000, ' ')}, 413},
            {{"POST", path, "text/plain", set_z}, 415},
            {{"POST", path, json, R"({"ops":[{"op":"remove","id":99}]})"}, 422},
            {{"GET", path}, 405}});
  }

  void ask_history() {
    const std::string path = "/tins/hill", json = "application/json";
    const std::string undo = path + "/revisions/2/revert";
    expect({{{"GET", path + "/revisions"}, 200},
            {{"GET", path + "/revisions?limit=1"}, 200},
            {{"GET", "/tins/empty/revisions"}, 200},
            {{"GET", path + "/revisions?next=x"}, 400},
            {{"GET", "/tins/none/revisions"}, 404},
            {{"GET", path + "/revisions?limit=0"}, 422},
            {{"GET", path + "/changes"}, 200},
            {{"GET", path + "/changes?since=1&limit=1"}, 200},
            {{"GET", path + "/changes?since=x"}, 400},
            {{"GET", "/tins/none/changes"}, 404},
            {{"GET", path + "/changes?since=1000"}, 422},
            {{"POST", undo, json, "[]"}, 400},
            {{"POST", "/tins/none/revisions/2/revert"}, 404},
            {{"POST", path + "/revisions/1000/revert"}, 404},
            {{"POST", path + "/revisions/1/revert"}, 410},
            {{"POST", undo, json, "{}", "If-Match: \"0-0\"\r\n"}, 412},
            {{"POST", undo, "text/plain", "{}"}, 415},
            {{"POST", undo, json, R"({"note":"\u0001"})"}, 422},
            {{"POST", undo, json, R"({"author":"ada"})"}, 200},
            {{"POST", undo}, 409}});
    server_.forget_history("hill");
    expect({{{"GET", path + "/changes?since=1"}, 410}});
  }

  void ask_elevations() {
    const std::string path = "/tins/hill/elevation", json = "application/json";
    expect({{{"GET", path + "?x=500050&y=4500040"}, 200},
            {{"GET", path + "?x=0&y=0"}, 200},
            {{"GET", path + "?x=-81&y=40.6505&crs=EPSG:4326"}, 200},
            {{"GET", "/tins/grid/elevation?x=1&y=1&voids=fill"}, 200},
            {{"GET", path + "?x=1"}, 400},
            {{"GET", "/tins/none/elevation?x=1&y=1"}, 404},
            {{"GET", path + "?x=1e999&y=1"}, 422},
            {{"POST", path, json, R"({"positions":[[500050,4500040],[0,0]]})"}, 200},
            {{"POST", path, json, R"({"positions":[]})"}, 200},
            {{"POST", path, json, R"({"positions":[[1]]})"}, 400},
            {{"POST", "/tins/none/elevation", json, R"({"positions":[]})"}, 404},
            {{"POST", path, json, std::string(3000, ' ')}, 413},
            {{"POST", path, "text/plain", R"({"positions":[]})"}, 415},
            {{"POST", path, json, R"({"positions":[[1e999,0]]})"}, 422}});
  }

  void ask_slopes_and_lines() {
    const std::string path = "/tins/hill", json = "application/json", sight = "/tins/grid/line-of-sight";
    expect({{{"GET", path + "/slope?x=500050&y=4500020"}, 200},
            {{"GET", path + "/slope?x=0&y=0"}, 200},
            {{"GET", path + "/slope?x=0"}, 400},
            {{"GET", "/tins/none/slope?x=0&y=0"}, 404},
            {{"GET", path + "/slope?x=0&y=0&voids=some"}, 422},
            {{"POST", path + "/slope", json, R"({"positions":[[500050,4500020],[0,0]]})"}, 200},
            {{"POST", path + "/slope", json, R"({"positions":1})"}, 400},
            {{"POST", "/tins/none/slope", json, R"({"positions":[]})"}, 404},
            {{"POST", path + "/slope", json, std::string(3000, ' ')}, 413},
            {{"POST", path + "/slope", "text/plain", "{}"}, 415},
            {{"POST", path + "/slope", json, R"({"positions":[],"crs":"EPSG:1"})"}, 422},
            {{"GET", path + "/profile?coords=500010,4500010,500020,4500020"}, 200},
            {{"GET", path + "/profile?coords=500010"}, 400},
            {{"GET", "/tins/none/profile?coords=0,0"}, 404},
            {{"GET", "/tins/grid/profile?coords=0.5,0.5,4.5,3.4"}, 413},
            {{"GET", path + "/profile?coords=1e300,0,1,1"}, 422},
            {{"POST", path + "/profile", json, R"({"positions":[[500010,4500010],[0,4500020]]})"}, 200},
            {{"POST", path + "/profile", json, R"({"positions":[[1]]})"}, 400},
            {{"POST", "/tins/none/profile", json, R"({"positions":[]})"}, 404},
            {{"POST", "/tins/grid/profile", json, R"({"positions":[[0.5,0.5],[4.5,3.4]]})"}, 413},
            {{"POST", path + "/profile", "text/plain", "{}"}, 415},
            {{"POST", path + "/profile", json, R"({"positions":[]})"}, 422},
            {{"GET", sight + "?observer=1,1&target=2,1&observer-height=2"}, 200},
            {{"GET", sight + "?observer=1,1"}, 400},
            {{"GET", "/tins/none/line-of-sight?observer=1,1&target=2,1"}, 404},
            {{"GET", sight + "?observer=0.5,0.5&target=4.5,3.4"}, 413},
            {{"GET", sight + "?observer=1,1&target=9,9"}, 422}});
  }

  void ask_contours_and_volumes() {
    const std::string path = "/tins/hill";
    expect({{{"GET", path + "/contours?interval=2"}, 200},
            {{"GET", path + "/contours?levels=12,13.5&crs=EPSG:32617&bbox=500000,4500000,500050,4500100"}, 200},
            {{"GET", "/tins/local/contours?interval=1"}, 200},
            {{"GET", "/tins/empty/contours?interval=1"}, 200},
            {{"GET", path + "/contours?interval=x"}, 400},
            {{"GET", "/tins/none/contours?interval=1"}, 404},
            {{"GET", path + "/contours?interval=0.01"}, 413},
            {{"GET", path + "/contours"}, 422},
            {{"GET", path + "/volume?level=12"}, 200},
            {{"GET", path + "/volume?level=12&bbox=500000,4500000,500050,4500100"}, 200},
            {{"GET", "/tins/empty/volume?level=12"}, 200},
            {{"GET", path + "/volume"}, 400},
            {{"GET", "/tins/none/volume?level=12"}, 404},
            {{"GET", path + "/volume?level=12&polygon=0,0,1,0,2,0,2,1,2,2,0,2"}, 413},
            {{"GET", path + "/volume?level=12&polygon=0,0,1,0,2,0"}, 422},
            {{"GET", path + "/surface-area"}, 200},
            {{"GET", "/tins/local/surface-area?polygon=1,1,5,1,1,5"}, 200},
            {{"GET", path + "/surface-area?bbox=1"}, 400},
            {{"GET", "/tins/none/surface-area"}, 404},
            {{"GET", path + "/surface-area?polygon=0,0,1,0,2,0,2,1,2,2,0,2"}, 413},
            {{"GET", path + "/surface-area?bbox=0,0,1,1&polygon=0,0,1,0,1,1"}, 422}});
  }

  void ask_collections() {
    const std::string path = "/tins/hill/collections";
    expect({{{"GET", path}, 200},
            {{"GET", "/tins/empty/collections"}, 200},
            {{"GET", path + "?a=1"}, 400},
            {{"GET", "/tins/none/collections"}, 404},
            {{"GET", path + "/vertices"}, 200},
            {{"GET", path + "/triangles"}, 200},
            {{"GET", path + "/vertices?a=1"}, 400},
            {{"GET", path + "/edges"}, 200},
            {{"GET", path + "/vertices", "", "", "Accept: text/html\r\n"}, 200},
            {{"GET", path + "/faces"}, 404},
            {{"GET", path + "/edges/schema"}, 200},
            {{"GET", path + "/vertices/schema"}, 200},
            {{"GET", path + "/triangles/schema"}, 200},
            {{"GET", path + "/edges/schema?a=1"}, 400},
            {{"GET", path + "/faces/schema"}, 404},
            {{"GET", path + "/vertices/items/1"}, 200},
            {{"GET", path + "/triangles/items/1-2-3"}, 404},
            {{"GET", path + "/edges/items/1-2"}, 200},
            {{"GET", path + "/vertices/items/1?crs=EPSG:1"}, 400},
            {{"GET", path + "/vertices/items/99"}, 404},
            {{"GET", path + "/surface"}, 200},
            {{"GET", path + "/surface", "", "", "Accept: text/html\r\n"}, 200},
            {{"GET", path + "/surface?a=1"}, 400},
            {{"GET", "/tins/empty/collections/surface"}, 404},
            {{"GET", path + "/surface/coverage?scale-size=x(9),y(9)"}, 200},
            {{"GET", path + "/surface/coverage?scale-size=x"}, 400},
            {{"GET", "/tins/local/collections/surface/coverage"}, 404},
            {{"GET", path + "/surface/coverage?scale-size=x(900),y(900)"}, 413},
            {{"GET", path + "/surface/position?coords=POINT(-81%2040.65)"}, 200},
            {{"GET", path + "/surface/position?coords=POINT"}, 400},
            {{"GET", "/tins/local/collections/surface/position?coords=POINT(1%201)"}, 404},
            {{"GET", path + "/surface/position?coords=MULTIPOINT(1%201,1%201,1%201,1%201,1%201,1%201)"}, 413},
            {{"GET", path + "/surface/trajectory?coords=LINESTRING(-81%2040.65,-80.999%2040.651)"}, 200},
            {{"GET", path + "/surface/trajectory"}, 400},
            {{"GET", "/tins/local/collections/surface/trajectory"}, 404},
            {{"GET",
              "/tins/grid/collections/surface/"
              "trajectory?coords=LINESTRING(0.5%200.5,4.5%203.4)&crs=EPSG:32617"},
             413},
            {{"GET", path + "/surface/trajectory?coords=LINESTRING(-81%2040.65,99%2040.651)"}, 422},
            {{"GET",
              path + "/surface/area?coords=POLYGON((-81%2040.65,-80.99%2040.65,-80.99%2040.66,-81%2040.65))"},
             200},
            {{"GET", path + "/surface/area?coords=POLYGON((1%201,2%201,2%202,1%201))"}, 204},
            {{"GET", path + "/surface/area"}, 400},
            {{"GET", "/tins/local/collections/surface/area"}, 404},
            {{"GET", path + "/surface/area?coords=POLYGON((1%201,2%201,2%202,1%202,0%202,1%201))"}, 413},
            {{"GET", path + "/surface/cube?bbox=-81,40.65,-80.99,40.66"}, 200},
            {{"GET", path + "/surface/cube?bbox=1,1,2,2"}, 204},
            {{"GET", path + "/surface/cube?bbox=1"}, 400},
            {{"GET", "/tins/local/collections/surface/cube?bbox=1,1,2,2"}, 404},
            {{"GET", path + "/surface/cube?bbox=-81,40.65,-80.99,40.66&resolution-x=4&resolution-y=2"}, 413},
            {{"GET", path + "/surface/coverage/domainset"}, 200},
            {{"GET", path + "/surface/coverage/domainset?a=1"}, 400},
            {{"GET", "/tins/local/collections/surface/coverage/domainset"}, 404},
            {{"GET", path + "/surface/coverage/rangetype"}, 200},
            {{"GET", path + "/surface/coverage/rangetype?a=1"}, 400},
            {{"GET", "/tins/empty/collections/surface/coverage/rangetype"}, 404},
            {{"GET", "/tins/hill/conformance"}, 200},
            {{"GET", "/tins/hill/conformance?a=1"}, 400},
            {{"GET", "/tins/none/conformance"}, 404},
            {{"GET", "/tins/hill/api"}, 200},
            {{"GET", "/tins/hill/api?a=1"}, 400},
            {{"GET", "/tins/none/api"}, 404},
            {{"GET", path + "/vertices/items"}, 200},
            {{"GET", path + "/triangles/items?limit=1"}, 200},
            {{"GET", "/tins/local/collections/triangles/items"}, 200},
            {{"GET", "/tins/empty/collections/triangles/items"}, 200},
            {{"GET", path + "/vertices/items?bbox=-82,40,-80,41"}, 200},
            {{"GET", path + "/vertices/items?bbox=1"}, 400},
            {{"GET", path + "/vertices/items?next=abc"}, 400},
            {{"GET", path + "/edges/items"}, 200},
            {{"GET", path + "/faces/items"}, 404},
            {{"GET", path + "/vertices/items?next=999.1.0.0"}, 410},
            {{"GET", path + "/vertices/items?limit=0"}, 400}});
  }

  void ask_tiles() {
    const std::string path = "/tins/hill/";
    expect({{{"GET", path + "terrain/layer.json"}, 200},
            {{"GET", path + "terrain/layer.json?a=1"}, 400},
            {{"GET", "/tins/empty/terrain/layer.json"}, 404},
            {{"GET", "/tins/local/terrain/layer.json"}, 404},
            {{"GET", path + "terrain/0/0/0.terrain?v=1"}, 200},
            {{"GET", path + "terrain/0/1/0.terrain", "", "", "Accept-Encoding: gzip\r\n"}, 200},
            {{"GET", path + "terrain/0/0/0.terrain?v=x"}, 400},
            {{"GET", path + "terrain/0/2/0.terrain"}, 404},
            {{"GET", path + "terrain/99/0/0.terrain"}, 404},
            {{"GET", path + "terrain/a/0/0.terrain"}, 404},
            {{"GET", path + "dem/terrarium/tilejson.json"}, 200},
            {{"GET", path + "dem/mapbox/tilejson.json"}, 200},
            {{"GET", path + "dem/other/tilejson.json"}, 404},
            {{"GET", path + "dem/mapbox/tilejson.json?a=1"}, 400},
            {{"GET", path + "dem/terrarium/0/0/0.png"}, 200},
            {{"GET", path + "dem/mapbox/0/0/0.png?v=0"}, 200},
            {{"GET", path + "dem/mapbox/0/0/0.png?v="}, 400},
            {{"GET", path + "dem/mapbox/0/1/0.png"}, 404},
            {{"GET", path + "hillshade/tilejson.json"}, 200},
            {{"GET", path + "hillshade/tilejson.json?a=1"}, 400},
            {{"GET", "/tins/local/hillshade/tilejson.json"}, 404},
            {{"GET", path + "hillshade/0/0/0.png"}, 200},
            {{"GET", path + "hillshade/0/0/0.png?a=1"}, 400},
            {{"GET", path + "hillshade/0/0/1.png"}, 404}});
  }

  void ask_vertices() {
    const std::string items = "/tins/hill/collections/vertices/items", one = items + "/1", geo = "application/geo+json";
    const std::string any = "If-Match: *\r\n", patch = "application/merge-patch+json";
    const auto point = [](const std::string& at) {
      return R"({"type":"Feature","geometry":{"type":"Point","coordinates":[)" + at + R"(]},"properties":{}})";
    };
    const std::string inside = point("-80.9997,40.6505,15"), big(3000, ' ');
    expect({{{"POST", items, geo, inside}, 201},
            {{"POST", items, geo, "{"}, 400},
            {{"POST", "/tins/none/collections/vertices/items", geo, inside}, 404},
            {{"POST", items, geo, inside}, 409},
            {{"POST", items, geo, big}, 413},
            {{"POST", items, "text/plain", inside}, 415},
            {{"POST", items, geo, point("-81,40.65")}, 422},
            {{"PUT", one, geo, point("-81,40.6502,3"), any}, 204},
            {{"PUT", one, geo, "{}", any}, 400},
            {{"PUT", items + "/99", geo, inside, any}, 404},
            {{"PUT", one, geo, inside, any}, 409},
            {{"PUT", one, geo, inside, "If-Match: \"x\"\r\n"}, 412},
            {{"PUT", one, geo, big, any}, 413},
            {{"PUT", one, "text/plain", inside, any}, 415},
            {{"PUT", one, geo, point("0,0,3"), any}, 422},
            {{"PUT", one, geo, inside}, 428},
            {{"PATCH", one, patch, R"({"properties":{"z":4}})", any}, 204},
            {{"PATCH", one, patch, R"({"properties":{"z":"4"}})", any}, 400},
            {{"PATCH", items + "/99", patch, R"({"properties":{"z":4}})", any}, 404},
            {{"PATCH", one, patch, inside, any}, 409},
            {{"PATCH", one, patch, inside, "If-Match: \"x\"\r\n"}, 412},
            {{"PATCH", one, patch, big, any}, 413},
            {{"PATCH", one, "text/plain", inside, any}, 415},
            {{"PATCH", one, patch, "{}", any}, 422},
            {{"PATCH", one, patch, R"({"properties":{"z":4}})"}, 428},
            {{"DELETE", one}, 428},
            {{"DELETE", one, "", "", "If-Match: \"x\"\r\n"}, 412},
            {{"DELETE", one + "?a=1", "", "", any}, 400},
            {{"DELETE", one, "", "", any}, 204},
            {{"DELETE", one, "", "", any}, 404}});
  }

  void ask_exports() {
    const std::string path = "/tins/grid/export";
    expect({{{"GET", path}, 200},
            {{"GET", path + "?f=geotiff&cell-size=0.5"}, 200},
            {{"GET", path + "?layer=hillshade&azimuth=90&altitude=30&exaggeration=2"}, 200},
            {{"GET", path + "?interpolation=natural-neighbour&cell-size=0.5"}, 200},
            {{"GET", path + "?f=geojson"}, 200},
            {{"GET", path + "?f=geojson&collection=vertices&crs=EPSG:32617"}, 200},
            {{"GET", path + "?f=geojson&crs=EPSG:4326"}, 200},
            {{"GET", path + "?cell-size=x"}, 400},
            {{"GET", "/tins/none/export"}, 404},
            {{"GET", path + "?cell-size=0.001"}, 413},
            {{"GET", path + "?f=bmp"}, 422},
            {{"GET", path + "?crs=EPSG:1"}, 422},
            {{"GET", "/tins/empty/export"}, 422}});
  }

  void ask_processes() {
    const std::string path = "/processes/simplify/execution", json = "application/json",
                      async = "Prefer: respond-async\r\n";
    const auto to = [](const std::string& goal) { return R"({"inputs":{"tin":"grid",)" + goal + "}}"; };
    expect({{{"GET", "/processes"}, 200},
            {{"GET", "/processes?a=1"}, 400},
            {{"GET", "/processes?limit=1"}, 200},
            {{"GET", "/processes?limit=0"}, 400},
            {{"GET", "/processes/simplify"}, 200},
            {{"GET", "/processes/simplify?a=1"}, 400},
            {{"GET", "/processes/none"}, 404},
            {{"POST", path, json, to(R"("tolerance":5,"as":"grid-5")")}, 200},
            {{"POST", path, json, to(R"("maxVertices":8,"as":"grid-8")"), async}, 201},
            {{"POST", path, json, to(R"("tolerance":5,"as":"grid-fit","elevations":"fit","keepFlat":true)")}, 200},
            {{"POST", path, json, to(R"("tolerance":5,"as":"grid-all","against":"surface","keepFlat":4)")}, 200},
            {{"POST", path, json, to(R"("tolerance":5,"elevations":"any")")}, 422},
            {{"POST", path, json, to(R"("tolerance":"5")")}, 400},
            {{"POST", path, json, R"({"inputs":{"tin":"none","tolerance":1}})"}, 404},
            {{"POST", path, json, to(R"("tolerance":5,"as":"hill")")}, 409},
            {{"POST", path, json, std::string(3000, ' ')}, 413},
            {{"POST", path, "text/plain", "{}"}, 415},
            {{"POST", path, json, to(R"("tolerance":-1)")}, 422}});
    // A request that waits for its job learns that somebody dismissed it.
    auto busy = server_.occupy_worker();
    std::thread waiting([&] { expect({{{"POST", path, json, to(R"("tolerance":1,"as":"never")")}, 410}}); });
    for (std::string id; id.empty();) {
      const Json list = Json::parse(support::HttpClient(server_.port()).get("/jobs").body);
      for (const Json& job : list.at("jobs")) {
        if (job.at("status") == "accepted") id = job.at("jobID");
      }
      if (id.empty()) continue;
      EXPECT_EQ(support::HttpClient(server_.port()).remove("/jobs/" + id).status, 200);
    }
    waiting.join();
    EXPECT_EQ(server_.get("/tins/never").status, 404);
  }

  void ask_jobs() {
    const std::string async = "Prefer: respond-async\r\n";
    auto busy = server_.occupy_worker();
    const auto flat = job_of(
        server_.upload("/tins?id=flat", "text/plain", ascii_grid({{-9999, -9999}, {-9999, -9999}}), async));
    const auto made = job_of(server_.upload("/tins?id=made", "text/plain", ascii_grid(3, 3), async));
    const auto gone = job_of(server_.upload("/tins?id=gone", "text/plain", ascii_grid(3, 3), async));
    expect({{{"GET", "/jobs"}, 200},
            {{"GET", "/jobs?a=1"}, 400},
            {{"GET", made}, 200},
            {{"GET", made + "?a=1"}, 400},
            {{"GET", "/jobs/none"}, 404},
            {{"GET", made + "/results"}, 404},
            {{"GET", made + "/results?a=1"}, 400},
            {{"DELETE", gone + "?a=1"}, 400},
            {{"DELETE", gone}, 200},
            {{"DELETE", "/jobs/none"}, 404},
            {{"GET", gone + "/results"}, 410}});
    busy.reset();
    EXPECT_EQ(server_.finished(made), "successful");
    expect(
        {{{"GET", made + "/results"}, 200}, {{"GET", flat + "/results"}, 422}, {{"GET", "/tins/gone"}, 404}});
  }

  TestServer server_;
};

TEST_F(AnswersTest, EveryDocumentedStatusIsGivenAndFitsItsSchema) {
  ask_service();
  ask_tins();
  ask_edits();
  ask_history();
  ask_elevations();
  ask_slopes_and_lines();
  ask_contours_and_volumes();
  ask_collections();
  ask_tiles();
  ask_vertices();
  ask_exports();
  ask_processes();
  ask_jobs();
  for (const std::string& status : documented_statuses()) {
    EXPECT_TRUE(server_.answered().contains(status))
        << status << " is documented and nothing here is answered with it";
  }
  EXPECT_EQ(server_.leftovers(), std::set<std::string>{});
}

}  // namespace
}  // namespace tests::contract
