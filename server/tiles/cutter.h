// Cuts triangles at the sides of a tile and puts what is inside on the tile's lattice.
#pragma once

#include <array>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "server/tiles/terrain_tile.h"

namespace server::tiles {

/// A corner of a triangle: degrees, metres, and the direction up from the surface.
struct Corner {
  double lon = 0, lat = 0, height = 0;
  std::array<float, 3> normal{0, 0, 1};
};

/// One thread.
class Cutter {
 public:
  Cutter(const proto::formats::TileRectangle& rectangle, const HeightLattice& heights);

  /// Adds what of a counter-clockwise triangle lies in the tile. `terrain`: the stated error is about it.
  void add(const std::array<Corner, 3>& corners, bool terrain);
  /// How far, in degrees, straight lines between corners stray from the terrain's own edges.
  void set_stray(double lon, double lat);

  /// The tile. Errors: kNotFound when nothing was inside.
  tin::base::Result<TerrainTile> finish();

 private:
  static constexpr int kCutSide = -1;  // an edge that lies along a side of the tile
  struct Point {
    Corner at;
    int edge = kCutSide;  // of the triangle, that leads from here to the next point
  };
  using Polygon = std::vector<Point>;
  enum class Axis { kLon, kLat };

  void cut(Polygon& polygon, const std::array<Corner, 3>& corners, Axis axis, double at, bool keep_above) const;
  std::uint32_t vertex(const Corner& at);
  void add_slope(const std::array<Corner, 3>& corners);

  const proto::formats::TileRectangle rectangle_;
  const HeightLattice heights_;
  proto::formats::QuantizedMesh mesh_;
  std::unordered_map<std::uint32_t, std::uint32_t> vertices_;  // by u and v
  Polygon polygon_;
  double stray_lon_ = 0, stray_lat_ = 0;
  double steepest_lon_ = 0, steepest_lat_ = 0;  // metres of height a degree
  bool any_terrain_ = false;
};

}  // namespace server::tiles
