// Reading by a process of its own: the same imports as here, whatever happens to it.
#include "server/gdal/decoder.h"

#include <gtest/gtest.h>

#include <chrono>
#include <thread>

#include "tests/server/gdal/support.h"

namespace server::gdal::testing {
namespace {

using tin::base::Code;

class DecoderTest : public ScratchTest {
 protected:
  static Decoder decoder() { return {TINSMITH_PROGRAM, {}}; }

  tin::base::Error failure(const std::filesystem::path& upload, const Decoder& by,
                           const ImportOptions& options = {}) {
    auto import = by.import_file(upload, options, nullptr);
    EXPECT_FALSE(import.ok());
    return import.ok() ? tin::base::Error{} : import.error();
  }

  /// A decoder that does as it is told by this script, in place of the program.
  Decoder script(const std::string& lines, DecoderLimits limits = {}) const {
    const auto program = file("script", "#!/bin/sh\n" + lines + "\n");
    std::filesystem::permissions(program, std::filesystem::perms::owner_all);
    return {program.string(), limits};
  }
};

void expect_equal(const Import& a, const Import& b) {
  EXPECT_EQ(a.frame, b.frame);
  EXPECT_EQ(a.placements, b.placements);
  EXPECT_EQ(a.driver, b.driver);
  EXPECT_EQ(a.heights.size(), b.heights.size());
  for (std::size_t i = 0; i < a.heights.size(); ++i) {
    const double left = a.heights.at(i), right = b.heights.at(i);
    EXPECT_TRUE(left == right || (left != left && right != right)) << i;
  }
  ASSERT_EQ(a.grid == nullptr, b.grid == nullptr);
  if (a.grid) {
    EXPECT_EQ(*a.grid, *b.grid);
  }
}

TEST_F(DecoderTest, FindsWhatThisProcessFinds) {
  TiffSpec spec;
  spec.width = 300;
  spec.height = 200;
  spec.nodata = 7;
  spec.value = [](int column, int row) { return column % 50 == 7 ? 7.0 : 10.0 * row + column; };
  make_tiff(path("raster"), spec);
  make_vector(path("points"), "GPKG", {{"points", "EPSG:32632", {{1, 2, 3}, {4, 5, 6}}}});
  make_vector(path("features.fgb"), "FlatGeobuf", {{"points", "EPSG:32632", {{1, 2, 3}, {4, 5, 6}}}});
  file("text", "x;y;z\n1,5;2;3\n4;5;6\n");
  file("grid", "ncols 2\nnrows 2\nxllcorner 0\nyllcorner 0\ncellsize 1\n1 2\n3 4\n");
  file("json", R"({"type":"Feature","properties":{},"geometry":{"type":"Point","coordinates":[8,47,1]}})");
  const auto hgt = file("tile", std::string(1201 * 1201 * 2, '\1'));
  for (const char* name : {"raster", "points", "features.fgb", "text", "grid", "json"}) {
    const auto there = decoder().import_file(path(name), {}, nullptr);
    ASSERT_TRUE(there) << name << ": " << there.error().message;
    expect_equal(*there, imported(path(name)));
  }
  tin::base::Progress progress;
  const auto there = decoder().import_file(hgt, named("N44W072.hgt"), &progress);
  ASSERT_TRUE(there) << there.error().message;
  expect_equal(*there, imported(hgt, named("N44W072.hgt")));
  EXPECT_EQ(files_left(), 7U) << "only what was uploaded";
}

TEST_F(DecoderTest, AsksForAllThatTheClientSays) {
  file("text", "east,north,up,twice\n1,2,3,6\n4,5,6,12\n");
  ImportOptions options;
  options.crs = "EPSG:32632";
  options.z_field = "twice";
  options.resolution_x = options.resolution_y = 0.5;
  const auto there = decoder().import_file(path("text"), options, nullptr);
  ASSERT_TRUE(there) << there.error().message;
  EXPECT_EQ(there->placements.at(1).z, 12);
  EXPECT_EQ(there->frame.crs, "EPSG:32632");
  EXPECT_EQ(there->frame.x.step(), 0.5);
  options.z_field = "thrice";
  EXPECT_EQ(failure(path("text"), decoder(), options).code, Code::kInvalidValue);
}

TEST_F(DecoderTest, ErrorsAreThoseOfThisProcess) {
  for (const std::string& bytes :
       {std::string("II*\0garbage", 11), std::string("x,y,z\n1,2\n"), std::string(),
        std::string("SQLite format 3\0garbage", 23), std::string("PK\3\4")}) {
    const auto upload = file("upload", bytes);
    const auto here = import_error(upload), there = failure(upload, decoder());
    EXPECT_EQ(there.code, here.code) << there.message;
    EXPECT_EQ(there.message, here.message);
    EXPECT_EQ(there.where, here.where);
  }
  EXPECT_EQ(failure(path("nothing"), decoder()).code, Code::kInvalidValue);
}

TEST_F(DecoderTest, LimitsOfTheImportHoldThere) {
  std::string grid = "ncols 10\nnrows 10\nxllcorner 0\nyllcorner 0\ncellsize 1\n";
  for (int i = 0; i < 100; ++i) grid += std::to_string(i) + (i % 10 == 9 ? "\n" : " ");
  ImportOptions options;
  options.max_pixels = 100;
  EXPECT_TRUE(decoder().import_file(file("grid", grid), options, nullptr).ok());
  options.max_pixels = 99;
  EXPECT_EQ(failure(path("grid"), decoder(), options).code, Code::kTooLarge);
}

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
TEST_F(DecoderTest, TooMuchMemoryIsAnErrorOfTheFile) {
  std::string points = "x,y,z\n";
  for (int i = 0; i < 2'000'000; ++i) points += std::to_string(i) + "," + std::to_string(i % 1000) + ",1\n";
  Decoder small = decoder();
  // What the libraries take themselves is not quite the same everywhere: here it is some 170 MB.
  small.limits.memory_bytes = std::uint64_t{220} << 20;
  const auto problem = failure(file("points", points), small);
  EXPECT_TRUE(problem.code == Code::kTooLarge || problem.code == Code::kInvalidValue) << problem.message;
  EXPECT_TRUE(decoder().import_file(path("points"), {}, nullptr).ok());
}
#endif

TEST_F(DecoderTest, TooMuchComputingIsAnErrorOfTheFile) {
  DecoderLimits limits;
  limits.cpu_seconds = 1;
  const auto upload = file("upload", "x,y,z\n");
  // A shell takes no order and no limits: it sets its own, as the decoder does.
  const auto problem = failure(upload, script("ulimit -t 1\nwhile :; do :; done", limits));
  EXPECT_EQ(problem.code, Code::kTooLarge) << problem.message;
}

TEST_F(DecoderTest, OneThatHangsIsKilled) {
  DecoderLimits limits;
  limits.seconds = 1;
  const auto begin = std::chrono::steady_clock::now();
  const auto problem = failure(file("upload", "x"), script("exec sleep 1000", limits));
  EXPECT_EQ(problem.code, Code::kTooLarge) << problem.message;
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(20));
}

TEST_F(DecoderTest, CancellationEndsItSoon) {
  tin::base::Progress progress;
  const auto upload = file("upload", "x");
  const Decoder slow = script("exec sleep 1000");
  std::jthread canceller([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(200));
    progress.cancel();
  });
  const auto begin = std::chrono::steady_clock::now();
  const auto import = slow.import_file(upload, {}, &progress);
  ASSERT_FALSE(import.ok());
  EXPECT_EQ(import.error().code, Code::kCancelled);
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(20));
}

TEST_F(DecoderTest, OneThatCrashesOrTalksNonsenseIsAnErrorOfTheFile) {
  const auto upload = file("upload", "x,y,z\n1,2,3\n");
  for (const char* lines : {"kill -SEGV $$", "kill -ABRT $$", "kill -BUS $$", "exit 0", "exit 1",
                            "echo nonsense", "printf 'H\\0\\0\\0\\0'", "printf 'Z\\0\\0\\0\\0'",
                            "printf 'V\\377\\377\\377\\377'", "printf 'P\\1\\0\\0\\0x'", "yes"}) {
    const auto problem = failure(upload, script(lines));
    EXPECT_TRUE(problem.code == Code::kInvalidValue || problem.code == Code::kMalformed)
        << lines << ": " << problem.message;
  }
  EXPECT_EQ(failure(upload, script("kill -KILL $$")).code, Code::kTooLarge);
  EXPECT_EQ(failure(upload, {"/nothing/here", {}}).code, Code::kInternal);
}

TEST_F(DecoderTest, ManyAtOnceDoNotDisturbEachOther) {
  file("good", "x,y,z\n1,2,3\n4,5,6\n");
  file("bad", "x,y,z\n1,2\n");
  std::vector<std::jthread> threads;
  for (int i = 0; i < 4; ++i) {
    threads.emplace_back([&, i] {
      for (int round = 0; round < 4; ++round) {
        EXPECT_EQ(decoder().import_file(path(i % 2 == 0 ? "good" : "bad"), {}, nullptr).ok(), i % 2 == 0);
      }
    });
  }
}

}  // namespace
}  // namespace server::gdal::testing
