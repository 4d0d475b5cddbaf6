// Names of tiles and where they lie: geographic tiles for quantized-mesh, web-mercator tiles for pictures.
#pragma once

#include <cstdint>

#include "proto/formats/quantized_mesh.h"

namespace server::tiles {

/// Level, column from the west, row: from the south for geographic tiles (TMS), from the north for pictures (XYZ).
struct TileId {
  int z = 0;
  std::uint32_t x = 0, y = 0;
  friend auto operator<=>(const TileId&, const TileId&) = default;
};

inline constexpr int kMostLevels = 24;

/// Degrees that a geographic tile of a level is wide and high.
constexpr double tile_degrees(int z) {
  return 180.0 / static_cast<double>(std::uint32_t{1} << z);
}
/// Whether there is such a tile on the globe.
constexpr bool geographic_tile_exists(const TileId& id) {
  return id.z >= 0 && id.z <= kMostLevels && id.x < std::uint32_t{2} << id.z && id.y < std::uint32_t{1} << id.z;
}
constexpr bool mercator_tile_exists(const TileId& id) {
  return id.z >= 0 && id.z <= kMostLevels && id.x < std::uint32_t{1} << id.z && id.y < std::uint32_t{1} << id.z;
}

/// The side at column or row `i` of `parts` between two tiles' corners: one number for all tiles that have it.
constexpr double longitude_at(int z, std::uint64_t i, std::uint64_t parts) {
  return -180.0 + tile_degrees(z) * (static_cast<double>(i) / static_cast<double>(parts));
}
constexpr double latitude_at(int z, std::uint64_t j, std::uint64_t parts) {
  return -90.0 + tile_degrees(z) * (static_cast<double>(j) / static_cast<double>(parts));
}

constexpr proto::formats::TileRectangle geographic_rectangle(const TileId& id) {
  return {longitude_at(id.z, id.x, 1), latitude_at(id.z, id.y, 1), longitude_at(id.z, std::uint64_t{id.x} + 1, 1),
          latitude_at(id.z, std::uint64_t{id.y} + 1, 1)};
}

/// A web-mercator tile in metres of EPSG:3857: west, south, east, north.
struct MercatorSquare {
  double west = 0, south = 0, east = 0, north = 0;
};
constexpr MercatorSquare mercator_square(const TileId& id) {
  constexpr double kHalf_m = 20037508.342789244;
  const double size = 2 * kHalf_m / static_cast<double>(std::uint32_t{1} << id.z);
  return {-kHalf_m + size * id.x, kHalf_m - size * (id.y + 1.0), -kHalf_m + size * (id.x + 1.0), kHalf_m - size * id.y};
}

}  // namespace server::tiles
