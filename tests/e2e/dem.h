// Real terrains, and what is true of them, read without any of the server's code.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace tests::e2e {

/// A raster of elevations as GDAL reads it.
struct Dem {
  std::filesystem::path file;
  int width = 0, height = 0;
  std::array<double, 6> geotransform{};
  std::optional<double> nodata;
  std::vector<double> values;  // row by row from the north

  explicit Dem(const std::filesystem::path& file);

  double value(int column, int row) const { return values[static_cast<std::size_t>(row) * width + column]; }
  bool valid(int column, int row) const { return !nodata || value(column, row) != *nodata; }
  double x(int column) const { return geotransform[0] + (column + 0.5) * geotransform[1]; }
  double y(int row) const { return geotransform[3] + (row + 0.5) * geotransform[5]; }
  std::size_t valid_count() const;
};

/// The terrains that there are: luxembourg (voids, degrees) and olinda (projected) of the sample, and others
/// of a folder of larger ones. Empty when a file is not there.
std::optional<std::filesystem::path> terrain_file(const std::string& name);

/// A terrain that is there always: of the sample. Throws a sentence that says how to get it.
std::filesystem::path sample_file(const std::string& name);

/// The samples that a triangulation misses by more than a tolerance.
struct Misses {
  std::size_t uncovered = 0;  // valid samples in no triangle
  std::size_t beyond = 0;     // valid samples farther away than the tolerance
  double largest = 0;         // vertical distance
  std::size_t strangers = 0;  // vertices that are no sample, or have another elevation
};

/// Rasterises the triangles of a GeoJSON, in the DEM's CRS, over the DEM's pixel centres. Vertices are
/// recognised as pixels, so that who lies in which triangle is decided in integers.
Misses compare(const Dem& dem, const nlohmann::json& triangles, double tolerance);

/// The pixels (column, row) whose centres lie strictly inside the union of the triangles. Requires: the
/// triangles are those of a star whose centre is a pixel's, their corners pixels.
std::vector<std::pair<int, int>> strictly_inside(const Dem& dem, const nlohmann::json& star);

}  // namespace tests::e2e
