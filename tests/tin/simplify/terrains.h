// Terrains to simplify: rasters drawn by seed, scattered points, and real ones from .hgt files.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "tests/support/point_sets.h"
#include "tin/terrain/terrain.h"

namespace support {

/// A raster of heights, row 0 in the north; nothing where there is no sample.
struct Heights {
  std::int32_t width = 0, height = 0;
  std::vector<std::optional<double>> z;
};

Heights heights(std::int32_t width, std::int32_t height,
                const std::function<std::optional<double>(std::int32_t column, std::int32_t row)>& z);

/// The terrain of a raster with cells `dx` by `dy` lattice steps.
tin::terrain::Terrain raster_terrain(const Heights& raster, std::int32_t dx = 7, std::int32_t dy = 11);

struct NamedHeights {
  std::string name;
  Heights raster;
};
/// One small raster of each kind: noise, plateaus, spikes, one-pixel ridges, voids, slopes, fractions, 2 x 2,
/// constant.
std::vector<NamedHeights> hard_rasters(Random& random, std::int32_t size);

/// Points at random, heights from waves and noise; no raster behind them.
tin::terrain::Terrain scattered_terrain(Random& random, std::size_t count, std::int32_t extent,
                                        bool whole_heights);

/// A square SRTM tile: big-endian int16, -32768 void; the frame fitted as an import does. Nothing when it is
/// not there.
std::optional<tin::terrain::Terrain> hgt_terrain(const std::string& path, double south_latitude,
                                                 std::int32_t crop = 0);

}  // namespace support
