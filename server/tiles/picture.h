// Square pictures of a terrain for maps on the web: elevations as colours, and shaded relief.
#pragma once

#include <string>

#include "server/tiles/tile.h"
#include "tin/base/result.h"
#include "tin/terrain/terrain.h"

namespace server::tiles {

enum class PictureKind { kTerrarium, kMapbox, kHillshade };

/// Pixels a side.
inline constexpr int kPicturePixels = 256;

/// The PNG of a tile. Elevations are those of pixel centres, 0 m where there is no terrain; there relief is transparent.
/// Errors: as Sampler::create().
tin::base::Result<std::string> picture_tile(const tin::terrain::Terrain& terrain, PictureKind kind, const TileId& id);

}  // namespace server::tiles
