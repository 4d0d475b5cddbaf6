// The limits of memory and of temporary files: at the limit all is well, past it work is refused and changes nothing.
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <chrono>
#include <csignal>
#include <thread>

#include "tests/contract/limits.h"

namespace tests::contract {
namespace {

TEST(LimitsTest, MemoryOfAllTerrains) {
  constexpr std::int64_t kVertex = server::app::kBytesPerVertex;
  TestServer server([](server::Config& config) { config.limits.memory_bytes = 20 * kVertex; });
  const auto settled = [] { std::this_thread::sleep_for(std::chrono::milliseconds(150)); };
  EXPECT_EQ(server.post_json("/tins", R"({"id":"a","vertices":)" + vertices(12) + "}").status, 201);
  settled();
  const std::string before = server.state();
  const RawAnswer refused = server.post_json("/tins", R"({"id":"b","vertices":)" + vertices(9) + "}");
  EXPECT_EQ(refused.status, 429);
  EXPECT_EQ(slug(refused), "too-many-requests");
  EXPECT_NE(refused.header("retry-after"), "");
  EXPECT_EQ(server.upload("/tins?id=c", "text/plain", ascii_grid(3, 3)).status, 429);
  EXPECT_EQ(server.post_json("/tins/a/edits", inserts(9, 12)).status, 429);
  EXPECT_EQ(
      server.post_json("/processes/simplify/execution", R"({"inputs":{"tin":"a","tolerance":1}})").status,
      429);
  EXPECT_EQ(server.state(), before);
  EXPECT_EQ(server.post_json("/tins", R"({"id":"b","vertices":)" + vertices(8) + "}").status, 201);
  settled();
  EXPECT_EQ(server.post_json("/tins/a/edits", inserts(1, 12)).status, 429);
  EXPECT_EQ(server.remove("/tins/b").status, 204);
  settled();
  EXPECT_EQ(server.post_json("/tins/a/edits", inserts(8, 12)).status, 200);
}

/// Each version that a slow reader holds counts, so that readers and editors together cannot fill the memory.
TEST(LimitsTest, MemoryOfVersionsThatReadersHold) {
  constexpr std::int64_t kVertex = server::app::kBytesPerVertex;
  const int vertex_count = 60'000;
  TestServer server([&](server::Config& config) {
    config.limits.memory_bytes = 3 * vertex_count * kVertex + 1000 * kVertex;
  });
  ASSERT_EQ(server.upload("/tins?id=t", "text/plain", ascii_grid(300, 200)).status, 201);
  std::vector<std::unique_ptr<support::RawClient>> readers;
  int status = 200, edits = 0;
  for (; status == 200 && edits < 10; ++edits) {
    auto& reader = readers.emplace_back(std::make_unique<support::RawClient>(server.port(), 4096));
    reader->send("GET /tins/t/export?f=geojson HTTP/1.1\r\nHost: t\r\n\r\n");
    std::this_thread::sleep_for(std::chrono::milliseconds(200));
    status = server
                 .post_json("/tins/t/edits",
                            R"({"ops":[{"op":"set-z","id":1,"z":)" + std::to_string(edits) + "}]}")
                 .status;
  }
  EXPECT_EQ(status, 429);
  EXPECT_GE(edits, 2);
  EXPECT_LE(edits, 4);
  readers.clear();
  for (int i = 0; i < 100 && status != 200; ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    status = server.post_json("/tins/t/edits", R"({"ops":[{"op":"set-z","id":1,"z":7}]})").status;
  }
  EXPECT_EQ(status, 200);
}

/// Of 600 x 600 heights 720,000 bytes wait in a file as they were read, and 4 a pixel as they are worked on,
/// with room for three more: more than half of what may be in memory, either.
TEST(LimitsTest, TemporaryFilesOfARasterThatIsSimplified) {
  constexpr std::int64_t kNeeded = 2 * 360'000 + 4 * (360'000 + 3);
  const std::string grid = ascii_grid(600, 600), query = "/tins?id=t&tolerance=3&effort=fast";
  for (const std::int64_t limit : {std::int64_t{0}, kNeeded, kNeeded - 1}) {
    TestServer server([&](server::Config& config) {
      config.limits.raster_memory_bytes = 1 << 20;
      config.limits.scratch_bytes = limit;
    });
    const std::string before = server.state();
    const RawAnswer answer = server.upload(query, "text/plain", grid);
    EXPECT_EQ(server.leftovers(), std::set<std::string>{});
    if (limit == kNeeded - 1) {
      expect_too_large(answer);
      EXPECT_EQ(server.state(), before);
      continue;
    }
    ASSERT_EQ(answer.status, 201) << answer.body;
    // The source comes back from its file by the same way.
    EXPECT_EQ(
        server.post_json("/processes/simplify/execution", R"({"inputs":{"tin":"t","tolerance":2}})").status,
        200);
  }
}

/// Where no file may have a megabyte, as on a disk that is full when a temporary one asks for its room.
TEST(LimitsTest, AFullDiskUnderTemporaryFilesChangesNothing) {
  constexpr std::int32_t kSide = 600;  // a text of 720,000 bytes, heights of 1,440,000
  const std::string grid = ascii_grid(std::vector<std::vector<double>>(kSide, std::vector<double>(kSide, 7)));
  const auto old_handler = std::signal(SIGXFSZ, SIG_IGN);  // as the server does
  rlimit old_limit{};
  ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &old_limit), 0);
  const auto limit_files = [&](rlim_t bytes) {
    const rlimit limit{bytes, old_limit.rlim_max};
    EXPECT_EQ(::setrlimit(RLIMIT_FSIZE, &limit), 0);
  };
  for (const bool in_files : {false, true}) {
    TestServer server([&](server::Config& config) {
      if (in_files) config.limits.raster_memory_bytes = 1 << 20;
    });
    const auto upload = [&] { return server.upload("/tins?id=t&tolerance=3&effort=fast", "text/plain", grid); };
    const std::string before = server.state();
    limit_files(1'000'000);
    const RawAnswer answer = upload();
    limit_files(old_limit.rlim_cur);
    if (!in_files) {
      EXPECT_EQ(answer.status, 201) << "nothing else needs such a file: " << answer.body;
      continue;
    }
    EXPECT_EQ(answer.status, 507) << answer.body;
    EXPECT_EQ(slug(answer), "insufficient-storage");
    EXPECT_EQ(server.state(), before);
    EXPECT_EQ(server.leftovers(), std::set<std::string>{});
    EXPECT_EQ(upload().status, 201);
  }
  std::signal(SIGXFSZ, old_handler);
}

/// What work takes beside a raster's samples is asked for on its way.
TEST(LimitsTest, MemoryOfASimplification) {
  // So rough that a TIN which keeps every height has nearly all samples for vertices.
  std::vector<std::vector<double>> rows(300, std::vector<double>(300));
  std::uint32_t state = 1;
  for (auto& row : rows) {
    for (double& z : row) z = (state = state * 1664525 + 1013904223) >> 25;
  }
  const std::string grid = ascii_grid(rows);
  const auto asked = [&](std::int64_t megabytes, const std::string& query) {
    TestServer server([&](server::Config& config) { config.limits.memory_bytes = megabytes << 20; });
    const std::string before = server.state();
    const RawAnswer answer = server.upload("/tins?id=t&effort=fast&tolerance=" + query, "text/plain", grid);
    if (answer.status == 413) {
      expect_too_large(answer);
      EXPECT_EQ(server.state(), before);
    } else {
      EXPECT_EQ(answer.status, 201) << answer.body;
    }
    return answer.status;
  };
  // 90,000 samples: a few megabytes, 144 bytes each for their triangulation, 256 for each vertex of a TIN of
  // them all.
  EXPECT_EQ(asked(8, "150"), 201);
  EXPECT_EQ(asked(8, "150&against=surface"), 413);
  EXPECT_EQ(asked(40, "150&against=surface"), 201);
  EXPECT_EQ(asked(8, "0"), 413);
  EXPECT_EQ(asked(64, "0"), 201);
}

}  // namespace
}  // namespace tests::contract
