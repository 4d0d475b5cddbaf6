#include "server/tiles/tileset.h"

#include <algorithm>
#include <cmath>

#include "server/gdal/crs.h"

namespace server::tiles {

using proto::formats::kQuantizedMax;
using tin::base::Code;
using tin::base::error;
using tin::base::Result;
using tin::terrain::Terrain;

namespace {

/// The lowest level is the first whose fullest tile has no more vertices than this, and which is no wider than the terrain.
constexpr std::uint32_t kFullTile = 8192;
/// Bins a side, at most, in which vertices are counted to find that level.
constexpr int kMostBins = 1024;

Result<proto::formats::TileRectangle> extent_of(const Terrain& terrain, const tin::terrain::Box& box) {
  constexpr int kParts = 32;
  const auto& frame = terrain.frame();
  std::vector<double> x, y;
  for (int i = 0; i <= kParts; ++i) {
    const double u = static_cast<double>(i) / kParts;
    const double along_x = frame.x.world(box.min.x + u * (static_cast<double>(box.max.x) - box.min.x)),
                 along_y = frame.y.world(box.min.y + u * (static_cast<double>(box.max.y) - box.min.y));
    x.insert(x.end(), {along_x, along_x, frame.x.world(box.min.x), frame.x.world(box.max.x)});
    y.insert(y.end(), {frame.y.world(box.min.y), frame.y.world(box.max.y), along_y, along_y});
  }
  std::vector<std::uint8_t> ok(x.size(), 1);
  if (frame.crs != "EPSG:4326") {
    auto way = gdal::CrsTransform::create(frame.crs, "EPSG:4326");
    if (!way || !way->transform(x, y, ok)) {
      return error(Code::kNotFound, "The TIN's CRS cannot be converted to longitude and latitude.");
    }
  }
  const auto [west, east] = std::minmax_element(x.begin(), x.end());
  const auto [south, north] = std::minmax_element(y.begin(), y.end());
  if (*west < -180 || *east > 180 || *south < -90 || *north > 90) {
    return error(Code::kNotFound, "The TIN reaches beyond the longitudes and latitudes of the globe.");
  }
  return proto::formats::TileRectangle{*west, *south, *east, *north};
}

/// The largest number of vertices in any of `bins` x `bins` equal parts of the box.
std::uint32_t fullest_bin(const Terrain& terrain, const tin::terrain::Box& box, int bins_x, int bins_y) {
  std::vector<std::uint32_t> counts(static_cast<std::size_t>(bins_x) * static_cast<std::size_t>(bins_y));
  const auto& mesh = terrain.mesh();
  const double per_x = bins_x / (static_cast<double>(box.max.x) - box.min.x + 1),
               per_y = bins_y / (static_cast<double>(box.max.y) - box.min.y + 1);
  for (std::uint32_t slot = 1; slot < mesh.vertex_slots(); ++slot) {
    if (!mesh.is_alive(tin::mesh::VertexSlot(slot))) continue;
    const auto at = mesh.point(tin::mesh::VertexSlot(slot));
    const auto i = static_cast<std::size_t>((static_cast<double>(at.x) - box.min.x) * per_x),
               j = static_cast<std::size_t>((static_cast<double>(at.y) - box.min.y) * per_y);
    ++counts[j * static_cast<std::size_t>(bins_x) + i];
  }
  return *std::max_element(counts.begin(), counts.end());
}

int lowest_level(const Terrain& terrain, const tin::terrain::Box& box, const proto::formats::TileRectangle& extent) {
  const double width = extent.east - extent.west, height = extent.north - extent.south;
  int z = 0;
  while (z < kMostLevels && tile_degrees(z) > std::max(width, height)) ++z;
  for (; z < kMostLevels; ++z) {
    const auto bins = [&](double length) { return std::max(1, static_cast<int>(std::lround(length / tile_degrees(z)))); };
    const int bins_x = bins(width), bins_y = bins(height);
    if (bins_x > kMostBins || bins_y > kMostBins || fullest_bin(terrain, box, bins_x, bins_y) <= kFullTile) break;
  }
  return z;
}

}  // namespace

std::uint16_t HeightLattice::quantised(double height_m) const {
  return static_cast<std::uint16_t>(std::clamp(std::round((height_m - base_m) / step_m), 0.0, double{kQuantizedMax}));
}

HeightLattice height_lattice(double low_m, double high_m) {
  low_m = std::min(low_m, 0.0);
  high_m = std::max(high_m, 0.0);
  HeightLattice lattice{0, 0x1p-10};
  for (;; lattice.step_m *= 2) {
    // The base moves in blocks of 4096 steps; floats hold block numbers and steps together in their 24 bits.
    const double block = 4096 * lattice.step_m;
    lattice.base_m = std::floor(low_m / block) * block;
    if (lattice.top_m() >= high_m && std::abs(lattice.base_m) <= 256 * block && lattice.top_m() <= 256 * block) return lattice;
  }
}

std::array<std::uint32_t, 4> Tileset::available(int level) const {
  const double size = tile_degrees(level);
  const std::uint32_t columns = std::uint32_t{2} << level, rows = std::uint32_t{1} << level;
  if (level == 0) return {0, 0, 1, 0};  // the whole globe: Cesium begins with both
  const auto index = [size](double at, double origin, std::uint32_t count) {
    return static_cast<std::uint32_t>(std::clamp(std::floor((at - origin) / size), 0.0, static_cast<double>(count - 1)));
  };
  return {index(extent.west, -180, columns), index(extent.south, -90, rows), index(extent.east, -180, columns),
          index(extent.north, -90, rows)};
}

bool Tileset::has(const TileId& id) const {
  if (id.z < 0 || id.z >= levels) return false;
  const auto [x0, y0, x1, y1] = available(id.z);
  return id.x >= x0 && id.x <= x1 && id.y >= y0 && id.y <= y1;
}

Result<Tileset> make_tileset(const Terrain& terrain) {
  if (terrain.frame().crs.empty()) return error(Code::kNotFound, "The TIN has no CRS, so it has no place on the globe.");
  const auto box = terrain.bounds();
  const auto range = terrain.z_range();
  if (!box || !range || terrain.triangle_count() == 0) return error(Code::kNotFound, "The TIN has no triangles.");
  const auto extent = extent_of(terrain, *box);
  if (!extent) return extent.error();
  const double unit = terrain.frame().vertical_unit_m;
  return Tileset{*extent, lowest_level(terrain, *box, *extent) + 1, height_lattice(range->min * unit, range->max * unit)};
}

}  // namespace server::tiles
