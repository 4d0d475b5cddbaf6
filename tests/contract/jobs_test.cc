// Work that is asked for now and taken later.
#include <gtest/gtest.h>

#include <chrono>
#include <thread>

#include "tests/contract/test_server.h"

namespace tests::contract {
namespace {

constexpr const char* kAsync = "Prefer: respond-async\r\n";

class JobsTest : public testing::Test {
 protected:
  RawAnswer simplify(const std::string& inputs) {
    return server_.post_json("/processes/simplify/execution", R"({"inputs":)" + inputs + "}", kAsync);
  }
  std::string finished(const std::string& job) { return server_.finished(job); }

  TestServer server_;
};

TEST_F(JobsTest, AnImportAsAJobGivesWhatTheDirectOneGives) {
  const std::string grid = ascii_grid(8, 6);
  ASSERT_EQ(server_.upload("/tins?id=direct", "text/plain", grid).status, 201);
  const RawAnswer accepted = server_.upload("/tins?id=later", "text/plain", grid, kAsync);
  EXPECT_EQ(accepted.status, 201);
  EXPECT_EQ(accepted.header("preference-applied"), "respond-async");
  const std::string job = accepted.header("location");
  EXPECT_EQ(finished(job), "successful");
  Json result = Json::parse(server_.get(job + "/results").body), tin = server_.tin("later");
  result.erase("links");  // the job does not know how its client calls the server
  tin.erase("links");
  EXPECT_EQ(result, tin);
  EXPECT_EQ(result.at("digest"), server_.tin("direct").at("digest"));
  EXPECT_EQ(server_.leftovers(), std::set<std::string>{});
}

TEST_F(JobsTest, AJobThatWaitsIsDismissedAndNothingIsMade) {
  ASSERT_EQ(server_.upload("/tins?id=grid", "text/plain", ascii_grid(8, 6)).status, 201);
  auto busy = server_.occupy_worker();
  const std::string before = server_.state();
  const std::string import =
      server_.upload("/tins?id=new", "text/plain", ascii_grid(3, 3), kAsync).header("location");
  const std::string work = simplify(R"({"tin":"grid","maxVertices":5})").header("location");
  for (const std::string& job : {import, work}) {
    EXPECT_EQ(Json::parse(server_.get(job).body).at("status"), "accepted");
    EXPECT_EQ(Json::parse(server_.remove(job).body).at("status"), "dismissed");
    EXPECT_EQ(server_.get(job + "/results").status, 410);
  }
  busy.reset();
  EXPECT_EQ(server_.leftovers(), std::set<std::string>{}) << "a dismissed upload is not kept";
  EXPECT_EQ(server_.state(), before);
}

TEST_F(JobsTest, TwoJobsForOneIdMakeOneTin) {
  auto busy = server_.occupy_worker();
  const std::string first =
      server_.upload("/tins?id=one", "text/plain", ascii_grid(3, 3), kAsync).header("location");
  const std::string second =
      server_.upload("/tins?id=one", "text/plain", ascii_grid(4, 4), kAsync).header("location");
  busy.reset();
  EXPECT_EQ(finished(first), "successful");
  EXPECT_EQ(finished(second), "failed");
  EXPECT_EQ(slug(server_.get(second + "/results")), "conflict");
  EXPECT_EQ(server_.tin("one").at("vertexCount"), 9);
}

/// The work began with a TIN that was deleted and made again since: its successor must not feel it.
TEST_F(JobsTest, AJobOfADeletedTinLeavesItsSuccessorAlone) {
  ASSERT_EQ(server_.upload("/tins?id=grid", "text/plain", ascii_grid(8, 6)).status, 201);
  auto busy = server_.occupy_worker();
  const std::string job = simplify(R"({"tin":"grid","maxVertices":5})").header("location");
  ASSERT_EQ(server_.remove("/tins/grid").status, 204);
  ASSERT_EQ(server_.upload("/tins?id=grid", "text/plain", ascii_grid(4, 4)).status, 201);
  const std::string before = server_.state();
  busy.reset();
  EXPECT_EQ(finished(job), "failed");
  EXPECT_EQ(slug(server_.get(job + "/results")), "not-found");
  EXPECT_EQ(server_.state(), before);
  EXPECT_EQ(server_.post_json("/tins/grid/edits", R"({"ops":[{"op":"remove","id":1}]})").status, 200)
      << "its journal is its own";
}

TEST_F(JobsTest, AFinishedSimplificationIsANewRevisionOfTheTinItself) {
  ASSERT_EQ(server_.upload("/tins?id=grid", "text/plain", ascii_grid(8, 6)).status, 201);
  const std::string job = simplify(R"({"tin":"grid","tolerance":30})").header("location");
  EXPECT_EQ(finished(job), "successful");
  const Json result = Json::parse(server_.get(job + "/results").body);
  const Json tin = server_.tin("grid");
  EXPECT_EQ(tin.at("revision"), 2);
  EXPECT_EQ(result.at("revision"), 2);
  EXPECT_EQ(result.at("tin"), "grid");
  EXPECT_EQ(tin.at("vertexCount"), result.at("verticesAfter"));
  EXPECT_LT(result.at("verticesAfter"), result.at("verticesBefore"));
  EXPECT_LE(result.at("maxError"), 30);
}

/// OGC API Processes: the one output's value is the answer, unless it is wanted in a document.
TEST_F(JobsTest, AResultStandsInADocumentWhereTheRequestSaysSo) {
  ASSERT_EQ(server_.upload("/tins?id=grid", "text/plain", ascii_grid(8, 6)).status, 201);
  const std::string path = "/processes/simplify/execution";
  const std::string body =
      R"({"inputs":{"tin":"grid","tolerance":30},"response":"document","outputs":{"result":{}}})";
  const RawAnswer sync = server_.post_json(path, body);
  ASSERT_EQ(sync.status, 200);
  EXPECT_EQ(Json::parse(sync.body).at("result").at("revision"), 2);
  const std::string job = server_.post_json(path, body, kAsync).header("location");
  EXPECT_EQ(finished(job), "successful");
  EXPECT_EQ(Json::parse(server_.get(job + "/results").body).at("result").at("tin"), "grid");
  const std::string strange = R"({"inputs":{"tin":"grid","tolerance":30},"outputs":{"tin":{}}})";
  EXPECT_EQ(server_.post_json(path, strange).status, 422);
}

/// The names that OGC API Processes gives to errors.
TEST_F(JobsTest, WhatThereIsNotIsNamedAsTheStandardSays) {
  const auto type = [&](const std::string& target) {
    const RawAnswer answer = server_.get(target);
    EXPECT_EQ(answer.status, 404) << target;
    return Json::parse(answer.body).value("type", "");
  };
  const std::string base = "http://www.opengis.net/def/exceptions/ogcapi-processes-1/1.0/";
  EXPECT_EQ(type("/processes/none"), base + "no-such-process");
  EXPECT_EQ(type("/jobs/none"), base + "no-such-job");
  EXPECT_EQ(type("/jobs/none/results"), base + "no-such-job");
  auto busy = server_.occupy_worker();
  const std::string job = server_.upload("/tins?id=new", "text/plain", ascii_grid(3, 3), kAsync).header("location");
  EXPECT_EQ(type(job + "/results"), base + "result-not-ready");
}

/// Who waits for a job and goes never learns its id.
TEST_F(JobsTest, AJobThatAClientWaitsForEndsWhenTheClientGoes) {
  ASSERT_EQ(server_.post_json("/tins", R"({"id":"t","vertices":[[0,0,1],[9,0,2],[0,9,3]]})").status, 201);
  const auto busy = server_.occupy_worker();
  const std::string body = R"({"inputs":{"tin":"t","tolerance":1}})";
  const auto newest = [&] { return Json::parse(server_.get("/jobs").body).at("jobs").at(0); };
  const Json occupying = newest();
  {
    support::RawClient client(server_.port());
    client.send(
        "POST /processes/simplify/execution HTTP/1.1\r\nHost: t\r\nContent-Type: application/json\r\n"
        "Content-Length: " +
        std::to_string(body.size()) + "\r\n\r\n" + body);
    for (int i = 0; i < 500 && newest() == occupying; ++i)
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    EXPECT_EQ(newest().at("status"), "accepted");
  }
  for (int i = 0; i < 500 && newest().at("status") == "accepted"; ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  EXPECT_EQ(newest().at("status"), "dismissed");
}

}  // namespace
}  // namespace tests::contract
