// The mesh of one quantized-mesh tile.
//
// Neighbours meet without a gap: a position on a side is computed from what both tiles see alike (an edge of the TIN or of the
// ground around it, and the number of that side), rounded on a lattice of heights that both share, and nothing but such
// positions is ever rounded onto a side.
#pragma once

#include "server/tiles/tileset.h"

namespace server::tiles {

/// What a tile is made of, and how far it may lie from the terrain where it shows it.
struct TerrainTile {
  proto::formats::QuantizedMesh mesh;
  /// Metres, vertically, from the TIN's surface in the lowest level; negative: not known.
  double error_m = -1;
};

/// Requires: tiles.has(id), and `tiles` are make_tileset() of this terrain. Ground beyond the terrain slopes to 0 m in the lowest
/// level and lies at 0 m above it. Errors: as make_tileset(). Cost: O(vertices in the tile).
tin::base::Result<TerrainTile> make_terrain_tile(const tin::terrain::Terrain& terrain, const Tileset& tiles, const TileId& id);

}  // namespace server::tiles
