// The two ways to make a tile.
#pragma once

#include "server/tiles/terrain_tile.h"

namespace server::tiles {

/// From the surface at the nodes of a grid.
tin::base::Result<TerrainTile> make_grid_tile(const tin::terrain::Terrain& terrain, const Tileset& tiles, const TileId& id);
/// From the TIN's own triangles, cut at the tile's sides.
tin::base::Result<TerrainTile> make_cut_tile(const tin::terrain::Terrain& terrain, const Tileset& tiles, const TileId& id);

}  // namespace server::tiles
