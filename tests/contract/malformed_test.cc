// Requests that nobody meant: whole ones with a few changes anywhere, framing, target and body alike. Each
// gets an answer that blames the client, or a good one; none breaks the server or what it keeps.
#include <gtest/gtest.h>

#include <cstdlib>
#include <random>

#include "tests/contract/test_server.h"
#include "tests/fuzz/mutate.h"

namespace tests::contract {
namespace {

std::uint64_t from_environment(const char* name, std::uint64_t otherwise) {
  const char* given = std::getenv(name);
  return given == nullptr ? otherwise : std::strtoull(given, nullptr, 10);
}

std::string with_body(const std::string& line, const std::string& type, const std::string& body) {
  return line + " HTTP/1.1\r\nHost: t\r\nContent-Type: " + type +
         "\r\nContent-Length: " + std::to_string(body.size()) + "\r\n\r\n" + body;
}

std::vector<std::string> good_requests() {
  const std::string json = "application/json";
  std::vector<std::string> all;
  for (const char* target :
       {"/", "/tins?limit=2", "/tins/t", "/tins/t/elevation?x=1.5&y=2&voids=fill",
        "/tins/t/elevation?x=1&y=2", "/tins/t/collections/vertices/items?bbox=0,0,3,3&limit=2",
        "/tins/t/collections/triangles/items", "/tins/t/export?f=geojson",
        "/tins/t/export?f=geotiff&cell-size=1&bbox=0,0,5,5", "/jobs", "/processes/simplify", "/metrics"}) {
    all.push_back(std::string("GET ") + target +
                  " HTTP/1.1\r\nHost: t\r\nAccept-Encoding: gzip\r\nIf-None-Match: \"1\"\r\n\r\n");
  }
  all.push_back(with_body("POST /tins/t/edits", json,
                          R"({"ops":[{"op":"insert","x":1.5,"y":2.5,"z":3},{"op":"set-z","id":2,"z":9},)"
                          R"({"op":"move","id":3,"x":0.5,"y":0.25},{"op":"remove","id":4}]})"));
  all.push_back(with_body("POST /tins/t/elevation", json, R"({"positions":[[1,2],[3.5,4]],"voids":"keep"})"));
  all.push_back(with_body("POST /tins/t/elevation", "application/octet-stream", std::string(32, '\1')));
  all.push_back(with_body("POST /tins", json,
                          R"({"title":"x","crs":"EPSG:32632","vertices":[[1,2,3],[4,5,6],[7,1,9]]})"));
  all.push_back(with_body("POST /tins", "text/csv", "x,y,z\n1,2,3\n4,5,6\n"));
  all.push_back(with_body("POST /tins?format=aaigrid", "text/plain", ascii_grid(3, 3)));
  all.push_back(
      with_body("POST /processes/simplify/execution", json, R"({"inputs":{"tin":"t","tolerance":1}})"));
  all.push_back("DELETE /tins/none HTTP/1.1\r\nHost: t\r\n\r\n");
  all.push_back(
      "POST /tins/t/edits HTTP/1.1\r\nHost: t\r\nContent-Type: application/json\r\nTransfer-Encoding: "
      "chunked\r\n\r\n"
      "b\r\n{\"ops\":[{\"o\r\n1c\r\np\":\"set-z\",\"id\":1,\"z\":1.0}]}\r\n0\r\n\r\n");
  return all;
}

TEST(MalformedTest, NoRequestBreaksTheServer) {
  const std::uint64_t seed = from_environment("TINSMITH_SEED", std::random_device{}());
  const std::uint64_t count = from_environment("TINSMITH_MALFORMED", 3000);
  std::cout << "TINSMITH_SEED=" << seed << std::endl;
  TestServer server([](server::Config& config) {
    config.limits.vertices_per_tin = 2000;
    config.limits.tins = 20;
    config.limits.export_pixels = 10'000;
  });
  ASSERT_EQ(server.upload("/tins?id=t&crs=EPSG:32632", "text/plain", ascii_grid(8, 8)).status, 201);
  const auto good = good_requests();
  std::mt19937_64 random(seed);
  std::map<int, int> statuses;
  for (std::uint64_t i = 0; i < count; ++i) {
    const std::string bytes =
        i < good.size() ? good[i] : tests::fuzz::mutate(good[random() % good.size()], good, random);
    support::RawClient client(server.port());
    client.send(bytes);
    client.finish_sending();
    RawAnswer answer = client.read_answer(bytes.starts_with("HEAD "));
    while (answer.status == 102) answer = client.read_answer(bytes.starts_with("HEAD "));
    ++statuses[answer.status];
    // 0: the bytes were no whole request, and the client has ended.
    const bool fine = answer.status == 0 || (answer.status >= 200 && answer.status < 500) ||
                      answer.status == 501 || answer.status == 505;
    ASSERT_TRUE(fine) << answer.status << " " << answer.body << "\nto: " << bytes;
    if (i < good.size()) {
      ASSERT_TRUE(answer.status < 400 || bytes.starts_with("DELETE"))
          << answer.status << answer.body << "\nto: " << bytes;
    }
  }
  for (const auto& [status, times] : statuses) std::cout << status << ": " << times << "\n";
  EXPECT_GT(statuses[400], 0);
  EXPECT_EQ(server.get("/healthz").status, 200);
  EXPECT_EQ(server.get("/tins/t").status, 200);
  EXPECT_EQ(server.leftovers(), std::set<std::string>{});
}

}  // namespace
}  // namespace tests::contract
