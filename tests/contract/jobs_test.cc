// Work that is asked for now and taken later.
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
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
  EXPECT_EQ(result.at("duplicates"), 0);
  result.erase("duplicates");  // told once
  result.erase("links");       // the job does not know how its client calls the server
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
    const RawAnswer gone = server_.get(job + "/results");
    EXPECT_EQ(gone.status, 410);
    EXPECT_EQ(Json::parse(gone.body).at("title"), "What was asked for is no longer kept");
  }
  busy.reset();
  EXPECT_EQ(server_.leftovers(), std::set<std::string>{}) << "a dismissed upload is not kept";
  EXPECT_EQ(server_.state(), before);
}

/// What the vertices that go held in place beside an edit becomes vertices again: the tolerance is that of the
/// revision.
TEST_F(JobsTest, AnEditWhileATinIsSimplifiedLeavesNoSampleBeyondTheTolerance) {
  constexpr int kSide = 120;
  constexpr double kTolerance = 20;
  std::vector<std::vector<double>> rows(kSide, std::vector<double>(kSide));
  std::uint32_t state = 1;
  for (auto& row : rows) {
    for (double& z : row) z = (state = state * 1664525 + 1013904223) >> 26;
  }
  ASSERT_EQ(server_.upload("/tins?id=t", "text/plain", ascii_grid(rows)).status, 201);
  const std::string job =
      simplify(R"({"tin":"t","tolerance":20,"effort":"best","maxSeconds":2})").header("location");
  const auto started = [&] { return Json::parse(server_.get(job).body).value("progress", 0) > 5; };
  for (int i = 0; i < 400 && !started(); ++i) std::this_thread::sleep_for(std::chrono::milliseconds(5));
  constexpr int kPeak = kSide * kSide / 2 + kSide / 2;  // a vertex inside, by rows
  ASSERT_EQ(server_
                .post_json("/tins/t/edits",
                           R"({"ops":[{"op":"set-z","id":)" + std::to_string(kPeak) + R"(,"z":9000}]})")
                .status,
            200);
  ASSERT_EQ(finished(job), "successful");
  const Json results = Json::parse(server_.get(job + "/results").body);
  EXPECT_TRUE(results.at("editedMeanwhile"));
  EXPECT_TRUE(results.at("toleranceMet"));
  EXPECT_LE(results.at("maxError"), kTolerance);
  EXPECT_EQ(results.at("verticesAfter"), server_.tin("t").at("vertexCount"));
  EXPECT_LT(results.at("verticesAfter"), kSide * kSide);
  Json positions = Json::array();
  for (int row = 0; row < kSide; ++row) {
    for (int column = 0; column < kSide; ++column) positions.push_back({column + 0.5, kSide - row - 0.5});
  }
  const Json found =
      Json::parse(server_.post_json("/tins/t/elevation", Json{{"positions", positions}}.dump()).body);
  std::size_t beyond = 0;
  for (std::size_t i = 0; i < positions.size(); ++i) {
    const double error = found.at("z").at(i).get<double>() - rows[i / kSide][i % kSide];
    if (std::abs(error) > kTolerance + 1e-9) ++beyond;
  }
  EXPECT_EQ(beyond, 1U) << "but for the one that was edited";
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

/// How many vertices a terrain needs is found out by the work, which knows nothing of inputs.
TEST_F(JobsTest, TooFewVerticesAreAnErrorOfTheInputThatAskedForThem) {
  ASSERT_EQ(server_.upload("/tins?id=grid", "text/plain", ascii_grid(8, 6)).status, 201);
  const RawAnswer refused =
      server_.post_json("/processes/simplify/execution", R"({"inputs":{"tin":"grid","maxVertices":3}})");
  EXPECT_EQ(refused.status, 422);
  EXPECT_EQ(Json::parse(refused.body).at("where"), "/inputs/maxVertices") << refused.body;
  const std::string job = simplify(R"({"tin":"grid","maxVertices":3})").header("location");
  ASSERT_EQ(finished(job), "failed");
  EXPECT_EQ(Json::parse(server_.get(job + "/results").body).at("where"), "/inputs/maxVertices");
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

// The list (OGC API Processes, job list) --------------------------------------------------------------------

class JobListTest : public JobsTest {
 protected:
  JobListTest() {
    EXPECT_EQ(server_.upload("/tins?id=grid", "text/plain", ascii_grid(8, 6)).status, 201);
    import_ = id_of(server_.upload("/tins?id=new", "text/plain", ascii_grid(3, 3), kAsync));
    works_ = id_of(simplify(R"({"tin":"grid","maxVertices":5,"as":"small"})"));
    for (const std::string& id : {import_, works_}) EXPECT_EQ(finished("/jobs/" + id), "successful");
    busy_ = server_.occupy_worker();
    waits_ = id_of(simplify(R"({"tin":"grid","maxVertices":5})"));
  }
  static std::string id_of(const RawAnswer& accepted) { return accepted.header("location").substr(6); }
  std::vector<std::string> listed(const std::string& query) {
    const RawAnswer answer = server_.get("/jobs?" + query);
    EXPECT_EQ(answer.status, 200) << query << answer.body;
    std::vector<std::string> ids;
    if (answer.status != 200) return ids;
    const Json list = Json::parse(answer.body);
    for (const Json& job : list.at("jobs")) ids.push_back(job.at("jobID"));
    return ids;
  }

  using Ids = std::vector<std::string>;
  std::string import_, works_, waits_;
  std::unique_ptr<TestServer::Occupation> busy_;
};

TEST_F(JobListTest, ConditionsSelect) {
  EXPECT_EQ(listed("type=process").size(), 4u) << "three, and the one that occupies the worker";
  EXPECT_EQ(listed("processID=simplify&status=accepted,successful"), (Ids{waits_, works_}))
      << "the latest first";
  EXPECT_EQ(listed("processID=simplify&status=running").size(), 1u);
  EXPECT_EQ(listed("processID=import,contours"), Ids{import_});
  EXPECT_EQ(listed("status=accepted"), Ids{waits_});
  EXPECT_EQ(listed("status=successful,failed"), (Ids{works_, import_}));
  EXPECT_EQ(listed("status=successful&processID=simplify"), Ids{works_});
  EXPECT_EQ(listed("processID=nothing"), Ids{});
  EXPECT_EQ(listed("datetime=2000-01-01/2001-01-01"), Ids{});
  EXPECT_EQ(listed("datetime=2000-01-01/..&processID=simplify&status=accepted,successful"),
            (Ids{waits_, works_}));
  EXPECT_EQ(listed("maxDuration=3600&processID=simplify&status=accepted,successful"), Ids{works_})
      << "one that has not begun has no duration";
  EXPECT_EQ(listed("minDuration=3600"), Ids{});
  EXPECT_EQ(listed("minDuration=0&maxDuration=3600&processID=import"), Ids{import_});
}

TEST_F(JobListTest, PagesFollowOneAnother) {
  Ids seen;
  std::string target = "/jobs?limit=1&type=process";
  for (int page = 0; page < 4; ++page) {
    const Json list = Json::parse(server_.get(target).body);
    ASSERT_EQ(list.at("jobs").size(), 1u);
    seen.push_back(list.at("jobs").at(0).at("jobID"));
    target.clear();
    for (const Json& link : list.at("links")) {
      if (link.at("rel") == "next") target = link.at("href");
    }
    EXPECT_EQ(target.empty(), page == 3);
    EXPECT_TRUE(target.empty() || target.find("type=process") != std::string::npos);
  }
  EXPECT_EQ(seen, listed("type=process"));
}

TEST_F(JobListTest, BadConditionsAre400) {
  for (const char* query :
       {"type=wps", "status=lost", "status=", "status=running,", "datetime=today", "minDuration=-1",
        "minDuration=x", "maxDuration=1.5", "limit=0", "limit=10001", "next=1", "next=x.y", "next="}) {
    EXPECT_EQ(server_.get(std::string("/jobs?") + query).status, 400) << query;
  }
}

TEST_F(JobListTest, PeopleSeePages) {
  const std::string html = "Accept: text/html\r\n";
  for (const std::string& target :
       {std::string("/jobs"), "/jobs/" + works_, std::string("/processes"),
        std::string("/processes/simplify"), std::string("/tins"), std::string("/conformance")}) {
    const RawAnswer page = server_.get(target, html);
    EXPECT_EQ(page.status, 200);
    EXPECT_EQ(page.header("content-type"), "text/html; charset=utf-8") << target;
  }
  EXPECT_NE(server_.get("/jobs", html).body.find(works_), std::string::npos);
}

/// Work that takes longer than the server waits becomes a job. No preference was stated, so none was applied.
TEST(JobsThatOutlastTheWaitTest, AreAnsweredWithTheJob) {
  TestServer server([](server::Config& config) { config.jobs.sync_seconds = 1; });
  ASSERT_EQ(server.upload("/tins?id=grid", "text/plain", ascii_grid(8, 6)).status, 201);
  auto busy = server.occupy_worker();
  const std::string inputs = R"({"inputs":{"tin":"grid","maxVertices":5,"as":"small"}})";
  const RawAnswer answer = server.post_json("/processes/simplify/execution", inputs);
  EXPECT_EQ(answer.status, 201);
  EXPECT_EQ(answer.header("preference-applied"), "");
  EXPECT_EQ(Json::parse(answer.body).at("status"), "accepted");
  busy.reset();
  EXPECT_EQ(server.finished(answer.header("location")), "successful");
}

}  // namespace
}  // namespace tests::contract
