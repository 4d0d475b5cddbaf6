#include <gtest/gtest.h>

#include <cstdlib>
#include <random>

#include "proto/messages.h"
#include "proto/processes/simplify.h"
#include "tests/proto/expect_errors.h"
#include "tests/support/schema_check.h"

namespace {

using tests_support::expect_errors;
using tin::base::Code;
using tin::base::Error;
using tin::terrain::Duplicates;

TEST(CreateTinTest, ReadsEveryMember) {
  const auto create =
      proto::read_create_tin(
          R"({"id":"a-1_B","title":"Höhe","crs":"urn:ogc:def:crs:EPSG::32617","resolution":[0.001,0.002],)"
          R"("origin":[5,6],"duplicates":"max","vertices":[[1,2,3],[4,5,-6.5]]})",
          2)
          .value();
  EXPECT_EQ(create.id, "a-1_B");
  EXPECT_EQ(create.title, "Höhe");
  EXPECT_EQ(create.crs, "EPSG:32617");
  EXPECT_EQ(create.resolution, (std::array<double, 2>{0.001, 0.002}));
  EXPECT_EQ(create.origin, (proto::Position2{5, 6}));
  EXPECT_EQ(create.duplicates, Duplicates::kMax);
  EXPECT_EQ(create.vertices, (std::vector<proto::Position>{{1, 2, 3}, {4, 5, -6.5}}));
}

TEST(CreateTinTest, NothingMakesAnEmptyTin) {
  const auto create = proto::read_create_tin("{}", 0).value();
  EXPECT_FALSE(create.id || create.title || create.crs || create.resolution || create.origin);
  EXPECT_EQ(create.duplicates, Duplicates::kReplace);
  EXPECT_TRUE(create.vertices.empty());
  EXPECT_EQ(proto::read_create_tin(R"({"resolution":0.5})", 0)->resolution,
            (std::array<double, 2>{0.5, 0.5}));
}

TEST(CreateTinTest, ErrorsSayWhere) {
  expect_errors(
      {
          {"[]", Code::kMalformed, ""},
          {"null", Code::kMalformed, ""},
          {R"({"name":"x"})", Code::kMalformed, "/name"},
          {R"({"id":7})", Code::kMalformed, "/id"},
          {R"({"id":null})", Code::kMalformed, "/id"},
          {R"({"id":""})", Code::kInvalidValue, "/id"},
          {R"({"id":"-a"})", Code::kInvalidValue, "/id"},
          {R"({"id":"a/b"})", Code::kInvalidValue, "/id"},
          {R"({"id":"a\u0000"})", Code::kInvalidValue, "/id"},
          {R"({"title":"a\nb"})", Code::kInvalidValue, "/title"},
          {R"({"crs":"WGS84"})", Code::kMalformed, "/crs"},
          {R"({"crs":4326})", Code::kMalformed, "/crs"},
          {R"({"resolution":0})", Code::kInvalidValue, "/resolution"},
          {R"({"resolution":[1,-1]})", Code::kInvalidValue, "/resolution"},
          {R"({"resolution":[1]})", Code::kMalformed, "/resolution"},
          {R"({"resolution":"1"})", Code::kMalformed, "/resolution"},
          {R"({"resolution":[1,1e999]})", Code::kNotFinite, "/resolution/1"},
          {R"({"origin":[1,"2"]})", Code::kMalformed, "/origin/1"},
          {R"({"duplicates":"sum"})", Code::kInvalidValue, "/duplicates"},
          {R"({"vertices":[[1,2,3],[1,2]]})", Code::kMalformed, "/vertices/1"},
          {R"({"vertices":[[1,2,null]]})", Code::kMalformed, "/vertices/0/2"},
          {R"({"vertices":[[1,2,NaN]]})", Code::kMalformed, ""},
          {R"({"vertices":[[1,-1e400,3]]})", Code::kNotFinite, "/vertices/0/1"},
          {R"({"vertices":[[1,2,3],[1,2,3],[1,2,3]]})", Code::kTooLarge, "/vertices"},
          {R"({"vertices":{}})", Code::kMalformed, "/vertices"},
      },
      [](const char* body) { return proto::read_create_tin(body, 2); });
}

TEST(TinIdTest, FollowsItsPattern) {
  EXPECT_TRUE(proto::is_tin_id("a"));
  EXPECT_TRUE(proto::is_tin_id(std::string(64, '9')));
  for (const std::string& id : {std::string(), std::string(65, 'a'), std::string("_a"), std::string("a b"),
                                std::string(".."), std::string("\xc3\xa9")}) {
    EXPECT_FALSE(proto::is_tin_id(id)) << id;
  }
}

TEST(EditRequestTest, ReadsEveryOp) {
  const auto request =
      proto::read_edit_request(
          R"({"crs":"EPSG:4326","ops":[{"op":"insert","x":1,"y":2.5,"z":-3},{"id":7,"op":"remove"},)"
          R"({"op":"move","id":9007199254740992,"x":1e3,"y":0},{"op":"set-z","id":8,"z":4},)"
          R"({"op":"remove-within","polygon":[[1,2],[3,4],[5.5,6]]}]})",
          {5, 1, 3})
          .value();
  EXPECT_EQ(request.crs, "EPSG:4326");
  ASSERT_EQ(request.ops.size(), 5U);
  EXPECT_EQ(std::get<proto::RemoveWithinOp>(request.ops[4]).polygon,
            (std::vector<proto::Position2>{{1, 2}, {3, 4}, {5.5, 6}}));
  const auto& insert = std::get<proto::InsertOp>(request.ops[0]);
  EXPECT_EQ(std::tie(insert.x, insert.y, insert.z), std::make_tuple(1, 2.5, -3));
  EXPECT_EQ(std::get<proto::RemoveOp>(request.ops[1]).id.value(), 7U);
  const auto& move = std::get<proto::MoveOp>(request.ops[2]);
  EXPECT_EQ(move.id.value(), std::uint64_t{1} << 53);
  EXPECT_EQ(move.x, 1000);
  EXPECT_EQ(std::get<proto::SetZOp>(request.ops[3]).z, 4);
  EXPECT_TRUE(proto::read_edit_request(R"({"ops":[]})", {0, 3, 100})->ops.empty());
}

TEST(EditRequestTest, ErrorsSayWhere) {
  expect_errors(
      {
          {"{}", Code::kMalformed, ""},
          {R"({"ops":{}})", Code::kMalformed, "/ops"},
          {R"({"ops":[],"duplicates":"keep"})", Code::kMalformed, "/duplicates"},
          {R"({"ops":[7]})", Code::kMalformed, "/ops/0"},
          {R"({"ops":[{}]})", Code::kMalformed, "/ops/0"},
          {R"({"ops":[{"op":1}]})", Code::kMalformed, "/ops/0/op"},
          {R"({"ops":[{"op":"remove-all"}]})", Code::kInvalidValue, "/ops/0/op"},
          {R"({"ops":[{"op":"remove","id":1},{"op":"insert","x":"1","y":2,"z":3}]})", Code::kMalformed,
           "/ops/1/x"},
          {R"({"ops":[{"op":"insert","x":1,"z":3}]})", Code::kMalformed, "/ops/0"},
          {R"({"ops":[{"op":"insert","x":1,"y":2,"z":1e999}]})", Code::kNotFinite, "/ops/0/z"},
          {R"({"ops":[{"op":"remove","id":1,"x":3}]})", Code::kMalformed, "/ops/0/x"},
          {R"({"ops":[{"op":"remove","id":0}]})", Code::kInvalidValue, "/ops/0/id"},
          {R"({"ops":[{"op":"remove","id":-1}]})", Code::kInvalidValue, "/ops/0/id"},
          {R"({"ops":[{"op":"remove","id":1.5}]})", Code::kMalformed, "/ops/0/id"},
          {R"({"ops":[{"op":"remove","id":1e300}]})", Code::kInvalidValue, "/ops/0/id"},
          {R"({"ops":[{"op":"remove","id":9007199254740993}]})", Code::kInvalidValue, "/ops/0/id"},
          {R"({"ops":[{"op":"remove","id":"1"}]})", Code::kMalformed, "/ops/0/id"},
          {R"({"ops":[{"op":"remove","id":1,"id":2}]})", Code::kMalformed, "/ops/0/id"},
          {R"({"ops":[{"op":"remove","id":1},{"op":"remove","id":2},{"op":"remove","id":3}]})",
           Code::kTooLarge, "/ops"},
          {R"({"ops":[{"op":"remove-within"}]})", Code::kMalformed, "/ops/0"},
          {R"({"ops":[{"op":"remove-within","polygon":[[1,2],[3,4]]}]})", Code::kInvalidValue,
           "/ops/0/polygon"},
          {R"({"ops":[{"op":"remove-within","polygon":[[1,2],[3,4],[5]]}]})", Code::kMalformed,
           "/ops/0/polygon/2"},
          {R"({"ops":[{"op":"remove-within","polygon":[[1,2],[3,4],[5,6],[7,8],[9,0]]}]})", Code::kTooLarge,
           "/ops/0/polygon"},
          {R"({"ops":[{"op":"remove-within","polygon":[[1,2],[3,4],[5,6]],"id":1}]})", Code::kMalformed,
           "/ops/0/id"},
          {R"({"ops":[{"op":"remove-within","polygon":[[1,2],[3,4],[5,6]]},)"
           R"({"op":"remove-within","polygon":[[1,2],[3,4],[5,6]]}]})",
           Code::kTooLarge, "/ops/1"},
      },
      [](const char* body) {
        return proto::read_edit_request(body, {2, 1, 4});
      });
}

TEST(ElevationRequestTest, ReadsPositionsAndSaysWhatIsWrong) {
  const auto request =
      proto::read_elevation_request(R"({"positions":[[1,2],[3,4]],"crs":"EPSG:1","voids":"fill"})", 2)
          .value();
  EXPECT_EQ(request.positions, (std::vector<proto::Position2>{{1, 2}, {3, 4}}));
  EXPECT_EQ(request.crs, "EPSG:1");
  EXPECT_EQ(request.voids, proto::Voids::kFill);
  expect_errors(
      {
          {"{}", Code::kMalformed, ""},
          {R"({"positions":[[1,2],[3,4],[5,6]]})", Code::kTooLarge, "/positions"},
          {R"({"positions":[[1,2,3]]})", Code::kMalformed, "/positions/0"},
          {R"({"positions":[[1,true]]})", Code::kMalformed, "/positions/0/1"},
          {R"({"positions":[],"voids":"maybe"})", Code::kInvalidValue, "/voids"},
          {R"({"positions":[],"crs":""})", Code::kMalformed, "/crs"},
      },
      [](const char* body) { return proto::read_elevation_request(body, 2); });
}

tin::base::Result<proto::SimplifyInputs> read_simplify(const std::string& body) {
  const auto request = proto::ExecutionRequest::read(body);
  if (!request) return request.error();
  return proto::read_simplify_inputs(request->inputs());
}

/// Bytes changed at random: anything may be said of them, but nothing may crash, and accepted values are
/// sane.
TEST(HostileBodiesTest, RandomlyChangedBytesDoNoHarm) {
  const unsigned seed = std::getenv("TINSMITH_SEED")
                            ? static_cast<unsigned>(std::stoul(std::getenv("TINSMITH_SEED")))
                            : std::random_device{}();
  SCOPED_TRACE("TINSMITH_SEED=" + std::to_string(seed));
  std::mt19937 random(seed);
  const std::string bodies[] = {
      R"({"id":"a","title":"t","crs":"EPSG:4326","resolution":[1e-3,1],"vertices":[[1,2,3],[4.5,-5e2,6]]})",
      R"({"ops":[{"op":"insert","x":1,"y":2,"z":3},{"op":"move","id":7,"x":1,"y":2},{"op":"set-z","id":1,"z":2}]})",
      R"({"positions":[[1,2],[3,4]],"voids":"keep"})",
      R"({"inputs":{"tin":"a","tolerance":1.5,"maxVertices":10},"outputs":{}})"};
  const std::string alphabet = "{}[]\",:0123456789eE+-.\\u tfn\x80\xff\xc3";
  int accepted = 0;
  for (int round = 0; round < 40000; ++round) {
    std::string body = bodies[random() % 4];
    for (std::size_t changes = 1 + random() % 4; changes > 0 && !body.empty(); --changes) {
      const std::size_t at = random() % body.size();
      switch (random() % 4) {
        case 0:
          body[at] = static_cast<char>(random());
          break;
        case 1:
          body[at] = alphabet[random() % alphabet.size()];
          break;
        case 2:
          body.erase(at, 1 + random() % 8);
          break;
        default:
          body.insert(at, body.substr(random() % body.size(), random() % 16));
          break;
      }
    }
    const auto expect_contract = [&](bool read, std::string_view path) {
      if (!read) return;
      ++accepted;
      for (const auto& line : tests_support::request_violations("POST", path, body))
        ADD_FAILURE() << line << "\n" << body;
    };
    expect_contract(proto::read_create_tin(body, 10).ok(), "/tins");
    expect_contract(proto::read_edit_request(body, {10, 3, 100}).ok(), "/tins/{tin}/edits");
    expect_contract(proto::read_elevation_request(body, 10).ok(), "/tins/{tin}/elevation");
    expect_contract(read_simplify(body).ok(), "/processes/{process}/execution");
  }
  EXPECT_GT(accepted, 100);  // otherwise nothing but the first byte is being tested
}

}  // namespace
