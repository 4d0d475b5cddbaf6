// Clients who mean no good, and what the others notice of it. tests/bench/load prints the same in its long
// form.
#include "tests/bench/load/hostile.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <optional>
#include <thread>

#include "tests/bench/load/server.h"

namespace tests::e2e {
namespace {

#if defined(__SANITIZE_ADDRESS__)
constexpr std::uint64_t kMostGrowth = 600'000'000;  // what was freed is kept for a while there
#else
constexpr std::uint64_t kMostGrowth = 200'000'000;
#endif

TEST(HostileClientsTest, OthersAreServedAllTheSame) {
  load::raise_descriptors();
  const load::Server server(TINSMITH_PROGRAM, load::hostile_config());
  server.make_tin("t", 20'000);
  load::HostileSizes sizes;
  sizes.idle = 500;
  sizes.slow_heads = sizes.slow_bodies = 100;
  sizes.slow_readers = 20;
  sizes.time = std::chrono::milliseconds(1000);
  const auto results = load::run_hostile(server.port(), sizes, [&] { return server.resident_bytes(); });
  const double alone = results.front().others.percentile_ms(99);
  for (const load::HostileResult& r : results) {
    const double p99 = r.others.percentile_ms(99);
    std::cout << r.name << ": p99 " << p99 << " ms, " << r.others.answers << " answers, "
              << r.resident_bytes / 1000000 << " MB\n";
    EXPECT_GT(r.others.answers, 10U) << r.name;
    EXPECT_EQ(r.others.failures, 0U) << r.name;
    // At most double; the rest is what other tests on the same cores take from time to time.
    EXPECT_LT(p99, std::max(2 * alone, alone + 150)) << r.name;
    EXPECT_LT(r.resident_bytes, results.front().resident_bytes + kMostGrowth) << r.name;
  }
}

TEST(HostileClientsTest, IdleConnectionsBeyondTheLimitAreRefusedAndTheOthersStay) {
  load::raise_descriptors();
  const load::Server server(
      TINSMITH_PROGRAM, R"({"log_level":"error","http":{"connections":50,"connections_per_address":40}})");
  // A connection counts until the server has seen its end: one that has just ended may still have a place.
  const load::Crowd crowd(server.port(), 38, "");
  EXPECT_EQ(server.http().get("/healthz").status, 200);
  std::optional<load::Crowd> last_two;
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(10);
  auto refused = server.http().get("/healthz");
  while (refused.status != 503 && std::chrono::steady_clock::now() < deadline) {
    last_two.reset();
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    last_two.emplace(server.port(), 2, "");
    refused = server.http().get("/healthz");
  }
  EXPECT_EQ(refused.status, 503);
  EXPECT_NE(refused.header("retry-after"), "");
  EXPECT_EQ(crowd.open(), 38);
}

}  // namespace
}  // namespace tests::e2e
