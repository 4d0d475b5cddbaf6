// The limits of the configuration, but for those of memory (memory_limits_test.cc): at the limit all is well, one past it is refused and changes nothing.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cstring>
#include <functional>
#include <thread>

#include "tests/contract/limits.h"

namespace tests::contract {
namespace {

std::string repeated(const std::string& item, int count) {
  std::string list;
  for (int i = 0; i < count; ++i) list += (i == 0 ? "" : ",") + item;
  return list;
}

TEST(LimitsTest, EditsInARequest) {
  TestServer server([](server::Config& config) { config.limits.edits_per_request = 5; });
  ASSERT_EQ(server.post_json("/tins", R"({"id":"t","vertices":)" + vertices(4) + "}").status, 201);
  const std::string op = R"({"op":"set-z","id":1,"z":7})";
  EXPECT_EQ(server.post_json("/tins/t/edits", R"({"ops":[)" + repeated(op, 5) + "]}").status, 200);
  const std::string before = server.state();
  const RawAnswer answer =
      server.post_json("/tins/t/edits", R"({"ops":[)" + repeated(R"({"op":"set-z","id":1,"z":8})", 6) + "]}");
  expect_too_large(answer);
  EXPECT_EQ(Json::parse(answer.body).at("where"), "/ops");
  EXPECT_EQ(server.state(), before);
}

TEST(LimitsTest, SecondsOfASimplification) {
  TestServer server([](server::Config& config) { config.jobs.simplify_seconds = 5; });
  ASSERT_EQ(server.post_json("/tins", R"({"id":"t","vertices":)" + vertices(9) + "}").status, 201);
  const auto ask = [&](const std::string& more) {
    return server.post_json("/processes/simplify/execution", R"({"inputs":{"tin":"t","tolerance":1)" + more + "}}");
  };
  EXPECT_EQ(ask(R"(,"maxSeconds":5)").status, 200);
  const std::string before = server.state();
  const RawAnswer refused = ask(R"(,"maxSeconds":5.001)");
  EXPECT_EQ(refused.status, 422);
  EXPECT_EQ(Json::parse(refused.body).at("where"), "/inputs/maxSeconds");
  EXPECT_NE(refused.body.find("at most 5"), std::string::npos) << refused.body;
  EXPECT_EQ(server.state(), before);
}

TEST(LimitsTest, SecondsOfASimplificationThatDoesNotSay) {
  // A bumpy raster that the search never tires of: the limit ends it.
  TestServer server([](server::Config& config) { config.jobs.simplify_seconds = 1; });
  std::string grid = "ncols 300\nnrows 300\nxllcorner 0\nyllcorner 0\ncellsize 1\n";
  for (int i = 0; i < 90'000; ++i) grid += std::to_string(i * 7919LL % 1009 % 97) + (i % 300 == 299 ? "\n" : " ");
  ASSERT_EQ(server.upload("/tins?id=t&crs=EPSG:32632", "text/plain", grid).status, 201);
  const RawAnswer answer = server.post_json("/processes/simplify/execution",
                                            R"({"inputs":{"tin":"t","tolerance":30,"effort":"best"}})");
  ASSERT_EQ(answer.status, 200) << answer.body;
  const Json result = Json::parse(answer.body);
  EXPECT_TRUE(result.at("outOfTime"));
  EXPECT_TRUE(result.at("toleranceMet"));
  EXPECT_LE(result.at("maxError"), 30);
}

TEST(LimitsTest, PositionsInARequest) {
  TestServer server([](server::Config& config) { config.limits.positions_per_request = 5; });
  ASSERT_EQ(server.post_json("/tins", R"({"id":"t","vertices":)" + vertices(4) + "}").status, 201);
  const auto ask = [&](int count) {
    return server.post_json("/tins/t/elevation", R"({"positions":[)" + repeated("[1,2]", count) + "]}");
  };
  const RawAnswer answer = ask(5);
  EXPECT_EQ(answer.status, 200);
  EXPECT_EQ(Json::parse(answer.body).at("z").size(), 5U);
  expect_too_large(ask(6));
}

TEST(LimitsTest, VerticesOfATinMadeFromJson) {
  TestServer server([](server::Config& config) { config.limits.vertices_per_tin = 12; });
  EXPECT_EQ(server.post_json("/tins", R"({"id":"t","vertices":)" + vertices(12) + "}").status, 201);
  const std::string before = server.state();
  expect_too_large(server.post_json("/tins", R"({"vertices":)" + vertices(13) + "}"));
  EXPECT_EQ(server.state(), before);
}

TEST(LimitsTest, VerticesOfATinThatIsEdited) {
  TestServer server([](server::Config& config) { config.limits.vertices_per_tin = 12; });
  ASSERT_EQ(server.post_json("/tins", R"({"id":"t","vertices":)" + vertices(10) + "}").status, 201);
  EXPECT_EQ(server.post_json("/tins/t/edits", inserts(2, 10)).status, 200);
  const std::string before = server.state();
  expect_too_large(server.post_json("/tins/t/edits", inserts(1, 12)));
  EXPECT_EQ(server.state(), before);
}

/// The limit is one of the TIN, not of the operations.
TEST(LimitsTest, AFullTinMayExchangeAndReplaceVertices) {
  TestServer server([](server::Config& config) { config.limits.vertices_per_tin = 12; });
  ASSERT_EQ(server.post_json("/tins", R"({"id":"t","vertices":)" + vertices(12) + "}").status, 201);
  EXPECT_EQ(server.post_json("/tins/t/edits", R"({"ops":[{"op":"insert","x":0,"y":0,"z":9}]})").status, 200);
  EXPECT_EQ(
      server
          .post_json("/tins/t/edits", R"({"ops":[{"op":"remove","id":1},{"op":"insert","x":1,"y":0,"z":9}]})")
          .status,
      200);
  EXPECT_EQ(server.tin("t").at("vertexCount"), 12);
}

TEST(LimitsTest, ValidSamplesOfAFile) {
  TestServer server([](server::Config& config) { config.limits.vertices_per_tin = 12; });
  EXPECT_EQ(server.upload("/tins?id=grid", "text/plain", ascii_grid(4, 3)).status, 201);
  EXPECT_EQ(server
                .upload("/tins?id=void", "text/plain",
                        ascii_grid({{1, 2, 3, 4, 5}, {1, -9999, 3, 4, 5}, {6, 7, -9999, -9999, 8}}))
                .status,
            201);
  std::string points = "x,y,z\n";
  for (int i = 0; i < 12; ++i) points += std::to_string(i) + "," + std::to_string(i * i) + ",1\n";
  EXPECT_EQ(server.upload("/tins?id=points", "text/csv", points).status, 201);
  const std::string before = server.state();
  expect_too_large(server.upload("/tins", "text/plain", ascii_grid(13, 1)));
  expect_too_large(server.upload("/tins", "text/csv", points + "12,144,1\n"));
  EXPECT_EQ(server.state(), before);
  EXPECT_EQ(server.leftovers(), std::set<std::string>{});
}

TEST(LimitsTest, Tins) {
  TestServer server([](server::Config& config) { config.limits.tins = 3; });
  for (const std::string id : {"a", "b", "c"}) {
    EXPECT_EQ(server.post_json("/tins", R"({"id":")" + id + R"(","vertices":)" + vertices(4) + "}").status,
              201);
  }
  const std::string before = server.state();
  EXPECT_EQ(slug(server.post_json("/tins", "{}")), "too-many-requests");
  EXPECT_EQ(server.upload("/tins", "text/plain", ascii_grid(3, 3)).status, 429);
  EXPECT_EQ(
      server.post_json("/processes/simplify/execution", R"({"inputs":{"tin":"a","tolerance":1,"as":"d"}})")
          .status,
      429);
  EXPECT_EQ(server.state(), before);
  EXPECT_EQ(server.remove("/tins/b").status, 204);
  EXPECT_EQ(server.post_json("/tins", "{}").status, 201);
}

TEST(LimitsTest, PageSize) {
  TestServer server([](server::Config& config) {
    config.limits.page_size = 3;
    config.limits.page_size_max = 7;
  });
  ASSERT_EQ(server.post_json("/tins", R"({"id":"t","vertices":)" + vertices(20) + "}").status, 201);
  const auto returned = [&](const std::string& query) {
    return Json::parse(server.get("/tins/t/collections/vertices/items" + query).body).at("features").size();
  };
  EXPECT_EQ(returned(""), 3U);
  EXPECT_EQ(returned("?limit=7"), 7U);
  EXPECT_EQ(returned("?limit=8"), 7U);
  EXPECT_EQ(returned("?limit=4000000000"), 7U);
}

TEST(LimitsTest, BytesOfABodyInMemory) {
  TestServer server([](server::Config& config) { config.limits.body_bytes_memory = 400; });
  const auto padded = [](std::string text, std::size_t size) { return text.append(size - text.size(), ' '); };
  EXPECT_EQ(server.post_json("/tins", padded(R"({"id":"t"})", 400)).status, 201);
  const std::string before = server.state();
  expect_too_large(server.post_json("/tins", padded(R"({"id":"u"})", 401)));
  const std::string op = R"({"ops":[{"op":"insert","x":1,"y":1,"z":1}]})";
  expect_too_large(server.post_json("/tins/t/edits", padded(op, 401)));
  EXPECT_EQ(server.state(), before);
  EXPECT_EQ(server.post_json("/tins/t/edits", padded(op, 400)).status, 200);
}

TEST(LimitsTest, BytesOfAnUploadWithAndWithoutALength) {
  const std::string grid = ascii_grid(6, 6);
  TestServer server(
      [&](server::Config& config) { config.limits.upload_bytes = static_cast<std::int64_t>(grid.size()); });
  EXPECT_EQ(server.upload("/tins?id=t", "text/plain", grid).status, 201);
  const std::string before = server.state();
  expect_too_large(server.upload("/tins?id=u", "text/plain", grid + "\n"));
  const std::string head =
      "POST /tins?id=u HTTP/1.1\r\nHost: t\r\nConnection: close\r\nTransfer-Encoding: chunked\r\n\r\n";
  const auto chunked = [&](const std::string& body) {
    char size[20];
    std::snprintf(size, sizeof size, "%zx\r\n", body.size());
    return support::RawClient(server.port()).ask(head + size + body + "\r\n0\r\n\r\n");
  };
  EXPECT_EQ(chunked(grid + "\n").status, 413);
  EXPECT_EQ(server.leftovers(), std::set<std::string>{});
  EXPECT_EQ(server.state(), before);
  EXPECT_EQ(chunked(grid).status, 201);
}

/// Numbers of files, the lowest byte first, or the highest.
template <class T>
void put(std::string& out, T value, bool highest_first = false) {
  char bytes[sizeof value];
  std::memcpy(bytes, &value, sizeof value);
  if (highest_first) std::reverse(bytes, bytes + sizeof value);
  out.append(bytes, sizeof value);
}

/// A shapefile of three points with heights.
std::string shapefile() {
  constexpr std::int32_t kPointZ = 11, kRecordWords = 18;
  std::string out;
  const std::int32_t words = 50 + 3 * (4 + kRecordWords);
  for (const std::int32_t number : {9994, 0, 0, 0, 0, 0, words}) put(out, number, true);
  for (const std::int32_t number : {1000, kPointZ}) put(out, number);
  for (const double bound : {0., 0., 9., 9., 1., 3., 0., 0.}) put(out, bound);
  for (std::int32_t i = 1; i <= 3; ++i) {
    put(out, i, true);
    put(out, kRecordWords, true);
    put(out, kPointZ);
    for (const double value : {i == 2 ? 9. : 0., i == 3 ? 9. : 0., static_cast<double>(i), 0.})
      put(out, value);
  }
  return out;
}

/// A ZIP archive that holds one file as it is.
std::string zip_of(const std::string& name, const std::string& content) {
  std::uint32_t crc = ~0U;
  for (const char c : content) {
    crc ^= static_cast<unsigned char>(c);
    for (int bit = 0; bit < 8; ++bit) crc = (crc >> 1) ^ (crc & 1 ? 0xEDB88320U : 0);
  }
  const auto size = static_cast<std::uint32_t>(content.size());
  std::string about;
  for (const int number : {10, 0, 0, 0, 0x21})
    put(about, static_cast<std::uint16_t>(number));  // version, flags, stored, time and date
  for (const std::uint32_t number : {~crc, size, size}) put(about, number);
  put(about, static_cast<std::uint16_t>(name.size()));
  put(about, std::uint16_t{0});
  std::string out = "PK\003\004" + about + name + content, directory = "PK\001\002";
  put(directory, std::uint16_t{10});
  directory += about;
  for (int i = 0; i < 3; ++i) put(directory, std::uint16_t{0});
  for (int i = 0; i < 2; ++i) put(directory, std::uint32_t{0});
  directory += name;
  const auto begin = static_cast<std::uint32_t>(out.size());
  out += directory + "PK\005\006";
  for (const int number : {0, 0, 1, 1}) put(out, static_cast<std::uint16_t>(number));
  put(out, static_cast<std::uint32_t>(directory.size()));
  put(out, begin);
  put(out, std::uint16_t{0});
  return out;
}

TEST(LimitsTest, BytesUnpackedFromAnArchive) {
  const std::string shape = shapefile(), archive = zip_of("hill.shp", shape);
  TestServer fits([&](server::Config& config) {
    config.limits.unpacked_bytes = static_cast<std::int64_t>(shape.size());
  });
  const RawAnswer made = fits.upload("/tins?id=hill", "application/zip", archive);
  EXPECT_EQ(made.status, 201) << made.body;
  EXPECT_EQ(fits.tin("hill").at("vertexCount"), 3);
  TestServer narrow([&](server::Config& config) {
    config.limits.unpacked_bytes = static_cast<std::int64_t>(shape.size()) - 1;
  });
  const std::string before = narrow.state();
  expect_too_large(narrow.upload("/tins?id=hill", "application/zip", archive));
  EXPECT_EQ(narrow.state(), before);
}

TEST(LimitsTest, PixelsOfARaster) {
  TestServer server([](server::Config& config) { config.limits.raster_pixels = 35; });
  EXPECT_EQ(server.upload("/tins?id=t", "text/plain", ascii_grid(7, 5)).status, 201);
  const std::string before = server.state();
  expect_too_large(server.upload("/tins", "text/plain", ascii_grid(36, 1)));
  // A header that promises more than any memory holds is refused for its size, too.
  expect_too_large(server.upload(
      "/tins", "text/plain", "ncols 100000\nnrows 100000\nxllcorner 0\nyllcorner 0\ncellsize 1\n1 2 3\n"));
  EXPECT_EQ(server.state(), before);
  EXPECT_EQ(server.leftovers(), std::set<std::string>{});
}

TEST(LimitsTest, PixelsOfAnExport) {
  TestServer server([](server::Config& config) { config.limits.export_pixels = 1000; });
  ASSERT_EQ(server.upload("/tins?id=t", "text/plain", ascii_grid(7, 5)).status, 201);
  const std::string path = "/tins/t/export?f=geotiff&cell-size=1&bbox=0,0,";
  EXPECT_EQ(server.get(path + "25,40").status, 200);
  expect_too_large(server.get(path + "77,13"));
  expect_too_large(server.get("/tins/t/export?f=geotiff&cell-size=1e-300"));
  expect_too_large(server.get("/tins/t/export?f=geotiff&cell-size=1&bbox=-1e300,-1e300,1e300,1e300"));
  EXPECT_EQ(server.leftovers(), std::set<std::string>{});
}

TEST(LimitsTest, PixelsOfTheSourcesOwnGrid) {
  TestServer server([](server::Config& config) { config.limits.export_pixels = 35; });
  ASSERT_EQ(server.upload("/tins?id=fits", "text/plain", ascii_grid(7, 5)).status, 201);
  ASSERT_EQ(server.upload("/tins?id=more", "text/plain", ascii_grid(9, 4)).status, 201);
  EXPECT_EQ(server.get("/tins/fits/export").status, 200);
  expect_too_large(server.get("/tins/more/export"));
  EXPECT_EQ(server.get("/tins/more/export?bbox=0,0,5,4").status, 200);
}

TEST(LimitsTest, JobsThatWait) {
  TestServer server([](server::Config& config) { config.jobs.queued = 2; });
  const auto busy = server.occupy_worker();
  const auto submit = [&](const std::string& id) {
    return server.upload("/tins?id=" + id, "text/plain", ascii_grid(3, 3), "Prefer: respond-async\r\n");
  };
  EXPECT_EQ(submit("a").status, 201);
  EXPECT_EQ(submit("b").status, 201);
  const RawAnswer third = submit("c");
  EXPECT_EQ(third.status, 429);
  EXPECT_NE(third.header("retry-after"), "");
}

TEST(LimitsTest, JobsThatAreRemembered) {
  TestServer server([](server::Config& config) { config.jobs.kept = 2; });
  ASSERT_EQ(server.post_json("/tins", R"({"id":"t","vertices":)" + vertices(4) + "}").status, 201);
  for (int i = 0; i < 4; ++i) {
    EXPECT_EQ(
        server.post_json("/processes/simplify/execution", R"({"inputs":{"tin":"t","maxVertices":4}})").status,
        200);
  }
  EXPECT_EQ(Json::parse(server.get("/jobs").body).at("jobs").size(), 2U);
}

/// With one of two places taken another request goes on; with both, it is told to come later.
void expect_places(TestServer& server, server::api::Slots server::api::Context::*slots,
                   const std::function<int()>& status_of_one) {
  const auto one = server.take_place(slots);
  EXPECT_EQ(status_of_one() / 100, 2);
  {
    const auto other = server.take_place(slots);
    EXPECT_EQ(status_of_one(), 429);
  }
  EXPECT_EQ(status_of_one() / 100, 2);
}

TEST(LimitsTest, UploadsAndExportsAtOnce) {
  TestServer server([](server::Config& config) {
    config.limits.uploads_at_once = 2;
    config.limits.exports_at_once = 2;
  });
  int count = 0;
  expect_places(server, &server::api::Context::uploads, [&] {
    return server.upload("/tins?id=t" + std::to_string(++count), "text/plain", ascii_grid(3, 3)).status;
  });
  expect_places(server, &server::api::Context::exports,
                [&] { return server.get("/tins/t1/export?f=geotiff").status; });
  EXPECT_EQ(server.leftovers(), std::set<std::string>{});
}

/// Who finds no place to wait in is told where to ask later.
TEST(LimitsTest, RequestsThatWaitForTheirJob) {
  TestServer server([](server::Config& config) { config.jobs.sync_waiting = 2; });
  ASSERT_EQ(server.post_json("/tins", R"({"id":"t","vertices":)" + vertices(4) + "}").status, 201);
  const auto simplify = [&] {
    return server.post_json("/processes/simplify/execution", R"({"inputs":{"tin":"t","tolerance":1}})")
        .status;
  };
  const auto one = server.take_place(&server::api::Context::waiting);
  EXPECT_EQ(simplify(), 200);
  const auto other = server.take_place(&server::api::Context::waiting);
  EXPECT_EQ(simplify(), 201);
}

TEST(LimitsTest, JobsThatRun) {
  TestServer server([](server::Config& config) { config.jobs.workers = 2; });
  const auto submit = [&](const std::string& id) {
    return server.upload("/tins?id=" + id, "text/plain", ascii_grid(3, 3), "Prefer: respond-async\r\n")
        .header("location");
  };
  const auto one = server.occupy_worker();
  EXPECT_EQ(server.finished(submit("a")), "successful") << "by the other worker";
  {
    const auto other = server.occupy_worker();
    const std::string job = submit("b");
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    EXPECT_EQ(Json::parse(server.get(job).body).at("status"), "accepted");
  }
}

}  // namespace
}  // namespace tests::contract
