// Bad input gets a problem document and changes nothing: no TIN, no revision, no digest, no file left behind.
#include <gtest/gtest.h>

#include "tests/contract/test_server.h"

namespace tests::contract {
namespace {

constexpr const char* kJson = "application/json";

class BadInputTest : public testing::Test {
 protected:
  BadInputTest()
      : server_([](server::Config& config) {
          config.limits.raster_pixels = 400;
          config.limits.body_bytes_memory = 1 << 20;
        }) {
    EXPECT_EQ(
        server_
            .post_json("/tins", R"({"id":"hill","vertices":[[0,0,1],[10,0,2],[0,10,3],[10,10,4],[5,5,9]]})")
            .status,
        201);
    EXPECT_EQ(server_.post_json("/tins", R"({"id":"open"})").status, 201);
    EXPECT_EQ(server_.upload("/tins?id=grid&crs=EPSG:32617", "text/plain", ascii_grid(4, 4)).status, 201);
    EXPECT_EQ(server_.leftovers(), std::set<std::string>{});
    before_ = server_.state();
  }

  /// The request is refused in this way, and all is as before.
  RawAnswer expect_refused(const Ask& ask, int status, const std::string& kind,
                           const std::string& where = "?") {
    const RawAnswer answer = server_.ask(ask);
    const std::string about =
        ask.method + " " + ask.target + " " + ask.body.substr(0, 120) + "\n-> " + answer.body.substr(0, 400);
    EXPECT_EQ(answer.status, status) << about;
    EXPECT_EQ(slug(answer), kind) << about;
    if (where != "?") {
      const Json problem = Json::parse(answer.body, nullptr, false);
      EXPECT_EQ(problem.is_object() ? problem.value("where", "") : "", where) << about;
    }
    EXPECT_TRUE(server_.state() == before_) << about;
    EXPECT_EQ(server_.leftovers(), std::set<std::string>{}) << about;
    return answer;
  }

  void refuse_edit(const std::string& body, int status, const std::string& kind,
                   const std::string& where = "?") {
    expect_refused({"POST", "/tins/hill/edits", kJson, body}, status, kind, where);
  }
  void refuse_tin(const std::string& body, int status, const std::string& kind,
                  const std::string& where = "?") {
    expect_refused({"POST", "/tins", kJson, body}, status, kind, where);
  }
  void refuse_file(const std::string& query, const std::string& type, const std::string& body, int status,
                   const std::string& kind) {
    expect_refused({"POST", "/tins" + query, type, body}, status, kind);
    expect_async_failure(query, type, body, kind);
  }

  /// The same file as a job: accepted, then failed with the same problem.
  void expect_async_failure(const std::string& query, const std::string& type, const std::string& body,
                            const std::string& kind) {
    const RawAnswer accepted = server_.upload("/tins" + query, type, body, "Prefer: respond-async\r\n");
    if (accepted.status != 201) {
      EXPECT_EQ(slug(accepted), kind);
      return;
    }
    const std::string job = accepted.header("location");
    EXPECT_EQ(server_.finished(job), "failed");
    EXPECT_EQ(slug(server_.get(job + "/results")), kind);
    EXPECT_TRUE(server_.state() == before_);
    EXPECT_EQ(server_.leftovers(), std::set<std::string>{});
  }

  TestServer server_;
  std::string before_;
};

TEST_F(BadInputTest, MalformedJson) {
  for (const char* body :
       {"", "{", "nonsense", "{\"ops\":[}", "{\"ops\":[]} x", "{'ops':[]}", "{\"ops\":[],}",
        "{\"ops\":[],\"ops\":[]}", "{\"ops\":\"\xff\"}", "{\"ops\":[{\"op\":\"remove\",\"id\":01}]}"}) {
    refuse_edit(body, 400, "malformed");
    refuse_tin(body, 400, "malformed");
    expect_refused({"POST", "/processes/simplify/execution", kJson, body}, 400, "malformed");
    expect_refused({"POST", "/tins/hill/elevation", kJson, body}, 400, "malformed");
  }
}

TEST_F(BadInputTest, WrongTypesAreNamedByTheirPlace) {
  refuse_edit(R"([])", 400, "malformed");
  refuse_edit(R"({"ops":{}})", 400, "malformed", "/ops");
  refuse_edit(R"({"ops":[1]})", 400, "malformed", "/ops/0");
  refuse_edit(R"({"ops":[{"op":"insert","x":"1","y":1,"z":1}]})", 400, "malformed", "/ops/0/x");
  refuse_edit(R"({"ops":[{"op":"insert","x":1,"y":null,"z":1}]})", 400, "malformed", "/ops/0/y");
  refuse_edit(R"({"ops":[{"op":"remove","id":1.5}]})", 400, "malformed", "/ops/0/id");
  refuse_edit(R"({"ops":[{"op":"remove","id":"1"}]})", 400, "malformed", "/ops/0/id");
  refuse_edit(R"({"ops":[{"op":"insert","x":1,"y":1}]})", 400, "malformed");
  refuse_edit(R"({"ops":[{"op":"insert","x":1,"y":1,"z":1,"w":1}]})", 400, "malformed");
  refuse_edit(R"({"operations":[]})", 400, "malformed");
  refuse_edit(R"({"ops":[{"op":"explode","id":1}]})", 422, "invalid-value", "/ops/0/op");
  refuse_tin(R"({"vertices":[[1,2]]})", 400, "malformed", "/vertices/0");
  refuse_tin(R"({"vertices":[[1,2,"3"]]})", 400, "malformed", "/vertices/0/2");
  refuse_tin(R"({"resolution":0})", 422, "invalid-value", "/resolution");
  refuse_tin(R"({"id":"a b"})", 422, "invalid-value", "/id");
  refuse_tin(R"({"id":7})", 400, "malformed", "/id");
  refuse_tin(R"({"crs":"EPSG:1"})", 422, "invalid-value", "/crs");
  refuse_tin(R"({"duplicates":"perhaps"})", 422, "invalid-value", "/duplicates");
}

TEST_F(BadInputTest, NumbersThatAreNotFinite) {
  for (const char* token : {"NaN", "Infinity", "-Infinity", "nan", "inf", "+1", "0x10", ".5", "1."}) {
    refuse_edit(std::string(R"({"ops":[{"op":"insert","x":1,"y":1,"z":)") + token + "}]}", 400, "malformed");
    refuse_tin(std::string(R"({"vertices":[[1,1,)") + token + "]]}", 400, "malformed");
  }
  for (const char* token : {"1e999", "-1e999", "1e309"}) {
    refuse_edit(std::string(R"({"ops":[{"op":"set-z","id":1,"z":)") + token + "}]}", 422, "not-finite",
                "/ops/0/z");
    refuse_tin(std::string(R"({"vertices":[[1,)") + token + ",1]]}", 422, "not-finite", "/vertices/0/1");
    expect_refused(
        {"POST", "/tins/hill/elevation", kJson, std::string(R"({"positions":[[0,)") + token + "]]}"}, 422,
        "not-finite");
  }
  for (const char* token : {"nan", "inf", "1e999"}) {
    expect_refused({"GET", std::string("/tins/hill/elevation?y=1&x=") + token}, 422, "not-finite", "query:x");
  }
  expect_refused({"GET", "/tins/hill/elevation?x=1&y=abc"}, 400, "malformed", "query:y");
  expect_refused({"GET", "/tins/hill/elevation?x=&y=1"}, 400, "malformed", "query:x");
}

TEST_F(BadInputTest, PositionsOutsideTheLattice) {
  refuse_edit(R"({"ops":[{"op":"set-z","id":1,"z":8},{"op":"insert","x":1e9,"y":0,"z":0}]})", 422,
              "outside-lattice", "/ops/1");
  refuse_edit(R"({"ops":[{"op":"move","id":1,"x":0,"y":-1e300}]})", 422, "outside-lattice", "/ops/0");
  refuse_tin(R"({"origin":[0,0],"vertices":[[0,0,0],[1e9,0,0]]})", 422, "outside-lattice", "/vertices/1");
  refuse_tin(R"({"resolution":0.001,"vertices":[[0,0,0],[1e9,0,0]]})", 422, "invalid-value");
  refuse_tin(R"({"origin":[1e300,0]})", 422, "invalid-value");
}

TEST_F(BadInputTest, UnknownIds) {
  refuse_edit(R"({"ops":[{"op":"set-z","id":1,"z":8},{"op":"remove","id":6}]})", 422, "unknown-vertex",
              "/ops/1");
  refuse_edit(R"({"ops":[{"op":"remove","id":1},{"op":"set-z","id":1,"z":1}]})", 422, "unknown-vertex",
              "/ops/1");
  refuse_edit(R"({"ops":[{"op":"move","id":9007199254740992,"x":1,"y":1}]})", 422, "unknown-vertex",
              "/ops/0");
  refuse_edit(R"({"ops":[{"op":"remove","id":0}]})", 422, "invalid-value", "/ops/0/id");
  expect_refused({"POST", "/tins/none/edits", kJson, R"({"ops":[]})"}, 404, "not-found");
  expect_refused({"DELETE", "/tins/none"}, 404, "not-found");
  expect_refused(
      {"POST", "/processes/simplify/execution", kJson, R"({"inputs":{"tin":"none","tolerance":1}})"}, 404,
      "not-found", "/inputs/tin");
  expect_refused({"POST", "/processes/none/execution", kJson, "{}"}, 404, "no-such-process");
  expect_refused({"DELETE", "/jobs/none"}, 404, "no-such-job");
}

/// The frame of an empty TIN without an origin is fitted to the first vertices, but not to those of a refused
/// edit.
TEST_F(BadInputTest, ARefusedFirstEditLeavesAnEmptyTinAsItWas) {
  const std::string far = R"({"op":"insert","x":700000,"y":5000000,"z":1})";
  expect_refused({"POST", "/tins/open/edits", kJson, R"({"ops":[)" + far + R"(,{"op":"remove","id":7}]})"},
                 422, "unknown-vertex", "/ops/1");
  expect_refused({"POST", "/tins/open/edits", kJson,
                  R"({"ops":[)" + far + R"(,{"op":"insert","x":-1e300,"y":0,"z":1}]})"},
                 422, "invalid-value");
  const std::string near = R"({"ops":[{"op":"insert","x":1,"y":2,"z":3}]})";
  EXPECT_EQ(server_.post_json("/tins/open/edits", near).status, 200);
  EXPECT_EQ(server_.post_json("/tins", R"({"id":"fresh"})").status, 201);
  EXPECT_EQ(server_.post_json("/tins/fresh/edits", near).status, 200);
  EXPECT_EQ(server_.tin("open").at("digest"), server_.tin("fresh").at("digest"));
}

TEST_F(BadInputTest, FilesThatAreNotWhatTheySay) {
  const std::string named = "Content-Disposition: attachment; filename=\"dem.tif\"\r\n";
  expect_refused({"POST", "/tins", "image/tiff", "This is a text, and no elevation at all.\n", named}, 415,
                 "unsupported");
  refuse_file("?format=geotiff", "image/tiff", "This is a text.\n", 415, "unsupported");
  refuse_file("", "image/tiff", std::string("II*\0\x08\0\0\0\0\0\0\0", 12), 400, "malformed");
  refuse_file("", "application/geo+json", "{\"type\":", 400, "malformed");
  refuse_file("", "application/octet-stream", std::string(2000, '\x07'), 415, "unsupported");
  refuse_file("?format=word", "text/plain", ascii_grid(3, 3), 415, "unsupported");
  refuse_file("", "text/plain", "", 422, "invalid-value");
}

TEST_F(BadInputTest, RastersWithoutATerrain) {
  const std::string frame = "xllcorner 0\nyllcorner 0\ncellsize 1\nNODATA_value -9999\n";
  refuse_file("", "text/plain", ascii_grid({{-9999, -9999}, {-9999, -9999}}), 422, "invalid-value");
  refuse_file("", "text/plain", ascii_grid(401, 1), 413, "too-large");
  refuse_file("", "text/plain", "ncols 0\nnrows 0\n" + frame, 400, "malformed");
  refuse_file("", "text/plain", "ncols 3\nnrows 3\n" + frame + "1 2 3\n4 5\n", 400, "malformed");
  refuse_file("", "text/plain", "ncols 2\nnrows 1\nxllcorner nan\nyllcorner 0\ncellsize 1\n1 2\n", 422,
              "not-finite");
  refuse_file("", "text/plain", "ncols 2\nnrows 1\nxllcorner 0\nyllcorner 0\ncellsize 0\n1 2\n", 422,
              "invalid-value");
}

TEST_F(BadInputTest, PointFilesWithoutNumbers) {
  refuse_file("", "text/csv", "x,y,z\na,b,c\nd,e,f\n", 400, "malformed");
  refuse_file("", "text/csv", "x,y,z\n1,2,3\n4,five,6\n", 400, "malformed");
  refuse_file("", "text/csv", "x,y,z\n", 422, "invalid-value");
  refuse_file("", "text/csv", "x,y,z\n1,2,1e999\n", 422, "not-finite");
  refuse_file("", "application/geo+json", R"({"type":"FeatureCollection","features":[]})", 422,
              "invalid-value");
}

TEST_F(BadInputTest, BadParametersOfAnUpload) {
  const std::string grid = ascii_grid(3, 3);
  for (const auto& [query, status, kind] : std::vector<std::tuple<std::string, int, std::string>>{
           {"?id=a%20b", 422, "invalid-value"},
           {"?id=", 422, "invalid-value"},
           {"?id=hill", 409, "conflict"},
           {"?crs=EPSG:1", 422, "invalid-value"},
           {"?crs=nonsense", 400, "malformed"},
           {"?resolution=0", 422, "invalid-value"},
           {"?resolution=x", 400, "malformed"},
           {"?resolution=-1", 422, "invalid-value"},
           {"?duplicates=perhaps", 422, "invalid-value"},
           {"?colour=red", 400, "unknown-parameter"},
           {"?id=a&id=b", 400, "malformed"},
           {"?title=" + std::string(513, 'a'), 413, "too-large"},
           {"?title=a%0Ab", 422, "invalid-value"}}) {
    refuse_file(query, "text/plain", grid, status, kind);
  }
}

TEST_F(BadInputTest, BodiesThatAreTooLarge) {
  const std::string big = R"({"ops":[)" + std::string(1 << 20, ' ') + "]}";
  refuse_edit(big, 413, "too-large");
  refuse_tin(big, 413, "too-large");
}

TEST_F(BadInputTest, UnknownQueryParametersEverywhere) {
  for (const char* target :
       {"/", "/api", "/tins", "/tins/hill", "/tins/hill/collections", "/tins/hill/collections/vertices/items",
        "/tins/hill/export", "/tins/hill/elevation", "/processes", "/jobs"}) {
    expect_refused({"GET", std::string(target) + "?colour=red"}, 400, "unknown-parameter", "query:colour");
  }
  expect_refused({"POST", "/tins/hill/edits?dry-run=1", kJson, R"({"ops":[{"op":"remove","id":1}]})"}, 400,
                 "unknown-parameter");
  expect_refused({"DELETE", "/tins/hill?really=1"}, 400, "unknown-parameter");
  expect_refused({"POST", "/tins?id=x", kJson, "{}"}, 400, "unknown-parameter", "query:id");
}

TEST_F(BadInputTest, MethodsThatAResourceDoesNotHave) {
  for (const auto& [method, target] :
       std::vector<std::pair<std::string, std::string>>{{"DELETE", "/tins"},
                                                        {"PUT", "/tins/hill"},
                                                        {"POST", "/tins/hill"},
                                                        {"GET", "/tins/hill/edits"},
                                                        {"DELETE", "/tins/hill/collections/vertices/items"},
                                                        {"POST", "/tins/hill/export"},
                                                        {"PUT", "/jobs"},
                                                        {"DELETE", "/"}}) {
    expect_refused({method, target}, 405, "method-not-allowed");
  }
  expect_refused({"BREW", "/tins/hill"}, 501, "not-implemented");
}

TEST_F(BadInputTest, BodiesOfTheWrongType) {
  const std::string remove = R"({"ops":[{"op":"remove","id":1}]})";
  for (const char* type :
       {"", "text/plain", "application/x-www-form-urlencoded", "application/jsonp", "image/tiff"}) {
    expect_refused({"POST", "/tins/hill/edits", type, remove}, 415, "unsupported", "header:Content-Type");
    expect_refused(
        {"POST", "/processes/simplify/execution", type, R"({"inputs":{"tin":"hill","maxVertices":3}})"}, 415,
        "unsupported");
  }
  expect_refused({"POST", "/tins", "multipart/form-data; boundary=x", "--x\r\n\r\n{}\r\n--x--\r\n"}, 415,
                 "unsupported");
  expect_refused({"GET", "/tins/hill", kJson, "{}"}, 400, "malformed");
}

TEST_F(BadInputTest, DeepNesting) {
  const std::string deep = std::string(100'000, '[') + std::string(100'000, ']');
  refuse_edit(R"({"ops":)" + deep + "}", 400, "malformed");
  refuse_tin(R"({"vertices":)" + deep + "}", 400, "malformed");
  refuse_file("", "application/geo+json", R"({"type":"FeatureCollection","features":)" + deep + "}", 400,
              "malformed");
  std::string objects;
  for (int i = 0; i < 50'000; ++i) objects += R"({"inputs":)";
  expect_refused({"POST", "/processes/simplify/execution", kJson, objects}, 400, "malformed");
}

TEST_F(BadInputTest, ImpossibleSimplifications) {
  const auto refuse = [&](const std::string& inputs, int status, const std::string& kind,
                          const std::string& where) {
    expect_refused({"POST", "/processes/simplify/execution", kJson, R"({"inputs":)" + inputs + "}"}, status,
                   kind, where);
  };
  refuse(R"({"tin":"hill"})", 422, "invalid-value", "/inputs");
  refuse(R"({"tin":"hill","tolerance":-1})", 422, "invalid-value", "/inputs/tolerance");
  refuse(R"({"tin":"hill","tolerance":1e999})", 422, "not-finite", "/inputs/tolerance");
  refuse(R"({"tin":"hill","maxVertices":2})", 422, "invalid-value", "/inputs/maxVertices");
  refuse(R"({"tin":"hill","tolerance":1,"as":"hill"})", 409, "conflict", "/inputs/as");
  refuse(R"({"tin":"hill","tolerance":1,"as":"../x"})", 422, "invalid-value", "/inputs/as");
  refuse(R"({"tolerance":1})", 400, "malformed", "/inputs");
}

TEST_F(BadInputTest, ImpossibleExportsAndBoxes) {
  for (const auto& [query, status, kind] : std::vector<std::tuple<std::string, int, std::string>>{
           {"f=bmp", 422, "invalid-value"},
           {"cell-size=0", 422, "invalid-value"},
           {"cell-size=-1", 422, "invalid-value"},
           {"cell-size=nan", 422, "not-finite"},
           {"bbox=1,2,3", 400, "malformed"},
           {"bbox=5,5,1,1", 422, "invalid-value"},
           {"bbox=0,0,1,inf", 422, "not-finite"},
           {"crs=EPSG:99999", 422, "invalid-value"},
           {"crs=EPSG", 400, "malformed"},
           {"collection=faces", 422, "invalid-value"},
           {"voids=perhaps", 422, "invalid-value"},
           {"bbox=900,900,901,901", 422, "invalid-value"}}) {
    expect_refused({"GET", "/tins/grid/export?" + query}, status, kind);
  }
  expect_refused({"GET", "/tins/hill/export?crs=EPSG:4326"}, 422, "invalid-value", "query:crs");
  expect_refused({"GET", "/tins/open/export"}, 422, "invalid-value");
  expect_refused({"GET", "/tins/hill/collections/vertices/items?bbox=5,5,1,1"}, 400, "malformed", "query:bbox");
}

}  // namespace
}  // namespace tests::contract
