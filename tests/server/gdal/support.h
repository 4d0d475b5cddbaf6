// Files for the tests of server/gdal: a scratch folder, small rasters made with GDAL, and the real data where
// it is.
#pragma once

#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "server/gdal/import.h"

namespace server::gdal::testing {

/// A fresh folder for one test, removed afterwards.
class ScratchTest : public ::testing::Test {
 protected:
  ScratchTest();
  ~ScratchTest() override;

  /// Writes `content` into a file of this name in the folder.
  std::filesystem::path file(const std::string& name, std::string_view content) const;
  std::filesystem::path path(const std::string& name) const { return folder_ / name; }
  /// A copy of a file of the real data, or nothing where it is not there: then the test should be skipped.
  std::optional<std::filesystem::path> terrain(const std::string& name) const;
  /// How many files are left in the folder, to see that nothing else is.
  std::size_t files_left() const;

 private:
  std::filesystem::path folder_;
};

/// A GeoTIFF as tests want it.
struct TiffSpec {
  int width = 4;
  int height = 3;
  std::string type = "Float32";
  std::array<double, 6> geotransform{500000, 10, 0, 5000000, 0, -10};
  bool placed = true;  // whether it has a geotransform
  std::string crs = "EPSG:32632";
  std::optional<double> nodata;
  double scale = 1, offset = 0;
  std::string unit;
  std::vector<std::string> creation_options;
  bool masked = false;  // with an internal mask that leaves out pixel (0, 0)
  std::function<double(int column, int row)> value = [](int column, int row) { return 10.0 * row + column; };
};
void make_tiff(const std::filesystem::path& file, const TiffSpec& spec);

/// A point layer made with one of GDAL's vector drivers; heights in the geometry, and doubled in the field
/// "twice".
struct PointLayer {
  std::string name = "points";
  std::string crs = "EPSG:32632";
  std::vector<std::array<double, 3>> points;
  bool polygons = false;  // a layer of polygons instead, without features
};
void make_vector(const std::filesystem::path& file, const std::string& driver,
                 const std::vector<PointLayer>& layers);

/// What GDAL itself reads back.
struct ReadBack {
  int width = 0, height = 0;
  std::array<double, 6> geotransform{};
  std::string authority;  // "EPSG:4326", or empty
  std::optional<double> nodata;
  std::string data_type, unit, area_or_point, compression, predictor;
  int block_width = 0, block_height = 0;
  std::vector<double> values;
};
ReadBack read_back(const std::filesystem::path& file);

/// Shortcuts: the code of the error, which must be there; the import, which must work.
tin::base::Error import_error(const std::filesystem::path& file, const ImportOptions& options = {});
Import imported(const std::filesystem::path& file, const ImportOptions& options = {});
ImportOptions named(const std::string& file_name);

}  // namespace server::gdal::testing
