// Writing a raster of elevations as a GeoTIFF, row by row.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string>

#include "tin/base/progress.h"
#include "tin/base/result.h"

namespace server::gdal {

/// What a GeoTIFF says of itself.
struct RasterSpec {
  std::int64_t width = 0;
  std::int64_t height = 0;
  std::array<double, 6> geotransform{};  // in GDAL's order; written bit for bit
  std::string crs;                       // any form that read_crs() takes; empty: none
  std::string data_type = "Float32";     // "Float32" or "Float64"
  double nodata = -9999;                 // as a value of `data_type`; may be NaN
  std::string vertical_unit = "metre";   // unit of the values; empty: not said
};

/// Fills `values`, one per column, with those of row `row`; rows are asked for once each, in order from 0.
using RowSource = std::function<tin::base::Result<void>(std::int64_t row, std::span<double> values)>;

/// Writes `out` (which is replaced): tiled, DEFLATE with the floating-point predictor, BigTIFF where it may
/// be needed. Equal input gives equal bytes. Memory: at most 64 MiB, or 16 rows. On error there is no file.
/// Errors: kInvalidValue (size, geotransform, data type, nodata), as read_crs(), those of `rows`, kStorage,
/// kCancelled. `progress` may be null.
tin::base::Result<void> write_geotiff(const std::filesystem::path& out, const RasterSpec& spec,
                                      const RowSource& rows, tin::base::Progress* progress);

/// The same as a cloud-optimised GeoTIFF with overviews, each pixel the average of four. A temporary GeoTIFF
/// is written beside `out` first. Memory and errors: as write_geotiff(); `progress` counts the first half.
tin::base::Result<void> write_cog(const std::filesystem::path& out, const RasterSpec& spec,
                                  const RowSource& rows, tin::base::Progress* progress);

}  // namespace server::gdal
