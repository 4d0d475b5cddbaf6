// Terrains whose surface is a known function, and terrains that have next to nothing.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "tests/support/point_sets.h"
#include "tests/tin/simplify/terrains.h"
#include "tin/frame/ground.h"
#include "tin/terrain/terrain.h"

namespace support {

using Height = std::function<double(tin::exact::Point)>;

/// A terrain of these points, which are distinct, in a local frame of one step a metre.
inline tin::terrain::Terrain terrain_of(const std::vector<tin::exact::Point>& points, const Height& height) {
  std::vector<tin::terrain::Placement> placements;
  for (const auto p : points) placements.push_back({p, height(p)});
  tin::frame::Frame frame;
  frame.x = frame.y = {0, 1, 1};
  return *tin::terrain::Terrain::build(frame, placements, tin::terrain::Duplicates::kReject);
}

/// The ground of such a terrain.
inline tin::frame::Ground metre_ground() {
  tin::frame::Frame frame;
  frame.x = frame.y = {0, 1, 1};
  return {frame, {}};
}

/// The terrain of a raster whose cells without heights are void, `dx` by `dy` lattice steps each.
inline tin::terrain::Terrain voided_terrain(const Heights& raster, std::int32_t dx, std::int32_t dy) {
  auto terrain = raster_terrain(raster, dx, dy);
  auto grid = std::make_shared<tin::terrain::SourceGrid>(*terrain.source_grid());
  grid->valid.assign((raster.z.size() + 63) / 64, 0);
  for (std::size_t i = 0; i < raster.z.size(); ++i) {
    if (raster.z[i]) grid->valid[i / 64] |= std::uint64_t{1} << (i % 64);
  }
  terrain.set_source_grid(std::move(grid));
  return terrain;
}

inline double plane(tin::exact::Point p) {
  return 3 + 0.25 * p.x - 0.5 * p.y;
}

struct NamedTerrain {
  std::string name;
  tin::terrain::Terrain terrain;
};

/// Empty, one vertex, two, collinear along and across the axes and slanted.
inline std::vector<NamedTerrain> degenerate_terrains() {
  std::vector<NamedTerrain> out;
  out.push_back({"empty", terrain_of({}, plane)});
  out.push_back({"one vertex", terrain_of({{4, 7}}, plane)});
  out.push_back({"two vertices", terrain_of({{0, 0}, {10, 20}}, plane)});
  out.push_back({"a row", terrain_of(line_points(9, 3, 0), plane)});
  out.push_back({"a column", terrain_of(line_points(9, 0, 3), plane)});
  out.push_back({"slanted", terrain_of(line_points(9, 3, -2), plane)});
  return out;
}

}  // namespace support
