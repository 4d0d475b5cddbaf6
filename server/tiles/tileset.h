// The pyramid of quantized-mesh tiles over one version of a terrain: how deep it is, which tiles there are, and the lattice of
// heights that all of them share.
//
// The lowest level holds the TIN itself, cut at the sides of its tiles. Levels above it hold the surface at the nodes of a
// grid, as fine as Cesium takes a tile of that level to be.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "server/tiles/tile.h"
#include "tin/base/result.h"
#include "tin/terrain/terrain.h"

namespace server::tiles {

/// Heights in metres: base + k * step for k = 0 .. kQuantizedMax. Step and base are such that floats hold both ends exactly, and
/// that small changes of the terrain's range leave them as they are.
struct HeightLattice {
  double base_m = 0, step_m = 1;
  std::uint16_t quantised(double height_m) const;
  double top_m() const { return base_m + step_m * proto::formats::kQuantizedMax; }
  friend bool operator==(const HeightLattice&, const HeightLattice&) = default;
};

/// The lattice for heights from `low` to `high`, 0 among them (it stands for the ground beyond the terrain).
HeightLattice height_lattice(double low_m, double high_m);

struct Tileset {
  proto::formats::TileRectangle extent;  // of the terrain
  int levels = 1;                        // the lowest is levels - 1
  HeightLattice heights;

  /// Inclusive ranges of columns and rows, one for each level.
  std::array<std::uint32_t, 4> available(int level) const;
  bool has(const TileId& id) const;
  bool is_lowest(const TileId& id) const { return id.z == levels - 1; }
};

/// Equal for equal terrains. Errors: kNotFound: no CRS, none that goes with longitude and latitude, no triangles. Cost: O(n).
tin::base::Result<Tileset> make_tileset(const tin::terrain::Terrain& terrain);

}  // namespace server::tiles
