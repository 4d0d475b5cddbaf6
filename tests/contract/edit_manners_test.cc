// What all ways to edit have in common: keys, places, memory; and edits of an area.
#include <gtest/gtest.h>

#include <chrono>
#include <thread>

#include "tests/contract/test_server.h"

namespace tests::contract {
namespace {

constexpr const char* kGrid =
    R"({"id":"t","vertices":[[0,0,1],[1,0,2],[2,0,3],[0,1,4],[1,1,5],[2,1,6],[0,2,7],[1,2,8],[2,2,9]]})";
const std::string kItems = "/tins/t/collections/vertices/items";

std::string point(const std::string& at) {
  return R"({"type":"Feature","geometry":{"type":"Point","coordinates":[)" + at + R"(]},"properties":null})";
}

std::string key(const std::string& name) {
  return "Idempotency-Key: " + name + "\r\n";
}

/// Every request that edits, each of which can be carried out once at the beginning.
std::vector<Ask> edits() {
  return {{"POST", "/tins/t/edits", "application/json", R"({"ops":[{"op":"set-z","id":1,"z":50}]})", ""},
          {"POST", kItems, "application/geo+json", point("0.5,0.5,3"), ""},
          {"PUT", kItems + "/2", "application/geo+json", point("1.25,0,7"), "If-Match: *\r\n"},
          {"PATCH", kItems + "/3", "application/merge-patch+json", R"({"properties":{"z":21}})",
           "If-Match: *\r\n"},
          {"DELETE", kItems + "/4", "", "", "If-Match: *\r\n"},
          {"POST", "/tins/t/revisions/2/revert", "", "", ""}};
}

TEST(EditMannersTest, AKeyHasOneEffectAndOneAnswerWhateverTheResource) {
  TestServer server;
  ASSERT_EQ(server.post_json("/tins", kGrid).status, 201);
  int number = 0;
  for (Ask ask : edits()) {
    SCOPED_TRACE(ask.method + " " + ask.target);
    ask.fields += key("k" + std::to_string(++number));
    const RawAnswer first = server.ask(ask);
    ASSERT_EQ(first.status / 100, 2) << first.body;
    const std::string state = server.state();
    const RawAnswer again = server.ask(ask);
    EXPECT_EQ(again.status, first.status);
    EXPECT_EQ(again.body, first.body);
    EXPECT_EQ(again.header("location"), first.header("location"));
    EXPECT_EQ(again.header("etag"), first.header("etag"));
    EXPECT_EQ(server.state(), state);
  }
}

/// A client that repeats itself must not learn a tag of a state that it never saw: it would overwrite what
/// others did.
TEST(EditMannersTest, TheTagThatIsRepeatedIsThatOfTheEditThen) {
  TestServer server;
  ASSERT_EQ(server.post_json("/tins", kGrid).status, 201);
  const auto create = [&] {
    return server.ask({"POST", kItems, "application/geo+json", point("0.5,0.5,3"), key("a")});
  };
  const RawAnswer made = create();
  ASSERT_EQ(made.status, 201);
  const std::string vertex = kItems + "/10";
  const Ask other{"PATCH", vertex, "application/json", R"({"properties":{"z":99}})", "If-Match: *\r\n"};
  ASSERT_EQ(server.ask(other).status, 204);
  EXPECT_EQ(create().header("etag"), made.header("etag"));
  const Ask mine{"PATCH", vertex, "application/json", R"({"properties":{"z":4}})",
                 "If-Match: " + create().header("etag") + "\r\n"};
  EXPECT_EQ(server.ask(mine).status, 412);
  ASSERT_EQ(server.ask({"DELETE", vertex, "", "", "If-Match: *\r\n"}).status, 204);
  EXPECT_EQ(create().header("location"), made.header("location")) << "though it is gone";
}

TEST(EditMannersTest, AKeyOfAnotherRequestIsRefused) {
  TestServer server;
  ASSERT_EQ(server.post_json("/tins", kGrid).status, 201);
  const std::string fields = "If-Match: *\r\n" + key("same");
  ASSERT_EQ(server.ask({"PUT", kItems + "/5", "application/json", point("1.25,1,7"), fields}).status, 204);
  const std::string state = server.state();
  EXPECT_EQ(server.ask({"PATCH", kItems + "/5", "application/json", point("1.25,1,7"), fields}).status, 422);
  EXPECT_EQ(server.ask({"PUT", kItems + "/6", "application/json", point("1.25,1,7"), fields}).status, 422);
  EXPECT_EQ(server.ask({"DELETE", kItems + "/5", "", "", fields}).status, 422);
  EXPECT_EQ(server.ask({"POST", kItems, "application/json", point("1.25,1,7"), fields}).status, 422);
  EXPECT_EQ(server.state(), state);
}

TEST(EditMannersTest, EditsHaveABoundedNumberOfPlaces) {
  TestServer server([](server::Config& config) { config.limits.edits_at_once = 2; });
  ASSERT_EQ(server.post_json("/tins", kGrid).status, 201);
  const auto one = server.take_place(&server::api::Context::edits);
  EXPECT_EQ(server.ask(edits()[0]).status, 200) << "one place is left";
  {
    const auto other = server.take_place(&server::api::Context::edits);
    const std::string state = server.state();
    for (const Ask& ask : edits()) {
      const RawAnswer refused = server.ask(ask);
      EXPECT_EQ(refused.status, 429) << ask.method << " " << ask.target;
      EXPECT_NE(refused.header("retry-after"), "");
    }
    EXPECT_EQ(server.state(), state);
  }
  EXPECT_EQ(server.ask(edits()[1]).status, 201);
}

TEST(EditMannersTest, WhatGrowsNeedsMemoryAndWhatDoesNotGoesOn) {
  constexpr std::int64_t kVertex = server::app::kBytesPerVertex;
  TestServer server([](server::Config& config) { config.limits.memory_bytes = 10 * kVertex; });
  const auto settled = [] { std::this_thread::sleep_for(std::chrono::milliseconds(150)); };
  ASSERT_EQ(server.post_json("/tins", kGrid).status, 201);
  settled();
  const Ask create{"POST", kItems, "application/json", point("0.5,0.5,3"), ""};
  ASSERT_EQ(server.ask(create).status, 201) << "the tenth";
  settled();
  const std::string state = server.state();
  EXPECT_EQ(server.ask({"POST", kItems, "application/json", point("0.5,0.75,3"), ""}).status, 429);
  EXPECT_EQ(server.post_json("/tins/t/edits", R"({"ops":[{"op":"insert","x":1.5,"y":1.5,"z":1}]})").status,
            429);
  EXPECT_EQ(server.state(), state);
  EXPECT_EQ(server.ask(edits()[3]).status, 204);
  EXPECT_EQ(server.ask(edits()[4]).status, 204);
  settled();
  EXPECT_EQ(server.ask({"POST", kItems, "application/json", point("0.5,0.75,3"), ""}).status, 201);
  settled();
  EXPECT_EQ(server.ask({"POST", "/tins/t/revisions/4/revert"}).status, 429)
      << "the removal's undo brings a vertex";
}

TEST(RemoveWithinTest, RemovesWhatStandsInThePolygonWhenItsTurnComes) {
  TestServer server;
  ASSERT_EQ(server.post_json("/tins", kGrid).status, 201);
  const std::string before = server.tin("t").at("digest");
  const std::string body =
      R"({"ops":[{"op":"set-z","id":9,"z":90},{"op":"insert","x":0.5,"y":0.5,"z":1},)"
      R"({"op":"remove-within","polygon":[[0,0],[1,0],[1,1],[0,1]]},{"op":"insert","x":0.25,"y":0.25,"z":2},)"
      R"({"op":"remove-within","polygon":[[7,7],[8,7],[8,8]]},{"op":"remove","id":11}]})";
  const RawAnswer answer = server.post_json("/tins/t/edits", body, key("area"));
  ASSERT_EQ(answer.status, 200) << answer.body;
  EXPECT_EQ(
      Json::parse(answer.body).at("results"),
      Json::parse(R"([{"id":9},{"id":10},{"removed":[1,2,4,5,10]},{"id":11},{"removed":[]},{"id":11}])"));
  EXPECT_EQ(server.tin("t").at("vertexCount"), 5);
  EXPECT_EQ(server.post_json("/tins/t/edits", body, key("area")).body, answer.body);
  EXPECT_EQ(server.ask({"POST", "/tins/t/revisions/2/revert"}).status, 200);
  EXPECT_EQ(server.tin("t").at("digest"), before);
}

TEST(RemoveWithinTest, AnErrorNamesItsOperationAndTakesAllBack) {
  TestServer server;
  ASSERT_EQ(server.post_json("/tins", kGrid).status, 201);
  const std::string state = server.state(),
                    all = R"({"op":"remove-within","polygon":[[0,0],[9,0],[9,9],[0,9]]})";
  const auto where = [&](const std::string& ops) {
    const RawAnswer answer = server.post_json("/tins/t/edits", R"({"ops":[)" + ops + "]}");
    EXPECT_EQ(answer.status, 422) << answer.body;
    return Json::parse(answer.body).value("where", "");
  };
  EXPECT_EQ(where(R"({"op":"remove","id":1},)" + all + R"(,{"op":"set-z","id":2,"z":1})"), "/ops/2");
  EXPECT_EQ(where(R"({"op":"remove","id":77},)" + all), "/ops/0");
  EXPECT_EQ(where(all + R"(,{"op":"remove-within","polygon":[[0,0],[1,0],[0,1e300]]})"), "/ops/1");
  EXPECT_EQ(server.state(), state);
  EXPECT_EQ(server.post_json("/tins/t/edits", R"({"ops":[)" + all + "]}").status, 200);
  EXPECT_EQ(server.tin("t").at("vertexCount"), 0);
}

TEST(RemoveWithinTest, ItsPolygonsAndVerticesAreBounded) {
  TestServer server([](server::Config& config) {
    config.limits.areas_per_request = 2;
    config.limits.polygon_positions = 4;
    config.limits.edits_per_request = 6;
  });
  ASSERT_EQ(server.post_json("/tins", kGrid).status, 201);
  const std::string state = server.state();
  const auto remove = [&](const std::vector<std::string>& polygons) {
    std::string ops;
    for (const std::string& polygon : polygons)
      ops += (ops.empty() ? "" : ",") + (R"({"op":"remove-within","polygon":[)" + polygon + "]}");
    return server.post_json("/tins/t/edits", R"({"ops":[)" + ops + "]}").status;
  };
  const std::string nothing = "[7,7],[8,7],[8,8]", row = "[0,0],[2,0],[2,0.5]";
  EXPECT_EQ(remove({nothing, nothing, nothing}), 413);
  EXPECT_EQ(remove({nothing, nothing}), 200);
  EXPECT_EQ(remove({nothing + ",[7,8],[6,8]"}), 413);
  EXPECT_EQ(remove({nothing + ",[7,8]"}), 200);
  EXPECT_EQ(remove({"[0,0],[2,0],[2,2],[0,2]"}), 413) << "nine vertices";
  EXPECT_EQ(remove({"[0,0],[2,0],[2,1],[0,1]", "[0,2],[1,2],[1,3]"}), 413) << "eight in all";
  EXPECT_EQ(server.state(), state);
  EXPECT_EQ(remove({row, "[0,1],[2,1],[2,1.5]"}), 200) << "six";
}

/// The first vertices of an open frame come another way.
TEST(RemoveWithinTest, MayComeWithTheFirstVertices) {
  TestServer server;
  ASSERT_EQ(server.post_json("/tins", R"({"id":"t"})").status, 201);
  const RawAnswer answer = server.post_json(
      "/tins/t/edits",
      R"({"ops":[{"op":"insert","x":3,"y":3,"z":1},{"op":"remove-within","polygon":[[2,2],[4,2],[3,5]]},)"
      R"({"op":"insert","x":5,"y":3,"z":1}]})");
  EXPECT_EQ(answer.status, 200);
  EXPECT_EQ(Json::parse(answer.body).at("results"), Json::parse(R"([{"id":1},{"removed":[1]},{"id":2}])"));
  EXPECT_EQ(server.tin("t").at("vertexCount"), 1);
}

}  // namespace
}  // namespace tests::contract
