// One tile of quantized-mesh 1.0, the terrain format of Cesium: bytes from a mesh whose positions are on the tile's lattice already.
//
//   QuantizedMesh mesh{rectangle, 0, 4095.875, vertices, triangles};
//   std::string bytes = encode_quantized_mesh(mesh, {.normals = true});
//
// Positions are 16-bit fractions of the tile in longitude, latitude and height. Vertices are put in the order of their first
// use, as the format's high-water mark coding asks for.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace proto::formats {

inline constexpr std::string_view kQuantizedMeshMediaType = "application/vnd.quantized-mesh";

/// The largest quantised coordinate: the tile's east or north side, or its upper height.
inline constexpr std::uint16_t kQuantizedMax = 32767;

/// In degrees.
struct TileRectangle {
  double west = 0, south = 0, east = 0, north = 0;
  friend bool operator==(const TileRectangle&, const TileRectangle&) = default;
};

struct QuantizedVertex {
  std::uint16_t u = 0, v = 0, h = 0;           // each 0 to kQuantizedMax
  std::array<float, 3> normal{0, 0, 1};        // east, north, up; a unit vector
};

struct QuantizedMesh {
  TileRectangle rectangle;
  float min_height = 0, max_height = 1;  // metres above the ellipsoid at h = 0 and h = kQuantizedMax
  std::vector<QuantizedVertex> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;  // counter-clockwise, seen from above
};

struct QuantizedMeshOptions {
  bool normals = false;   // extension 1: oct-encoded, in the earth-centred frame
  std::string metadata;   // extension 4: JSON; empty: without
};

/// Requires: at least one triangle; every vertex is used; indices in range.
std::string encode_quantized_mesh(const QuantizedMesh& mesh, const QuantizedMeshOptions& options);

/// Earth-centred, earth-fixed position of a place on or above the WGS 84 ellipsoid. Metres, degrees.
std::array<double, 3> earth_centred(double lon_deg, double lat_deg, double height_m);

}  // namespace proto::formats
