#include "server/gdal/geotiff.h"

#include <gdal_priv.h>
#include <sys/resource.h>

#include <cmath>
#include <csignal>
#include <fstream>
#include <iterator>
#include <limits>

#include "tests/server/gdal/support.h"

namespace server::gdal::testing {
namespace {

using tin::base::Code;
using tin::base::Result;

class GeoTiffTest : public ScratchTest {
 protected:
  std::string bytes(const std::string& name) const {
    std::ifstream in(path(name), std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  static RasterSpec spec(std::int64_t width, std::int64_t height) {
    RasterSpec spec;
    spec.width = width;
    spec.height = height;
    spec.geotransform = {500000.25, 10, 0, 5000000.125, 0, -10};
    spec.crs = "EPSG:32632";
    return spec;
  }
  static double value(std::int64_t column, std::int64_t row) {
    return static_cast<double>(row * 7 + column) / 4;
  }
  static Result<void> fill(std::int64_t row, std::span<double> values) {
    for (std::size_t i = 0; i < values.size(); ++i) values[i] = value(static_cast<std::int64_t>(i), row);
    return {};
  }
};

TEST_F(GeoTiffTest, SaysWhatItIs) {
  for (const char* type : {"Float32", "Float64"}) {
    RasterSpec wanted = spec(600, 300);
    wanted.data_type = type;
    wanted.vertical_unit = "US survey foot";
    ASSERT_TRUE(write_geotiff(path("out.tif"), wanted, fill, nullptr).ok());
    const ReadBack read = read_back(path("out.tif"));
    EXPECT_EQ(read.width, 600);
    EXPECT_EQ(read.height, 300);
    EXPECT_EQ(read.geotransform, wanted.geotransform);
    EXPECT_EQ(read.authority, "EPSG:32632");
    EXPECT_EQ(read.nodata, -9999);
    EXPECT_EQ(read.data_type, type);
    EXPECT_EQ(read.unit, "US survey foot");
    EXPECT_EQ(read.area_or_point, "Area");
    EXPECT_EQ(read.compression, "DEFLATE");
    EXPECT_EQ(read.predictor, "3");
    EXPECT_EQ(read.block_width, 256);
    EXPECT_EQ(read.block_height, 256);
    for (std::int64_t row = 0; row < 300; ++row) {
      for (std::int64_t column = 0; column < 600; ++column) {
        ASSERT_EQ(read.values[static_cast<std::size_t>(row * 600 + column)], value(column, row));
      }
    }
    EXPECT_EQ(files_left(), 1U) << "no sidecar";
  }
}

TEST_F(GeoTiffTest, EqualInputGivesEqualBytes) {
  ASSERT_TRUE(write_geotiff(path("a"), spec(700, 600), fill, nullptr).ok());
  ASSERT_TRUE(write_geotiff(path("b"), spec(700, 600), fill, nullptr).ok());
  EXPECT_EQ(bytes("a"), bytes("b"));
  EXPECT_GT(bytes("a").size(), 1000U);
}

TEST_F(GeoTiffTest, WritesThinAndTinyRasters) {
  for (const auto& [width, height] :
       {std::pair{1, 1}, std::pair{1, 1000}, std::pair{1000, 1}, std::pair{257, 255}}) {
    ASSERT_TRUE(write_geotiff(path("out.tif"), spec(width, height), fill, nullptr).ok());
    const ReadBack read = read_back(path("out.tif"));
    EXPECT_EQ(read.width, width);
    EXPECT_EQ(read.values.back(), value(width - 1, height - 1));
  }
}

TEST_F(GeoTiffTest, WritesWideRastersWithLowerTiles) {
  RasterSpec wide = spec(1 << 20, 40);
  ASSERT_TRUE(write_geotiff(path("out.tif"), wide, fill, nullptr).ok());
  const ReadBack read = read_back(path("out.tif"));
  EXPECT_EQ(read.block_height, 16);
  EXPECT_EQ(read.values.back(), value((1 << 20) - 1, 39));
}

TEST_F(GeoTiffTest, TakesAnyCrsAndNodata) {
  RasterSpec wanted = spec(4, 3);
  wanted.crs = "";
  wanted.vertical_unit = "";
  wanted.nodata = std::numeric_limits<double>::quiet_NaN();
  ASSERT_TRUE(write_geotiff(path("out.tif"), wanted, fill, nullptr).ok());
  ReadBack read = read_back(path("out.tif"));
  EXPECT_EQ(read.authority, "");
  EXPECT_EQ(read.unit, "");
  EXPECT_TRUE(std::isnan(read.nodata.value()));
  wanted.crs = "http://www.opengis.net/def/crs/OGC/1.3/CRS84";
  wanted.geotransform = {8, 0.01, 0, 47, 0, -0.01};
  ASSERT_TRUE(write_geotiff(path("out.tif"), wanted, fill, nullptr).ok());
  read = read_back(path("out.tif"));
  EXPECT_EQ(read.authority, "EPSG:4326");
  EXPECT_EQ(read.geotransform, wanted.geotransform);
}

TEST_F(GeoTiffTest, LeavesNoFileAfterAnError) {
  const auto code = [&](const RasterSpec& wanted) {
    auto result = write_geotiff(path("out.tif"), wanted, fill, nullptr);
    return result.ok() ? Code::kInternal : result.error().code;
  };
  RasterSpec bad = spec(0, 3);
  EXPECT_EQ(code(bad), Code::kInvalidValue);
  bad = spec(4, std::int64_t{1} << 40);
  EXPECT_EQ(code(bad), Code::kInvalidValue);
  bad = spec(4, 3);
  bad.data_type = "Int16";
  EXPECT_EQ(code(bad), Code::kInvalidValue);
  bad = spec(4, 3);
  bad.nodata = 1e300;
  EXPECT_EQ(code(bad), Code::kInvalidValue);
  bad.nodata = 0.1;
  EXPECT_EQ(code(bad), Code::kInvalidValue) << "no Float32";
  bad = spec(4, 3);
  bad.geotransform[1] = 0;
  EXPECT_EQ(code(bad), Code::kInvalidValue);
  bad = spec(4, 3);
  bad.crs = "nonsense";
  EXPECT_EQ(code(bad), Code::kMalformed);

  const auto failing = [](std::int64_t row, std::span<double>) -> Result<void> {
    if (row < 2) return {};
    return tin::base::error(Code::kGone, "the source went away");
  };
  EXPECT_EQ(write_geotiff(path("out.tif"), spec(4, 3), failing, nullptr).error().code, Code::kGone);
  tin::base::Progress progress;
  progress.cancel();
  EXPECT_EQ(write_geotiff(path("out.tif"), spec(4, 3), fill, &progress).error().code, Code::kCancelled);
  EXPECT_EQ(write_geotiff(path("no/such/folder/out.tif"), spec(4, 3), fill, nullptr).error().code,
            Code::kStorage);
  EXPECT_EQ(files_left(), 0U);
}

TEST_F(GeoTiffTest, AFullDiskIsAnErrorAndLeavesNoFile) {
  rlimit before{};
  ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &before), 0);
  const auto old_handler = ::signal(SIGXFSZ, SIG_IGN);
  const rlimit small{4096, before.rlim_max};
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &small), 0);
  const auto result = write_geotiff(path("out.tif"), spec(2000, 2000), fill, nullptr);
  ::setrlimit(RLIMIT_FSIZE, &before);
  ::signal(SIGXFSZ, old_handler);
  ASSERT_FALSE(result.ok());
  EXPECT_EQ(result.error().code, Code::kStorage);
  EXPECT_EQ(files_left(), 0U);
}

/// Raster -> import -> GeoTIFF: the same size, place, CRS and values.
void expect_round_trip(const std::filesystem::path& source, const std::filesystem::path& out,
                       const ImportOptions& options, const std::string& authority) {
  const Import import = imported(source, options);
  ASSERT_TRUE(import.grid);
  RasterSpec wanted;
  wanted.width = import.grid->width;
  wanted.height = import.grid->height;
  wanted.geotransform = import.grid->geotransform;
  wanted.crs = import.frame.crs;
  wanted.nodata = import.grid->nodata.value_or(-9999);
  wanted.vertical_unit = import.frame.vertical_unit;
  std::size_t next = 0;
  const auto rows = [&](std::int64_t row, std::span<double> values) -> Result<void> {
    for (std::size_t column = 0; column < values.size(); ++column) {
      const bool valid =
          import.grid->is_valid(static_cast<std::int32_t>(column), static_cast<std::int32_t>(row));
      values[column] = valid ? import.placements.at(next++).z : wanted.nodata;
    }
    return {};
  };
  const auto written = write_geotiff(out, wanted, rows, nullptr);
  ASSERT_TRUE(written.ok()) << written.error().message;
  const ReadBack before = read_back(source);
  const ReadBack after = read_back(out);
  EXPECT_EQ(after.width, before.width);
  EXPECT_EQ(after.height, before.height);
  EXPECT_EQ(after.geotransform, before.geotransform);
  EXPECT_EQ(after.values, before.values);
  EXPECT_EQ(after.authority, authority);
  if (before.nodata) {
    EXPECT_EQ(after.nodata, before.nodata);
  }
  const Import again = imported(out);
  EXPECT_EQ(again.placements, import.placements);
  EXPECT_EQ(again.frame, import.frame);
}

TEST_F(GeoTiffTest, ARasterComesBackAsItWas) {
  TiffSpec source;
  source.nodata = 11;
  make_tiff(path("source"), source);
  expect_round_trip(path("source"), path("out.tif"), {}, "EPSG:32632");
  source.geotransform[5] = 10;
  make_tiff(path("source"), source);
  expect_round_trip(path("source"), path("out.tif"), {}, "EPSG:32632");
}

TEST_F(GeoTiffTest, RealTerrainComesBackAsItWas) {
  for (const auto& [name, authority] :
       {std::pair{"luxembourg_elev_terra.tif", "EPSG:4326"}, std::pair{"SainteHelens.dem", "EPSG:26710"},
        std::pair{"olinda_dem_utm25s.tif", ""}}) {
    const auto upload = terrain(name);
    if (!upload) GTEST_SKIP() << "the real data is not here";
    expect_round_trip(*upload, path("out.tif"), named(name), authority);
  }
}

TEST_F(GeoTiffTest, ACloudOptimisedOneHasTheSamePixelsAndOverviews) {
  const RasterSpec wanted = spec(1500, 1100);
  ASSERT_TRUE(write_geotiff(path("plain.tif"), wanted, fill, nullptr).ok());
  for (const char* name : {"cog.tif", "again.tif"}) {
    ASSERT_TRUE(write_cog(path(name), wanted, fill, nullptr).ok());
  }
  const ReadBack plain = read_back(path("plain.tif")), cog = read_back(path("cog.tif"));
  EXPECT_EQ(cog.geotransform, plain.geotransform);
  EXPECT_EQ(cog.authority, plain.authority);
  EXPECT_EQ(cog.nodata, plain.nodata);
  EXPECT_EQ(cog.unit, plain.unit);
  EXPECT_TRUE(cog.values == plain.values);
  EXPECT_TRUE(bytes("cog.tif") == bytes("again.tif"));
  const GDALDatasetUniquePtr dataset(GDALDataset::Open(path("cog.tif").c_str(), GDAL_OF_RASTER));
  EXPECT_EQ(dataset->GetRasterBand(1)->GetOverviewCount(), 2);
  EXPECT_EQ(std::string(dataset->GetMetadataItem("LAYOUT", "IMAGE_STRUCTURE")), "COG");
  EXPECT_EQ(files_left(), 3U);
}

TEST_F(GeoTiffTest, ACloudOptimisedOneThatFailsLeavesNoFile) {
  const auto failing = [](std::int64_t, std::span<double>) -> Result<void> {
    return tin::base::error(Code::kCancelled, "enough");
  };
  EXPECT_EQ(write_cog(path("cog.tif"), spec(10, 10), failing, nullptr).error().code, Code::kCancelled);
  EXPECT_EQ(write_cog(path("none/cog.tif"), spec(10, 10), fill, nullptr).error().code, Code::kStorage);
  EXPECT_EQ(files_left(), 0U);
}

}  // namespace
}  // namespace server::gdal::testing
