// Tiles above the lowest level: the surface at the nodes of a grid.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "server/tiles/sampler.h"
#include "server/tiles/terrain_tile_internal.h"

namespace server::tiles {

using proto::formats::kQuantizedMax;
using proto::formats::QuantizedVertex;
using tin::base::Result;

namespace {

/// Cells a side: what Cesium takes for granted when it says how exact a level is.
constexpr int kCells = 64;
constexpr int kNodes = kCells + 1;
/// And one more node all around, for slopes.
constexpr int kWide = kNodes + 2;

double or_ground(double height) {
  return std::isnan(height) ? 0 : height;
}

/// East, north, up at a node, from its four neighbours.
std::array<float, 3> normal_at(const std::vector<double>& heights, int i, int j, double lat, double node_degrees) {
  const auto at = [&](int column, int row) { return or_ground(heights[static_cast<std::size_t>(row * kWide + column)]); };
  const auto metres = tin::frame::degree_lengths(lat);
  const double east = (at(i + 1, j) - at(i - 1, j)) / (2 * node_degrees * metres.lon_m),
               north = (at(i, j + 1) - at(i, j - 1)) / (2 * node_degrees * metres.lat_m);
  const double size = std::sqrt(1 + east * east + north * north);
  return {static_cast<float>(-east / size), static_cast<float>(-north / size), static_cast<float>(1 / size)};
}

/// Longitude and latitude of every node, those around the tile held to the globe.
void lay_nodes(const TileId& id, std::vector<double>& lon, std::vector<double>& lat) {
  for (int j = -1; j <= kNodes; ++j) {
    for (int i = -1; i <= kNodes; ++i) {
      const auto column = static_cast<std::int64_t>(id.x) * kCells + i, row = static_cast<std::int64_t>(id.y) * kCells + j;
      const double cell = tile_degrees(id.z) / kCells;
      lon.push_back(std::clamp(-180 + cell * static_cast<double>(column), -180.0, 180.0));
      lat.push_back(std::clamp(-90 + cell * static_cast<double>(row), -90.0, 90.0));
    }
  }
}

}  // namespace

Result<TerrainTile> make_grid_tile(const tin::terrain::Terrain& terrain, const Tileset& tiles, const TileId& id) {
  auto sampler = Sampler::create(terrain, "EPSG:4326");
  if (!sampler) return sampler.error();
  std::vector<double> lon, lat;
  lay_nodes(id, lon, lat);
  const std::vector<double> heights = sampler->heights(lon, lat);
  TerrainTile tile;
  tile.mesh.rectangle = geographic_rectangle(id);
  tile.mesh.min_height = static_cast<float>(tiles.heights.base_m);
  tile.mesh.max_height = static_cast<float>(tiles.heights.top_m());
  for (int j = 0; j < kNodes; ++j) {
    for (int i = 0; i < kNodes; ++i) {
      const auto node = static_cast<std::size_t>((j + 1) * kWide + i + 1);
      QuantizedVertex vertex;
      vertex.u = static_cast<std::uint16_t>(std::lround(double{kQuantizedMax} * i / kCells));
      vertex.v = static_cast<std::uint16_t>(std::lround(double{kQuantizedMax} * j / kCells));
      vertex.h = tiles.heights.quantised(or_ground(heights[node]));
      vertex.normal = normal_at(heights, i + 1, j + 1, lat[node], tile_degrees(id.z) / kCells);
      tile.mesh.vertices.push_back(vertex);
    }
  }
  for (std::uint32_t j = 0; j < kCells; ++j) {
    for (std::uint32_t i = 0; i < kCells; ++i) {
      const std::uint32_t a = j * kNodes + i, b = a + 1, c = a + kNodes, d = c + 1;
      tile.mesh.triangles.push_back({a, b, d});
      tile.mesh.triangles.push_back({a, d, c});
    }
  }
  return tile;
}

}  // namespace server::tiles
