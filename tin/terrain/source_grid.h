// The raster a terrain came from: where its pixel centres lie on the lattice, and which pixels were void.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "tin/exact/point.h"

namespace tin::terrain {

/// Geometry of a source raster, kept so that an export gives the source back. Column c, row r (row 0 as in the
/// source file) has its centre at the lattice point (x0 + c * dx, y0 + r * dy).
struct SourceGrid {
  std::int32_t width = 0;
  std::int32_t height = 0;
  std::int32_t x0 = 0, y0 = 0;  // centre of pixel (0, 0)
  std::int32_t dx = 0, dy = 0;  // lattice steps per column (> 0) and per row (< 0 for north-up rasters)
  std::array<double, 6> geotransform{};  // as GDAL gives it, so that exports repeat it bit for bit
  std::optional<double> nodata;          // the source's own nodata value, if it had one
  std::string data_type;                 // GDAL's name: "Int16", "Float32" ...
  /// One bit per pixel, row by row, 1 = valid; empty when every pixel is valid.
  std::vector<std::uint64_t> valid;

  struct Cell {
    std::int32_t column, row;
  };

  bool is_valid(std::int32_t column, std::int32_t row) const {
    if (valid.empty()) return true;
    const std::size_t bit = static_cast<std::size_t>(row) * static_cast<std::size_t>(width) + static_cast<std::size_t>(column);
    return (valid[bit / 64] >> (bit % 64)) & 1U;
  }
  exact::Point centre(std::int32_t column, std::int32_t row) const {
    return {x0 + column * dx, y0 + row * dy};
  }
  /// The pixel whose area holds `p` (on a pixel's edge: the one to the right and below in column and row order);
  /// nothing outside the raster.
  std::optional<Cell> cell_at(exact::Point p) const;
  /// The pixel whose centre is exactly `p`.
  std::optional<Cell> cell_centred_at(exact::Point p) const;

  friend bool operator==(const SourceGrid&, const SourceGrid&) = default;
};

}  // namespace tin::terrain
