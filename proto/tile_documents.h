// What describes tiles to those who fetch them: layer.json for Cesium, TileJSON for MapLibre and others.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace proto {

/// Tiles of the levels 0, 10, 20 ... say in their metadata which tiles of the next ten levels lie below them. Cesium goes by that
/// instead of the list in layer.json, and expects it of all that bear metadata.
inline constexpr int kMetadataLevels = 10;

struct LayerDocument {
  std::string name;
  std::uint64_t revision = 0;
  std::array<double, 4> bounds{};                       // west, south, east, north
  std::vector<std::array<std::uint32_t, 4>> available;  // first and last column and row, for each level from 0 on
};
std::string layer_json(const LayerDocument& layer);

struct TileJsonDocument {
  std::string name;
  std::string tiles;     // URL with {z}, {x} and {y}
  std::string encoding;  // "terrarium" or "mapbox"; empty: a picture
  int max_zoom = 0;
  std::array<double, 4> bounds{};
  std::uint64_t revision = 0;
};
std::string tilejson_json(const TileJsonDocument& document);

}  // namespace proto
