// Rasters that are larger than the memory they may have.
#include <gdal_priv.h>

#include <array>
#include <cmath>
#include <fstream>

#include "tests/e2e/dem.h"
#include "tests/e2e/served.h"

namespace tests::e2e {
namespace {

namespace fs = std::filesystem;
using support::Finished;

class ScaleTest : public ServedTest {
 protected:
  /// A GeoTIFF in tiles; heights of type Int16, or of Float32 with a void.
  std::string raster(int side, GDALDataType type) const {
    GDALAllRegister();
    const std::string file = folder_.path() / ("raster-" + std::to_string(side) + ".tif");
    char* options[] = {const_cast<char*>("TILED=YES"), nullptr};
    auto* const driver = GetGDALDriverManager()->GetDriverByName("GTiff");
    GDALDataset* const data = driver->Create(file.c_str(), side, side, 1, type, options);
    std::array<double, 6> transform{500000, 10, 0, 5000000, 0, -10};
    data->SetGeoTransform(transform.data());
    if (type == GDT_Float32) data->GetRasterBand(1)->SetNoDataValue(-1);
    std::vector<double> row(static_cast<std::size_t>(side));
    for (int y = 0; y < side; ++y) {
      for (int x = 0; x < side; ++x) {
        const bool is_void = type == GDT_Float32 && x > side / 3 && x < side / 2 && y > side / 2;
        row[static_cast<std::size_t>(x)] =
            is_void ? -1 : 500 + 300 * std::sin(x / 90.0) * std::cos(y / 70.0) + x % 7;
      }
      if (data->GetRasterBand(1)->RasterIO(GF_Write, 0, y, side, 1, row.data(), side, 1, GDT_Float64, 0, 0) !=
          CE_None)
        return "";
    }
    GDALClose(data);
    return file;
  }
  /// `tinsmith simplify` of it; what it wrote.
  std::string simplified(const std::string& input, std::vector<std::string> more,
                         const std::string& before = "") const {
    const std::string output = folder_.path() / "out.obj";
    std::string command = before + " exec \"$0\" simplify '" + input + "' -t 10 -o '" + output + "' --quiet";
    for (const std::string& word : more) command += " '" + word + "'";
    const Finished done = support::run({"bash", "-c", command, TINSMITH_PROGRAM});
    if (done.status != 0) return "status " + std::to_string(done.status) + ": " + done.err;
    std::ifstream file(output);
    std::string text((std::istreambuf_iterator<char>(file)), {});
    fs::remove(output);
    return text;
  }
};

/// Large enough for rounds over larger and larger patches, too.
TEST_F(ScaleTest, WhatWaitsInFilesGivesTheSameTin) {
  for (const GDALDataType type : {GDT_Int16, GDT_Float32}) {
    const std::string input = raster(2400, type);
    const std::string expected = simplified(input, {"--threads", "1"});
    ASSERT_TRUE(expected.starts_with("#")) << expected;
    for (const char* effort : {"fast", "balanced"}) {
      const std::string whole = simplified(input, {"--effort", effort, "--threads", "2"});
      EXPECT_EQ(simplified(input, {"--effort", effort, "--threads", "2", "--memory", "1"}), whole) << effort;
      EXPECT_EQ(simplified(input, {"--effort", effort, "--threads", "1", "--memory", "1"}), whole) << effort;
      if (std::string(effort) == "balanced") {
        EXPECT_EQ(whole, expected);
      }
    }
    EXPECT_EQ(std::distance(fs::directory_iterator(folder_.path()), fs::directory_iterator()), 1)
        << "something is left";
    fs::remove(input);
  }
}

/// A server makes the same TIN of what does not fit into the memory that a raster may have, keeps the
/// samples, and is held to them after a restart.
TEST_F(ScaleTest, AServerMakesTheSameTinOfARasterLargerThanMemory) {
  std::ofstream(folder_.path() / "small.json") << R"({"limits":{"raster_memory_bytes":1048576}})";
  const std::vector<std::string> small{"--config", folder_.path() / "small.json"};
  for (const GDALDataType type : {GDT_Int16, GDT_Float32}) {
    const std::string input = raster(1400, type), id = type == GDT_Int16 ? "whole" : "real";
    std::string straight, copied;
    const auto digest = [&](const std::string& tin) {
      return served_->get("/tins/" + tin).at("digest").get<std::string>();
    };
    for (const auto& more : {std::vector<std::string>(), small}) {
      start(more);
      const support::RawAnswer made = served_->upload("?id=" + id + "&tolerance=10&effort=fast", input);
      ASSERT_EQ(made.status, 201) << made.body;
      const std::string first = digest(id);
      ASSERT_EQ(served_->stop(), 0);
      start(more);
      EXPECT_EQ(digest(id), first);
      EXPECT_EQ(served_->simplify({{"tin", id}, {"tolerance", 6}, {"effort", "fast"}, {"as", "copy"}})
                    .at("certifiedAgainst"),
                "original samples");
      const Json result = served_->simplify({{"tin", "copy"}, {"tolerance", 4}, {"effort", "fast"}});
      EXPECT_LE(result.at("maxError"), 4);
      EXPECT_EQ(result.at("certifiedAgainst"), "original samples");
      if (straight.empty()) {
        straight = first;
        copied = digest("copy");
      } else {
        EXPECT_EQ(first, straight);
        EXPECT_EQ(digest("copy"), copied);
        EXPECT_TRUE(fs::is_empty(data() / "scratch"));
      }
      for (const auto& tin : {id, std::string("copy")})
        ASSERT_EQ(served_->http().remove("/tins/" + tin).status, 204);
      ASSERT_EQ(served_->stop(), 0);
    }
    fs::remove(input);
  }
}

TEST_F(ScaleTest, WithoutRoomForFilesNothingIsWritten) {
  const std::string input = raster(800, GDT_Int16);
  const std::string said = simplified(input, {"--memory", "1", "--scratch", "/nowhere"});
  EXPECT_TRUE(said.starts_with("status 1: tinsmith: ")) << said;
  EXPECT_NE(said.find("/nowhere"), std::string::npos) << said;
  EXPECT_FALSE(fs::exists(folder_.path() / "out.obj"));
}

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
/// The system refuses memory past a limit that the raster's 36 million samples (72 MB, and 144 MB more for
/// scans) do not fit in.
TEST_F(ScaleTest, ALargeRasterNeedsNoMemoryOfItsSize) {
  const std::string input = raster(6000, GDT_Int16);
  const std::string limited = "ulimit -d 180000;";
  const std::string tin = simplified(input, {"--effort", "fast", "--memory", "16"}, limited);
  EXPECT_TRUE(tin.starts_with("#")) << tin.substr(0, 1000);
  EXPECT_TRUE(simplified(input, {"--effort", "fast"}, limited).starts_with("status "))
      << "the limit shows nothing";
}
#endif

}  // namespace
}  // namespace tests::e2e
