#include "proto/formats/quantized_mesh.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <numbers>

namespace proto::formats {
namespace {

using Vec = std::array<double, 3>;

constexpr double kSemiMajor_m = 6378137.0;
constexpr double kSemiMinor_m = 6356752.3142451793;
constexpr double kDegree = std::numbers::pi / 180;
constexpr std::uint32_t kUnused = 0xffffffffU;
constexpr std::uint8_t kNormalsExtension = 1, kMetadataExtension = 4;
/// From so many vertices on indices have 32 bits.
constexpr std::size_t kWideIndices = 65537;

double dot(const Vec& a, const Vec& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

double length(const Vec& a) {
  return std::sqrt(dot(a, a));
}

/// Little-endian bytes, whatever the machine's order.
class Bytes {
 public:
  template <class T>
  void put(T value) {
    static_assert(std::endian::native == std::endian::little);
    char raw[sizeof value];
    std::memcpy(raw, &value, sizeof value);
    out_.append(raw, sizeof value);
  }
  void align(std::size_t to) { out_.append((to - out_.size() % to) % to, '\0'); }
  std::string& text() { return out_; }

 private:
  std::string out_;
};

std::uint16_t zigzag(int value) {
  return static_cast<std::uint16_t>(static_cast<unsigned>(value) << 1 ^ static_cast<unsigned>(value >> 31));
}

template <class Get>
void put_deltas(Bytes& bytes, const std::vector<QuantizedVertex>& vertices, Get get) {
  int before = 0;
  for (const QuantizedVertex& vertex : vertices) {
    const int now = get(vertex);
    bytes.put(zigzag(now - before));
    before = now;
  }
}

/// Vertices in the order of their first use, and triangles that name them by it.
void put_in_order_of_use(const QuantizedMesh& mesh, std::vector<QuantizedVertex>& vertices,
                         std::vector<std::uint32_t>& indices) {
  std::vector<std::uint32_t> place(mesh.vertices.size(), kUnused);
  vertices.reserve(mesh.vertices.size());
  for (const auto& triangle : mesh.triangles) {
    for (const std::uint32_t corner : triangle) {
      if (place[corner] == kUnused) {
        place[corner] = static_cast<std::uint32_t>(vertices.size());
        vertices.push_back(mesh.vertices[corner]);
      }
      indices.push_back(place[corner]);
    }
  }
}

template <class Index>
void put_indices(Bytes& bytes, const std::vector<std::uint32_t>& indices) {
  bytes.put(static_cast<std::uint32_t>(indices.size() / 3));
  std::uint32_t highest = 0;
  for (const std::uint32_t index : indices) {
    bytes.put(static_cast<Index>(highest - index));
    if (index == highest) ++highest;
  }
}

template <class Index>
void put_edge(Bytes& bytes, const std::vector<QuantizedVertex>& vertices, std::uint16_t QuantizedVertex::* across,
              std::uint16_t at, std::uint16_t QuantizedVertex::* along) {
  std::vector<std::uint32_t> edge;
  for (std::uint32_t i = 0; i < vertices.size(); ++i) {
    if (vertices[i].*across == at) edge.push_back(i);
  }
  std::sort(edge.begin(), edge.end(),
            [&](std::uint32_t a, std::uint32_t b) { return vertices[a].*along < vertices[b].*along; });
  bytes.put(static_cast<std::uint32_t>(edge.size()));
  for (const std::uint32_t i : edge) bytes.put(static_cast<Index>(i));
}

template <class Index>
void put_edges(Bytes& bytes, const std::vector<QuantizedVertex>& vertices) {
  using V = QuantizedVertex;
  put_edge<Index>(bytes, vertices, &V::u, 0, &V::v);
  put_edge<Index>(bytes, vertices, &V::v, 0, &V::u);
  put_edge<Index>(bytes, vertices, &V::u, kQuantizedMax, &V::v);
  put_edge<Index>(bytes, vertices, &V::v, kQuantizedMax, &V::u);
}

double lon_of(const QuantizedMesh& mesh, const QuantizedVertex& vertex) {
  return mesh.rectangle.west + (mesh.rectangle.east - mesh.rectangle.west) * vertex.u / kQuantizedMax;
}

double lat_of(const QuantizedMesh& mesh, const QuantizedVertex& vertex) {
  return mesh.rectangle.south + (mesh.rectangle.north - mesh.rectangle.south) * vertex.v / kQuantizedMax;
}

Vec place_of(const QuantizedMesh& mesh, const QuantizedVertex& vertex) {
  const double height =
      mesh.min_height + (static_cast<double>(mesh.max_height) - mesh.min_height) * vertex.h / kQuantizedMax;
  return earth_centred(lon_of(mesh, vertex), lat_of(mesh, vertex), height);
}

/// A point from which the tile is seen as soon as any of it is: on the axis of `direction`, in units of the ellipsoid's axes.
Vec horizon_point(const std::vector<Vec>& places, const Vec& centre) {
  const auto scaled = [](const Vec& p) {
    return Vec{p[0] / kSemiMajor_m, p[1] / kSemiMajor_m, p[2] / kSemiMinor_m};
  };
  Vec direction = scaled(centre);
  const double size = length(direction);
  constexpr double kFar = 1e6;  // where there is no such point: seen from wherever the axis is
  if (size < 1e-9) return {0, 0, kFar};
  for (double& part : direction) part /= size;
  double farthest = 0;
  for (const Vec& place : places) {
    const Vec p = scaled(place);
    const double squared = std::max(1.0, dot(p, p)), magnitude = std::sqrt(squared);
    const double cos_alpha = std::clamp(dot(p, direction) / length(p), -1.0, 1.0);
    const double sin_alpha = std::sqrt(1 - cos_alpha * cos_alpha);
    const double cos_beta = 1 / magnitude, sin_beta = std::sqrt(squared - 1) / magnitude;
    const double below = cos_alpha * cos_beta - sin_alpha * sin_beta;
    if (below <= 1e-6) return {direction[0] * kFar, direction[1] * kFar, direction[2] * kFar};
    farthest = std::max(farthest, 1 / below);
  }
  return {direction[0] * farthest, direction[1] * farthest, direction[2] * farthest};
}

void put_header(Bytes& bytes, const QuantizedMesh& mesh, const std::vector<Vec>& places) {
  Vec low = places[0], high = places[0];
  for (const Vec& place : places) {
    for (std::size_t i = 0; i < 3; ++i) {
      low[i] = std::min(low[i], place[i]);
      high[i] = std::max(high[i], place[i]);
    }
  }
  const Vec centre{(low[0] + high[0]) / 2, (low[1] + high[1]) / 2, (low[2] + high[2]) / 2};
  double radius = 0;
  for (const Vec& place : places) {
    radius = std::max(radius, length({place[0] - centre[0], place[1] - centre[1], place[2] - centre[2]}));
  }
  for (const double part : centre) bytes.put(part);
  bytes.put(mesh.min_height);
  bytes.put(mesh.max_height);
  for (const double part : centre) bytes.put(part);
  bytes.put(radius);
  for (const double part : horizon_point(places, centre)) bytes.put(part);
}

/// A direction in the local frame at a place, as two bytes of an octahedron.
std::array<std::uint8_t, 2> oct_encoded(const std::array<float, 3>& normal, double lon_deg, double lat_deg) {
  const double lon = lon_deg * kDegree, lat = lat_deg * kDegree;
  const double east = normal[0], north = normal[1], up = normal[2];
  const Vec v{-std::sin(lon) * east - std::sin(lat) * std::cos(lon) * north + std::cos(lat) * std::cos(lon) * up,
              std::cos(lon) * east - std::sin(lat) * std::sin(lon) * north + std::cos(lat) * std::sin(lon) * up,
              std::cos(lat) * north + std::sin(lat) * up};
  const double sum = std::abs(v[0]) + std::abs(v[1]) + std::abs(v[2]);
  double x = v[0] / sum, y = v[1] / sum;
  if (v[2] < 0) {
    const double folded_x = (1 - std::abs(y)) * (x < 0 ? -1 : 1), folded_y = (1 - std::abs(x)) * (y < 0 ? -1 : 1);
    x = folded_x;
    y = folded_y;
  }
  const auto byte = [](double value) { return static_cast<std::uint8_t>(std::lround((value * 0.5 + 0.5) * 255)); };
  return {byte(x), byte(y)};
}

}  // namespace

std::array<double, 3> earth_centred(double lon_deg, double lat_deg, double height_m) {
  constexpr double kSquaredRatio = kSemiMinor_m * kSemiMinor_m / (kSemiMajor_m * kSemiMajor_m);
  const double lon = lon_deg * kDegree, lat = lat_deg * kDegree, sin_lat = std::sin(lat);
  const double normal = kSemiMajor_m / std::sqrt(1 - (1 - kSquaredRatio) * sin_lat * sin_lat);
  return {(normal + height_m) * std::cos(lat) * std::cos(lon), (normal + height_m) * std::cos(lat) * std::sin(lon),
          (kSquaredRatio * normal + height_m) * sin_lat};
}

std::string encode_quantized_mesh(const QuantizedMesh& mesh, const QuantizedMeshOptions& options) {
  std::vector<QuantizedVertex> vertices;
  std::vector<std::uint32_t> indices;
  put_in_order_of_use(mesh, vertices, indices);
  std::vector<Vec> places;
  places.reserve(vertices.size());
  for (const QuantizedVertex& vertex : vertices) places.push_back(place_of(mesh, vertex));
  Bytes bytes;
  put_header(bytes, mesh, places);
  bytes.put(static_cast<std::uint32_t>(vertices.size()));
  put_deltas(bytes, vertices, [](const QuantizedVertex& vertex) { return vertex.u; });
  put_deltas(bytes, vertices, [](const QuantizedVertex& vertex) { return vertex.v; });
  put_deltas(bytes, vertices, [](const QuantizedVertex& vertex) { return vertex.h; });
  if (vertices.size() >= kWideIndices) {
    bytes.align(4);
    put_indices<std::uint32_t>(bytes, indices);
    put_edges<std::uint32_t>(bytes, vertices);
  } else {
    bytes.align(2);
    put_indices<std::uint16_t>(bytes, indices);
    put_edges<std::uint16_t>(bytes, vertices);
  }
  if (options.normals) {
    bytes.put(kNormalsExtension);
    bytes.put(static_cast<std::uint32_t>(2 * vertices.size()));
    for (const QuantizedVertex& vertex : vertices) {
      for (const std::uint8_t byte : oct_encoded(vertex.normal, lon_of(mesh, vertex), lat_of(mesh, vertex))) bytes.put(byte);
    }
  }
  if (!options.metadata.empty()) {
    bytes.put(kMetadataExtension);
    bytes.put(static_cast<std::uint32_t>(options.metadata.size() + 4));
    bytes.put(static_cast<std::uint32_t>(options.metadata.size()));
    bytes.text() += options.metadata;
  }
  return std::move(bytes.text());
}

}  // namespace proto::formats
