// What supervisors, load balancers and monitoring ask for.
#include <gtest/gtest.h>

#include <chrono>
#include <sstream>
#include <thread>

#include "tests/contract/test_server.h"

namespace tests::contract {
namespace {

/// The value of the sample that stands under this name and these labels; -1 if there is none.
double sample(const std::string& text, const std::string& name) {
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with(name + " ")) return std::stod(line.substr(name.size() + 1));
  }
  return -1;
}

TEST(OperationsTest, ReadyUntilItIsToldToStop) {
  TestServer server;
  EXPECT_EQ(server.get("/readyz").status, 200);
  server.announce_stop();
  const RawAnswer answer = server.get("/readyz");
  EXPECT_EQ(answer.status, 503);
  EXPECT_NE(answer.header("retry-after"), "");
  EXPECT_EQ(server.get("/healthz").status, 200) << "alive all the same";
  EXPECT_EQ(sample(server.get("/metrics").body, "tinsmith_draining"), 1);
}

TEST(OperationsTest, MetricsCountWhatHappens) {
  TestServer server;
  const std::string before = server.get("/metrics").body;
  ASSERT_EQ(server.post_json("/tins", R"({"id":"t","vertices":[[0,0,1],[1,0,2],[0,1,3]]})").status, 201);
  ASSERT_EQ(server
                .post_json("/tins/t/edits",
                           R"({"ops":[{"op":"insert","x":5,"y":5,"z":1},{"op":"insert","x":6,"y":5,"z":1}]})")
                .status,
            200);
  EXPECT_EQ(server.get("/tins/none").status, 404);
  const RawAnswer answer = server.get("/metrics");
  EXPECT_EQ(answer.header("content-type"), "text/plain; version=0.0.4; charset=utf-8");
  const auto grown = [&](const std::string& name) {
    return sample(answer.body, name) - std::max(0.0, sample(before, name));
  };
  EXPECT_EQ(sample(answer.body, "tinsmith_tins"), 1);
  EXPECT_EQ(sample(answer.body, "tinsmith_vertices"), 5);
  EXPECT_EQ(grown("tinsmith_edits_total"), 2);
  EXPECT_EQ(grown("tinsmith_revisions_total"), 1);
  EXPECT_GE(grown("tinsmith_commits_total"), 2) << "of the TIN and of its revision";
  EXPECT_GE(grown("tinsmith_committed_writes_total"), 2);
  EXPECT_GT(grown("tinsmith_commit_seconds_total"), 0);
  EXPECT_EQ(sample(answer.body, "tinsmith_commit_queue"), 0);
  EXPECT_EQ(grown(R"(tinsmith_http_requests_total{method="POST",route="/tins/{tin}/edits",status="2xx"})"),
            1);
  EXPECT_EQ(grown(R"(tinsmith_http_requests_total{method="GET",route="/tins/{tin}",status="4xx"})"), 1);
  EXPECT_EQ(grown(R"(tinsmith_http_request_seconds_bucket{method="POST",route="/tins",le="+Inf"})"), 1);
  EXPECT_EQ(grown(R"(tinsmith_http_request_seconds_count{method="POST",route="/tins"})"), 1);
  EXPECT_GE(sample(answer.body, "tinsmith_http_connections"), 1);
  EXPECT_GT(sample(answer.body, "process_resident_memory_bytes"), 1e6);
}

TEST(OperationsTest, MetricsTellOfJobsWithoutTheirIds) {
  TestServer server;
  const auto busy = server.occupy_worker();
  const RawAnswer queued =
      server.upload("/tins?id=a", "text/plain", ascii_grid(3, 3), "Prefer: respond-async\r\n");
  ASSERT_EQ(queued.status, 201);
  const std::string text = server.get("/metrics").body;
  EXPECT_EQ(sample(text, R"(tinsmith_jobs{state="running"})"), 1);
  EXPECT_EQ(sample(text, R"(tinsmith_jobs{state="accepted"})"), 1);
  EXPECT_EQ(sample(text, R"(tinsmith_job_progress_ratio{kind="simplify",number="0"})"), 0);
  EXPECT_EQ(text.find(queued.header("location").substr(6)), std::string::npos);
}

TEST(OperationsTest, MetricsTellWhatHoldsAPlace) {
  TestServer server;
  ASSERT_EQ(server.post_json("/tins", R"({"id":"t","vertices":[[0,0,1],[1,0,2],[0,1,3]]})").status, 201);
  const auto streams = [&] {
    return sample(server.get("/metrics").body, R"(tinsmith_requests_in_work{kind="change_stream"})");
  };
  EXPECT_EQ(streams(), 0);
  support::RawClient listener(server.port());
  listener.send("GET /tins/t/changes HTTP/1.1\r\nHost: t\r\nAccept: text/event-stream\r\n\r\n");
  for (int i = 0; i < 200 && streams() == 0; ++i) std::this_thread::sleep_for(std::chrono::milliseconds(10));
  EXPECT_EQ(streams(), 1);
  EXPECT_EQ(sample(server.get("/metrics").body, R"(tinsmith_requests_in_work{kind="edit"})"), 0);
}

TEST(OperationsTest, EveryLineOfTheMetricsIsWellFormed) {
  TestServer server;
  server.get("/tins");
  std::istringstream lines(server.get("/metrics").body);
  std::set<std::string> families;
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with("# TYPE ")) {
      EXPECT_TRUE(families.insert(line).second) << "twice: " << line;
      continue;
    }
    if (line.starts_with("# HELP ")) continue;
    const std::size_t space = line.rfind(' ');
    ASSERT_NE(space, std::string::npos) << line;
    EXPECT_NO_THROW(static_cast<void>(std::stod(line.substr(space + 1)))) << line;
    EXPECT_EQ(line.find_first_not_of("abcdefghijklmnopqrstuvwxyz_"), std::min(line.find('{'), space)) << line;
  }
  EXPECT_GT(families.size(), 8U);
}

TEST(OperationsTest, ASoundRequestIdIsTakenOver) {
  TestServer server;
  EXPECT_EQ(server.get("/tins", "X-Request-Id: 7f3a-B_2.x:1\r\n").header("x-request-id"), "7f3a-B_2.x:1");
  const std::string longest(128, 'a');
  EXPECT_EQ(server.get("/tins", "X-Request-Id: " + longest + "\r\n").header("x-request-id"), longest);
  for (const std::string& id :
       {longest + "a", std::string("a b"), std::string("a\"b"), std::string("a, b"), std::string()}) {
    const std::string own = server.get("/tins", "X-Request-Id: " + id + "\r\n").header("x-request-id");
    EXPECT_NE(own, "");
    EXPECT_NE(own, id);
  }
}

}  // namespace
}  // namespace tests::contract
