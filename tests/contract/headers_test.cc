// Entity tags, conditions, CORS and other header fields.
#include <gtest/gtest.h>

#include "tests/contract/test_server.h"

namespace tests::contract {
namespace {

constexpr const char* kSquare = R"({"id":"square","vertices":[[0,0,1],[10,0,2],[0,10,3],[10,10,4]]})";
constexpr const char* kRaise = R"({"ops":[{"op":"set-z","id":1,"z":5}]})";
constexpr const char* kLower = R"({"ops":[{"op":"set-z","id":1,"z":1}]})";

class HeadersTest : public testing::Test {
 protected:
  HeadersTest() { created_ = server_.post_json("/tins", kSquare); }

  RawAnswer edit(const char* ops, const std::string& if_match) {
    return server_.post_json("/tins/square/edits", ops,
                             if_match.empty() ? "" : "If-Match: " + if_match + "\r\n");
  }

  TestServer server_;
  RawAnswer created_;
};

TEST_F(HeadersTest, ACreatedTinSaysWhereItIsAndBearsTheTagOfItsDocument) {
  EXPECT_EQ(created_.status, 201);
  EXPECT_EQ(created_.header("location"), "/tins/square");
  const RawAnswer shown = server_.get(created_.header("location"));
  EXPECT_EQ(shown.header("etag"), created_.header("etag"));
  EXPECT_EQ(shown.body, created_.body);
}

TEST_F(HeadersTest, AnUnchangedAnswerIs304WithItsTagAndWithoutABody) {
  for (const char* target : {"/tins/square", "/tins/square/collections", "/tins/square/collections/vertices",
                             "/tins/square/collections/triangles/items", "/tins/square/elevation?x=1&y=1",
                             "/tins/square/export?f=geojson", "/tins/square/export?f=geotiff"}) {
    const std::string tag = server_.get(target).header("etag");
    ASSERT_NE(tag, "") << target;
    const RawAnswer same = server_.get(target, "If-None-Match: " + tag + "\r\n");
    EXPECT_EQ(same.status, 304) << target;
    EXPECT_EQ(same.body, "");
    EXPECT_EQ(same.header("etag"), tag);
    EXPECT_EQ(server_.get(target, "If-None-Match: \"other\"\r\n").status, 200) << target;
  }
  EXPECT_EQ(server_.leftovers(), std::set<std::string>{});
}

TEST_F(HeadersTest, AnEditChangesTheTagOfEveryRepresentation) {
  const std::vector<std::string> targets{"/tins/square", "/tins/square/collections",
                                         "/tins/square/collections/vertices/items",
                                         "/tins/square/elevation?x=1&y=1", "/tins/square/export?f=geojson"};
  std::set<std::string> tags;
  for (const auto& target : targets) tags.insert(server_.get(target).header("etag"));
  EXPECT_EQ(edit(kRaise, "").status, 200);
  for (const auto& target : targets) tags.insert(server_.get(target).header("etag"));
  EXPECT_EQ(tags.size(), 2 * targets.size());
}

TEST_F(HeadersTest, AnEditWithTheTagOfAnOlderRevisionIsRefusedAndChangesNothing) {
  const std::string old = created_.header("etag");
  const RawAnswer first = edit(kRaise, old);
  ASSERT_EQ(first.status, 200);
  const std::string before = server_.state();
  const RawAnswer late = edit(kLower, old);
  EXPECT_EQ(late.status, 412);
  EXPECT_EQ(slug(late), "precondition-failed");
  EXPECT_EQ(server_.state(), before);
  EXPECT_EQ(edit(kLower, "W/" + first.header("etag")).status, 412);
  EXPECT_EQ(edit(kLower, "\"nonsense\"").status, 412);
  EXPECT_EQ(server_.state(), before);
}

TEST_F(HeadersTest, AnEditWithTheTagOfThePresentRevisionIsDone) {
  const RawAnswer first = edit(kRaise, created_.header("etag"));
  EXPECT_EQ(edit(kLower, first.header("etag")).status, 200);
  EXPECT_EQ(edit(kRaise, server_.get("/tins/square").header("etag")).status, 200);
  EXPECT_EQ(edit(kLower, "*").status, 200);
}

TEST_F(HeadersTest, TheTagOfADeletedTinDoesNotFitItsSuccessor) {
  ASSERT_EQ(server_.remove("/tins/square").status, 204);
  ASSERT_EQ(server_.post_json("/tins", kSquare).status, 201);
  EXPECT_EQ(edit(kRaise, created_.header("etag")).status, 412);
}

TEST_F(HeadersTest, APreflightMayAskForWhatTheApiNeeds) {
  const RawAnswer answer = server_.ask({"OPTIONS",
                                        "/tins/square/edits",
                                        {},
                                        {},
                                        "Origin: http://a\r\nAccess-Control-Request-Method: POST\r\n"});
  EXPECT_EQ(answer.status, 204);
  EXPECT_NE(answer.header("access-control-allow-methods").find("POST"), std::string::npos);
  for (const char* field : {"Content-Type", "If-Match", "If-None-Match", "Prefer"}) {
    EXPECT_NE(answer.header("access-control-allow-headers").find(field), std::string::npos) << field;
  }
}

TEST_F(HeadersTest, AWrongMethodLearnsTheRightOnes) {
  const RawAnswer answer = server_.ask({"PUT", "/tins/square", "application/json", "{}"});
  EXPECT_EQ(answer.status, 405);
  EXPECT_EQ(answer.header("allow"), "GET, HEAD, PATCH, DELETE, OPTIONS");
}

TEST_F(HeadersTest, ABrowserGetsAPageAndAProgramGetsLinks) {
  EXPECT_TRUE(server_.get("/", "Accept: text/html,*/*\r\n").header("content-type").starts_with("text/html"));
  EXPECT_EQ(server_.get("/", "Accept: application/json\r\n").header("content-type"), "application/json");
  EXPECT_EQ(server_.get("/").header("vary"), "Accept");
}

TEST_F(HeadersTest, EveryLinkOfTheLandingPageAndOfATinLeadsSomewhere) {
  for (const std::string page :
       {"/", "/tins/square", "/tins/square/collections/vertices", "/processes/simplify"}) {
    const Json document = Json::parse(server_.get(page).body);
    for (const Json& link : document.at("links")) {
      const bool to_post = link.at("rel").get<std::string>().ends_with("/execute");
      EXPECT_EQ(server_.get(link.at("href")).status, to_post ? 405 : 200) << link;
    }
  }
}

TEST_F(HeadersTest, AnExportHasAFileName) {
  EXPECT_EQ(server_.get("/tins/square/export?f=geotiff").header("content-disposition"),
            "attachment; filename=\"square.tif\"");
  EXPECT_EQ(server_.get("/tins/square/export?f=geojson").header("content-disposition"),
            "attachment; filename=\"square.geojson\"");
}

}  // namespace
}  // namespace tests::contract
