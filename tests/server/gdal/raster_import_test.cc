#include <gdal_priv.h>

#include <cmath>
#include <limits>

#include "tests/server/gdal/support.h"

namespace server::gdal::testing {
namespace {

using tin::base::Code;
using tin::exact::Point;

class RasterImportTest : public ScratchTest {
 protected:
  std::filesystem::path tiff(const TiffSpec& spec) const {
    make_tiff(path("upload"), spec);
    return path("upload");
  }
};

TEST_F(RasterImportTest, PutsPixelCentresOnTheLatticeInRowOrder) {
  const Import import = imported(tiff({}));
  EXPECT_EQ(import.driver, "GTiff");
  EXPECT_EQ(import.frame.crs, "EPSG:32632");
  EXPECT_EQ(import.frame.vertical_unit, "");
  ASSERT_EQ(import.placements.size(), 12U);
  ASSERT_TRUE(import.grid);
  const auto& grid = *import.grid;
  EXPECT_EQ(grid.width, 4);
  EXPECT_EQ(grid.height, 3);
  EXPECT_TRUE(grid.valid.empty());
  EXPECT_EQ(grid.data_type, "Float32");
  EXPECT_EQ(grid.geotransform, TiffSpec().geotransform);
  EXPECT_EQ(grid.dx, 10000);
  EXPECT_EQ(grid.dy, -10000);
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 4; ++column) {
      const auto& placed = import.placements[static_cast<std::size_t>(row * 4 + column)];
      EXPECT_EQ(placed.at, grid.centre(column, row));
      EXPECT_EQ(placed.at, import.frame.to_lattice(500005 + 10 * column, 4999995 - 10 * row).value());
      EXPECT_EQ(placed.z, 10 * row + column);
    }
  }
  EXPECT_EQ(files_left(), 1U) << "the private folder is gone";
}

TEST_F(RasterImportTest, ReadsRowsFromTheSouthToo) {
  TiffSpec spec;
  spec.geotransform = {500000, 10, 0, 4000000, 0, 10};
  const Import import = imported(tiff(spec));
  const auto& grid = *import.grid;
  EXPECT_EQ(grid.dy, 10000);
  ASSERT_EQ(import.placements.size(), 12U);
  EXPECT_EQ(import.placements[0].z, 0);
  EXPECT_EQ(import.placements[0].at, import.frame.to_lattice(500005, 4000005).value());
  EXPECT_EQ(import.placements[11].at, import.frame.to_lattice(500035, 4000025).value());
  EXPECT_EQ(grid.centre(3, 2), import.placements[11].at);
}

TEST_F(RasterImportTest, LeavesVoidsOut) {
  TiffSpec spec;
  spec.nodata = 11;
  spec.value = [](int column, int row) {
    if (row == 0 && column == 0) return std::nan("");
    if (row == 0 && column == 1) return static_cast<double>(std::numeric_limits<float>::infinity());
    if (row == 2 && column == 3) return -3.4028234663852886e38;
    return 10.0 * row + column;
  };
  const Import import = imported(tiff(spec));
  EXPECT_EQ(import.placements.size(), 8U);
  ASSERT_EQ(import.grid->valid.size(), 1U);
  EXPECT_EQ(import.grid->nodata, 11);
  EXPECT_FALSE(import.grid->is_valid(0, 0));
  EXPECT_FALSE(import.grid->is_valid(1, 0));
  EXPECT_FALSE(import.grid->is_valid(1, 1));
  EXPECT_FALSE(import.grid->is_valid(3, 2));
  EXPECT_TRUE(import.grid->is_valid(2, 2));
}

TEST_F(RasterImportTest, TakesANodataValueThatIsNoFloat) {
  TiffSpec spec;
  spec.nodata = -9999.9;
  spec.value = [](int column, int) { return column == 0 ? -9999.9 : 5.0; };
  EXPECT_EQ(imported(tiff(spec)).placements.size(), 9U);
}

TEST_F(RasterImportTest, HonoursAMask) {
  TiffSpec spec;
  spec.masked = true;
  const Import import = imported(tiff(spec));
  EXPECT_EQ(import.placements.size(), 11U);
  EXPECT_FALSE(import.grid->is_valid(0, 0));
}

TEST_F(RasterImportTest, AppliesScaleAndOffset) {
  TiffSpec spec;
  spec.type = "Int16";
  spec.scale = 0.5;
  spec.offset = 100;
  spec.nodata = 0;
  const Import import = imported(tiff(spec));
  ASSERT_EQ(import.placements.size(), 11U);
  EXPECT_EQ(import.placements[0].z, 100.5);
  EXPECT_EQ(import.grid->data_type, "Float64");
  EXPECT_FALSE(import.grid->nodata.has_value());
}

TEST_F(RasterImportTest, KnowsTheUnitOfHeights) {
  TiffSpec spec;
  spec.unit = "ft";
  const Import import = imported(tiff(spec));
  EXPECT_EQ(import.frame.vertical_unit, "foot");
  EXPECT_EQ(import.frame.vertical_unit_m, 0.3048);
}

TEST_F(RasterImportTest, TheClientsCrsReplacesTheFiles) {
  ImportOptions options;
  options.crs = "http://www.opengis.net/def/crs/EPSG/0/2994";
  EXPECT_EQ(imported(tiff({}), options).frame.crs, "EPSG:2994");
  TiffSpec bare;
  bare.crs = "";
  EXPECT_EQ(imported(tiff(bare)).frame.crs, "");
  options.crs = "nonsense";
  EXPECT_EQ(import_error(tiff({}), options).code, Code::kMalformed);
}

TEST_F(RasterImportTest, TakesTheResolutionThatIsAskedFor) {
  ImportOptions options;
  options.resolution_x = options.resolution_y = 0.1;
  EXPECT_EQ(imported(tiff({}), options).grid->dx, 100);
}

TEST_F(RasterImportTest, ReadsEveryRealType) {
  for (const char* type : {"Byte", "UInt16", "Int16", "UInt32", "Int32", "Float32", "Float64"}) {
    TiffSpec spec;
    spec.type = type;
    const Import import = imported(tiff(spec));
    EXPECT_EQ(import.grid->data_type, type);
    EXPECT_EQ(import.placements.size(), 12U);
  }
  for (const char* type : {"CFloat32", "CInt16", "Int64"}) {
    TiffSpec spec;
    spec.type = type;
    EXPECT_EQ(import_error(tiff(spec)).code, Code::kUnsupported) << type;
  }
}

TEST_F(RasterImportTest, ReadsTiledAndThinRasters) {
  TiffSpec spec;
  spec.width = 300;
  spec.height = 270;
  spec.creation_options = {"TILED=YES", "COMPRESS=DEFLATE", "BLOCKXSIZE=64", "BLOCKYSIZE=64"};
  spec.value = [](int column, int row) { return 1000.0 * row + column; };
  const Import tiled = imported(tiff(spec));
  ASSERT_EQ(tiled.placements.size(), 81000U);
  for (std::size_t i = 0; i < tiled.placements.size(); ++i) {
    ASSERT_EQ(tiled.placements[i].z, 1000.0 * static_cast<double>(i / 300) + static_cast<double>(i % 300));
  }
  TiffSpec row;
  row.height = 1;
  EXPECT_EQ(imported(tiff(row)).placements.size(), 4U);
  TiffSpec pixel;
  pixel.width = pixel.height = 1;
  EXPECT_EQ(imported(tiff(pixel)).placements.at(0).at, (Point{0, 0}));
}

TEST_F(RasterImportTest, ReadsAsciiGrids) {
  const Import import = imported(file("g",
                                      "ncols 3\nnrows 2\nxllcorner 100\nyllcorner 200\ncellsize 5\n"
                                      "NODATA_value -1\n1 2 3\n4 -1 6.5\n"));
  EXPECT_EQ(import.driver, "AAIGrid");
  EXPECT_EQ(import.frame.crs, "");
  EXPECT_EQ(import.placements.size(), 5U);
  EXPECT_EQ(import.placements.back().z, 6.5);
  EXPECT_EQ(import.placements.back().at, import.frame.to_lattice(112.5, 202.5).value());
}

TEST_F(RasterImportTest, RefusesRastersThatLieNowhereOrAskew) {
  TiffSpec nowhere;
  nowhere.placed = false;
  EXPECT_EQ(import_error(tiff(nowhere)).code, Code::kInvalidValue);
  TiffSpec rotated;
  rotated.geotransform = {500000, 10, 2, 5000000, 2, -10};
  EXPECT_EQ(import_error(tiff(rotated)).code, Code::kUnsupported);
  TiffSpec degrees;
  degrees.crs = "EPSG:4326";
  EXPECT_EQ(import_error(tiff(degrees)).code, Code::kInvalidValue) << "latitude 5000000";
}

TEST_F(RasterImportTest, RefusesRastersWithoutElevations) {
  TiffSpec spec;
  spec.nodata = 7;
  spec.value = [](int, int) { return 7.0; };
  const auto problem = import_error(tiff(spec));
  EXPECT_EQ(problem.code, Code::kInvalidValue);
  EXPECT_NE(problem.message.find("nodata"), std::string::npos);
}

TEST_F(RasterImportTest, HoldsItsLimits) {
  ImportOptions options;
  options.max_pixels = 12;
  options.max_samples = 12;
  EXPECT_EQ(imported(tiff({}), options).placements.size(), 12U);
  options.max_pixels = 11;
  EXPECT_EQ(import_error(tiff({}), options).code, Code::kTooLarge);
  options.max_pixels = 12;
  options.max_samples = 11;
  EXPECT_EQ(import_error(tiff({}), options).code, Code::kTooLarge);
}

TEST_F(RasterImportTest, ReportsProgressAndStopsWhenAsked) {
  tin::base::Progress progress;
  ASSERT_TRUE(import_file(tiff({}), {}, &progress).ok());
  EXPECT_EQ(progress.fraction(), 1);
  progress.cancel();
  EXPECT_EQ(import_file(tiff({}), {}, &progress).error().code, Code::kCancelled);
  EXPECT_EQ(files_left(), 1U);
}

/// Formats without a CRS, and with a blanking value of their own.
TEST_F(RasterImportTest, ReadsSurferGridsAndBinaryTerrain) {
  TiffSpec spec;
  spec.nodata = -9999;
  spec.value = [](int column, int row) { return column == 1 && row == 1 ? -9999.0 : 10.0 * row + column; };
  make_tiff(path("source.tif"), spec);
  const GDALDatasetUniquePtr source(GDALDataset::Open(path("source.tif").c_str(), GDAL_OF_RASTER));
  for (const char* driver : {"GSAG", "GSBG", "GS7BG", "BT"}) {
    SCOPED_TRACE(driver);
    const auto file = path(std::string("upload-") + driver);
    GDALDatasetUniquePtr copy;
    if (driver == std::string("BT")) {
      copy.reset(GetGDALDriverManager()->GetDriverByName(driver)->Create(file.c_str(), 4, 3, 1, GDT_Float32,
                                                                         nullptr));
      ASSERT_TRUE(copy);
      std::array<double, 6> transform = spec.geotransform;
      copy->SetGeoTransform(transform.data());
      std::array<float, 12> values{};
      for (std::size_t i = 0; i < values.size(); ++i) values[i] = static_cast<float>(10 * (i / 4) + i % 4);
      ASSERT_EQ(copy->GetRasterBand(1)->RasterIO(GF_Write, 0, 0, 4, 3, values.data(), 4, 3, GDT_Float32, 0, 0,
                                                 nullptr),
                CE_None);
    } else {
      copy.reset(GetGDALDriverManager()->GetDriverByName(driver)->CreateCopy(
          file.c_str(), source.get(), FALSE, nullptr, nullptr, nullptr));
    }
    ASSERT_TRUE(copy);
    copy.reset();
    const Import import = imported(file);
    EXPECT_EQ(import.driver, driver);
    ASSERT_TRUE(import.grid);
    EXPECT_EQ(import.grid->width, 4);
    EXPECT_EQ(import.placements.size(), driver == std::string("BT") ? 12U : 11U);
    EXPECT_EQ(import.frame.x.world(import.placements[0].at.x), 500005);
    EXPECT_NEAR(import.placements.back().z, 23, 1e-5);
    ImportOptions options;
    options.max_pixels = 11;
    EXPECT_EQ(import_error(file, options).code, Code::kTooLarge);
  }
}

}  // namespace
}  // namespace server::gdal::testing
