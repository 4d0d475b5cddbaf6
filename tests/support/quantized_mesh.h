// A reader of quantized-mesh tiles, for tests: written from the format's description, apart from the encoder.
#pragma once

#include <array>
#include <cstdint>
#include <cstring>
#include <stdexcept>
#include <string>
#include <vector>

namespace tests::support {

struct DecodedTile {
  std::array<double, 3> centre{}, sphere_centre{}, horizon{};
  float min_height = 0, max_height = 0;
  double radius = 0;
  std::vector<int> u, v, h;
  std::vector<std::uint32_t> indices;
  std::array<std::vector<std::uint32_t>, 4> edges;  // west, south, east, north
  std::vector<std::array<std::uint8_t, 2>> normals;
  std::string metadata;

  double height(std::size_t i) const { return min_height + (double{max_height} - min_height) * h[i] / 32767; }
};

class TileReader {
 public:
  explicit TileReader(const std::string& bytes) : bytes_(bytes) {}

  DecodedTile read() {
    DecodedTile tile;
    for (double& part : tile.centre) part = take<double>();
    tile.min_height = take<float>();
    tile.max_height = take<float>();
    for (double& part : tile.sphere_centre) part = take<double>();
    tile.radius = take<double>();
    for (double& part : tile.horizon) part = take<double>();
    if (at_ != 88) throw std::runtime_error("the header has 88 bytes");
    const auto count = take<std::uint32_t>();
    for (auto* values : {&tile.u, &tile.v, &tile.h}) read_deltas(*values, count);
    const bool wide = count > 65536;
    at_ += wide ? (4 - at_ % 4) % 4 : at_ % 2;
    const auto triangles = take<std::uint32_t>();
    std::uint32_t highest = 0;
    for (std::uint32_t i = 0; i < 3 * triangles; ++i) {
      const std::uint32_t code = index(wide);
      if (code > highest) throw std::runtime_error("an index before the vertices are in use");
      tile.indices.push_back(highest - code);
      if (code == 0) ++highest;
      if (tile.indices.back() >= count) throw std::runtime_error("an index beyond the vertices");
    }
    if (highest != count) throw std::runtime_error("not all vertices are used");
    for (auto& edge : tile.edges) {
      for (auto left = take<std::uint32_t>(); left > 0; --left) edge.push_back(index(wide));
    }
    while (at_ < bytes_.size()) read_extension(tile, count);
    return tile;
  }

 private:
  template <class T>
  T take() {
    if (at_ + sizeof(T) > bytes_.size()) throw std::runtime_error("the tile is cut");
    T value;
    std::memcpy(&value, bytes_.data() + at_, sizeof value);
    at_ += sizeof value;
    return value;
  }
  std::uint32_t index(bool wide) { return wide ? take<std::uint32_t>() : take<std::uint16_t>(); }
  void read_deltas(std::vector<int>& values, std::uint32_t count) {
    int value = 0;
    for (std::uint32_t i = 0; i < count; ++i) {
      const int code = take<std::uint16_t>();
      value += code % 2 == 0 ? code / 2 : -(code + 1) / 2;
      if (value < 0 || value > 32767) throw std::runtime_error("a coordinate out of range");
      values.push_back(value);
    }
  }
  void read_extension(DecodedTile& tile, std::uint32_t count) {
    const auto id = take<std::uint8_t>();
    const auto size = take<std::uint32_t>();
    const std::size_t end = at_ + size;
    if (end > bytes_.size()) throw std::runtime_error("an extension is cut");
    if (id == 1) {
      if (size != 2 * count) throw std::runtime_error("not one normal a vertex");
      for (std::uint32_t i = 0; i < count; ++i) {
        const auto x = take<std::uint8_t>();
        tile.normals.push_back({x, take<std::uint8_t>()});
      }
    } else if (id == 4) {
      const auto length = take<std::uint32_t>();
      tile.metadata = bytes_.substr(at_, length);
      at_ += length;
    } else {
      throw std::runtime_error("an extension that we do not write");
    }
    if (at_ != end) throw std::runtime_error("an extension of another length than it says");
  }

  const std::string& bytes_;
  std::size_t at_ = 0;
};

inline DecodedTile decode_tile(const std::string& bytes) {
  return TileReader(bytes).read();
}

}  // namespace tests::support
