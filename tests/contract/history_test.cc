// Revisions as clients meet them: lists, streams, undo, keys; across restarts in tests/e2e and tests/faults.
#include <gtest/gtest.h>

#include "tests/contract/test_server.h"

namespace tests::contract {
namespace {

class HistoryTest : public testing::Test {
 protected:
  HistoryTest() : server_([](server::Config& config) { config.limits.listeners = 2; }) {
    EXPECT_EQ(server_.post_json("/tins", R"({"id":"hill","vertices":[[0,0,1],[100,0,2],[0,100,3]]})").status,
              201);
  }

  RawAnswer edit(const std::string& ops, const std::string& fields = {}, const std::string& more = {}) {
    return server_.post_json("/tins/hill/edits", R"({"ops":[)" + ops + "]" + more + "}", fields);
  }
  RawAnswer undo(int revision, const std::string& fields = {}) {
    return server_.ask(
        {"POST", "/tins/hill/revisions/" + std::to_string(revision) + "/revert", {}, {}, fields});
  }
  std::string digest() { return server_.tin("hill")["digest"]; }

  TestServer server_;
};

TEST_F(HistoryTest, RevisionsSayWhoDidWhatWhere) {
  ASSERT_EQ(edit(R"({"op":"insert","x":10,"y":20,"z":5},{"op":"insert","x":30,"y":5,"z":6})", {},
                 R"(,"author":"ada","note":"two posts")")
                .status,
            200);
  ASSERT_EQ(
      edit(R"({"op":"move","id":4,"x":12,"y":20},{"op":"remove","id":5},{"op":"set-z","id":1,"z":9})").status,
      200);
  const Json page = Json::parse(server_.get("/tins/hill/revisions").body);
  EXPECT_EQ(page["current"], 3);
  EXPECT_EQ(page["oldest"], 2);
  ASSERT_EQ(page["revisions"].size(), 2u);
  const Json& last = page["revisions"][0];
  EXPECT_EQ(last["revision"], 3);
  EXPECT_FALSE(last.contains("author"));
  EXPECT_EQ(last["inserted"], 0);
  EXPECT_EQ(last["removed"], 1);
  EXPECT_EQ(last["changed"], 2);
  EXPECT_EQ(last["bbox"], Json::parse("[0,0,30,20]"));
  const Json& first = page["revisions"][1];
  EXPECT_EQ(first["author"], "ada");
  EXPECT_EQ(first["note"], "two posts");
  EXPECT_EQ(first["inserted"], 2);
  EXPECT_EQ(first["bbox"], Json::parse("[10,5,30,20]"));
}

TEST_F(HistoryTest, EditsOfFeaturesSayWhoAndWhyInTheAddress) {
  const std::string items = "/tins/hill/collections/vertices/items", who = "?author=Ad%C3%A8le&note=a%20post";
  const std::string body =
      R"({"type":"Feature","geometry":{"type":"Point","coordinates":[10,20,5]},"properties":{}})";
  const auto send = [&](const std::string& method, const std::string& target, const std::string& with) {
    return server_.ask({method, target, "application/json", with, "If-Match: *\r\nIdempotency-Key: " + method + "\r\n"});
  };
  const RawAnswer made = send("POST", items + who, body);
  ASSERT_EQ(made.status, 201) << made.body;
  EXPECT_EQ(send("POST", items + "?author=Eve", body).status, 422) << "the key came with another author";
  EXPECT_EQ(send("PATCH", items + "/1" + who, R"({"properties":{"z":7}})").status, 204);
  EXPECT_EQ(send("DELETE", items + "/1" + who, "").status, 204);
  const std::string before = digest();
  EXPECT_EQ(send("PUT", items + "/2?author=" + std::string(201, 'a'), body).status, 413);
  EXPECT_EQ(send("PUT", items + "/2?note=%01", body).status, 422);
  EXPECT_EQ(digest(), before);
  const Json page = Json::parse(server_.get("/tins/hill/revisions").body);
  ASSERT_EQ(page["revisions"].size(), 3u);
  for (const Json& revision : page["revisions"]) {
    EXPECT_EQ(revision["author"], "Ad\u00e8le");
    EXPECT_EQ(revision["note"], "a post");
  }
}

TEST_F(HistoryTest, PagesWalkBackAndChangesWalkForth) {
  for (int i = 0; i < 7; ++i)
    ASSERT_EQ(edit(R"({"op":"set-z","id":1,"z":)" + std::to_string(i + 10) + "}").status, 200);
  std::vector<int> back, forth;
  for (std::string target = "/tins/hill/revisions?limit=3"; !target.empty();) {
    const Json page = Json::parse(server_.get(target).body);
    for (const Json& revision : page["revisions"]) back.push_back(revision["revision"]);
    target.clear();
    for (const Json& link : page["links"]) {
      if (link["rel"] == "next") target = link["href"];
    }
  }
  EXPECT_EQ(back, (std::vector<int>{8, 7, 6, 5, 4, 3, 2}));
  for (int since = 1; since < 8;) {
    const Json page =
        Json::parse(server_.get("/tins/hill/changes?limit=3&since=" + std::to_string(since)).body);
    for (const Json& revision : page["changes"]) forth.push_back(revision["revision"]);
    ASSERT_GT(page["revision"], since);
    since = page["revision"];
  }
  EXPECT_EQ(forth, (std::vector<int>{2, 3, 4, 5, 6, 7, 8}));
}

TEST_F(HistoryTest, UndoIsExactAndIsUndone) {
  const std::string before = digest();
  ASSERT_EQ(edit(R"({"op":"insert","x":10,"y":20,"z":5},{"op":"remove","id":2})").status, 200);
  const std::string edited = digest();
  EXPECT_EQ(undo(2).status, 200);
  EXPECT_EQ(digest(), before);
  EXPECT_EQ(undo(3).status, 200);
  EXPECT_EQ(digest(), edited);
  ASSERT_EQ(edit(R"({"op":"set-z","id":4,"z":6})").status, 200);
  const RawAnswer refused = undo(2);
  EXPECT_EQ(refused.status, 409);
  EXPECT_NE(refused.body.find("vertex 4 was changed again by revision 3"), std::string::npos) << refused.body;
  EXPECT_EQ(Json::parse(server_.get("/tins/hill/revisions").body)["revisions"][1]["note"],
            "undo of revision 3");
}

TEST_F(HistoryTest, AKeySentAgainGetsTheSameAnswerAndHasOneEffect) {
  const std::string key = "Idempotency-Key: a-1\r\n", ops = R"({"op":"insert","x":10,"y":20,"z":5})";
  const std::string tag = "If-Match: " + server_.get("/tins/hill").header("etag") + "\r\n";
  const RawAnswer first = edit(ops, key + tag);
  ASSERT_EQ(first.status, 200);
  ASSERT_EQ(edit(R"({"op":"remove","id":4})").status, 200);
  const RawAnswer again = edit(ops, key + tag);
  EXPECT_EQ(again.status, 200) << "though the tag is old by now";
  EXPECT_EQ(again.body, first.body);
  EXPECT_EQ(again.header("etag"), first.header("etag"));
  EXPECT_EQ(server_.tin("hill")["revision"], 3);
  EXPECT_EQ(edit(R"({"op":"insert","x":10,"y":20,"z":6})", key).status, 422);
  EXPECT_EQ(undo(2, key).status, 422) << "another request";
  EXPECT_EQ(edit(ops, "Idempotency-Key: " + std::string(256, 'k') + "\r\n").status, 400);
  EXPECT_EQ(edit(ops, "Idempotency-Key: " + std::string(255, 'k') + "\r\n").status, 200);
  const RawAnswer undone = undo(4, "Idempotency-Key: u\r\n");
  EXPECT_EQ(undone.status, 200);
  EXPECT_EQ(undo(4, "Idempotency-Key: u\r\n").body, undone.body);
  EXPECT_EQ(server_.tin("hill")["revision"], 5);
}

TEST_F(HistoryTest, ANewTitleIsSeenAndChangesTheTag) {
  const std::string tag = server_.get("/tins/hill").header("etag");
  EXPECT_EQ(server_.ask({"PATCH", "/tins/hill", "application/json", R"({"title":"Hill"})"}).status, 200);
  const RawAnswer shown = server_.get("/tins/hill");
  EXPECT_EQ(Json::parse(shown.body)["title"], "Hill");
  EXPECT_EQ(Json::parse(shown.body)["revision"], 1);
  EXPECT_NE(shown.header("etag"), tag);
  EXPECT_EQ(edit(R"({"op":"remove","id":1})", "If-Match: " + tag + "\r\n").status, 200) << "same revision";
}

/// Reads a stream until `end` was seen.
std::string read_until(support::RawClient& client, const std::string& end) {
  std::string text;
  while (text.find(end) == std::string::npos) {
    const std::string more = client.read_some();
    if (more.empty()) break;
    text += more;
  }
  return text;
}

TEST_F(HistoryTest, AStreamTellsOfChangesAsTheyCome) {
  ASSERT_EQ(edit(R"({"op":"set-z","id":1,"z":5})").status, 200);
  support::RawClient client(server_.port());
  client.send("GET /tins/hill/changes?since=1 HTTP/1.1\r\nHost: x\r\nAccept: text/event-stream\r\n\r\n");
  const std::string begin = read_until(client, "id: 2\nevent: change\ndata: {\"revision\":2");
  EXPECT_NE(begin.find("text/event-stream"), std::string::npos);
  ASSERT_EQ(edit(R"({"op":"set-z","id":1,"z":6})").status, 200);
  EXPECT_NE(read_until(client, "id: 3\n").find("id: 3\n"), std::string::npos);
  EXPECT_EQ(server_.remove("/tins/hill").status, 204);
  EXPECT_NE(read_until(client, "event: deleted").find("event: deleted"), std::string::npos);
}

TEST_F(HistoryTest, AStreamResumesAfterTheLastEventThatArrived) {
  for (int i = 0; i < 3; ++i)
    ASSERT_EQ(edit(R"({"op":"set-z","id":1,"z":)" + std::to_string(i + 10) + "}").status, 200);
  support::RawClient client(server_.port());
  client.send(
      "GET /tins/hill/changes HTTP/1.1\r\nHost: x\r\nAccept: text/event-stream\r\nLast-Event-ID: 3\r\n\r\n");
  const std::string text = read_until(client, "id: 4\n");
  EXPECT_NE(text.find("id: 4\n"), std::string::npos);
  EXPECT_EQ(text.find("id: 3\n"), std::string::npos);
}

TEST_F(HistoryTest, ListenersHaveABoundedNumberOfPlaces) {
  const std::string listen =
      "GET /tins/hill/changes HTTP/1.1\r\nHost: x\r\nAccept: text/event-stream\r\n\r\n";
  {
    support::RawClient first(server_.port()), second(server_.port());
    first.send(listen);
    second.send(listen);
    read_until(first, ": changes of hill");
    read_until(second, ": changes of hill");
    EXPECT_EQ(server_.get("/tins/hill/changes", "Accept: text/event-stream\r\n").status, 429);
    EXPECT_EQ(server_.get("/tins/hill/changes").status, 200);
  }
  // A client that left is noticed at the next event: its place is free then.
  int status = 0;
  for (int i = 0; i < 50 && status != 200; ++i) {
    ASSERT_EQ(edit(R"({"op":"set-z","id":1,"z":)" + std::to_string(i + 10) + "}").status, 200);
    support::RawClient third(server_.port());
    third.send(listen);
    status = read_until(third, "\r\n").find(" 200 ") != std::string::npos ? 200 : 429;
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
  }
  EXPECT_EQ(status, 200);
}

}  // namespace
}  // namespace tests::contract
