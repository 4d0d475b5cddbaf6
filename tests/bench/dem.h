// Elevation rasters for the benchmark of simplification: read by GDAL, laid on a lattice as an import does, and made up.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "tin/terrain/source_grid.h"
#include "tin/terrain/source_samples.h"

namespace bench {

struct Dem {
  std::string name;
  std::shared_ptr<const tin::terrain::SourceGrid> grid;
  std::vector<double> z;  // row by row; NaN: void

  std::int32_t width() const { return grid->width; }
  std::int32_t height() const { return grid->height; }
  tin::terrain::SourceSamples samples() const { return tin::terrain::SourceSamples::raster(grid, z); }
};

/// The first band of a file. Throws std::runtime_error when it can't be read.
Dem read_dem(const std::string& path);
/// The same terrain on a raster of `side` by `side` samples over the same ground, interpolated (cubically in each direction) and
/// rounded to whole heights, with noise of one unit: real terrain at a scale that no file here has.
Dem enlarged(const Dem& dem, std::int32_t side);
/// The same heights on pixels as wide as they are high, as peers see them: what is Delaunay depends on it.
Dem squared(const Dem& dem);
/// Heights as a picture: 8 bits per sample. Throws std::runtime_error when the file can't be written.
void write_png(const std::string& path, std::int32_t width, std::int32_t height, const std::vector<std::uint8_t>& grey);

}  // namespace bench
