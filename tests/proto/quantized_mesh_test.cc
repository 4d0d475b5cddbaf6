#include "proto/formats/quantized_mesh.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/quantized_mesh.h"

namespace {

using proto::formats::QuantizedMesh;
using proto::formats::QuantizedVertex;
using tests::support::decode_tile;
using tests::support::DecodedTile;

/// A grid of n x n nodes over a tile of 1 degree, in an order that its triangles do not follow.
QuantizedMesh grid(std::uint32_t n) {
  QuantizedMesh mesh{{7, 45, 8, 46}, -16, 4080, {}, {}};
  for (std::uint32_t i = n * n; i-- > 0;) {
    QuantizedVertex vertex;
    vertex.u = static_cast<std::uint16_t>(i % n * 32767 / (n - 1));
    vertex.v = static_cast<std::uint16_t>(i / n * 32767 / (n - 1));
    vertex.h = static_cast<std::uint16_t>(i * 7919 % 32768);
    mesh.vertices.push_back(vertex);
  }
  const auto at = [n](std::uint32_t i, std::uint32_t j) { return n * n - 1 - (j * n + i); };
  for (std::uint32_t j = 0; j + 1 < n; ++j) {
    for (std::uint32_t i = 0; i + 1 < n; ++i) {
      mesh.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      mesh.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  }
  return mesh;
}

using Place = std::array<int, 3>;

std::vector<std::array<Place, 3>> triangles(const DecodedTile& tile) {
  std::vector<std::array<Place, 3>> out;
  for (std::size_t i = 0; i < tile.indices.size(); i += 3) {
    std::array<Place, 3> triangle;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t v = tile.indices[i + k];
      triangle[k] = {tile.u[v], tile.v[v], tile.h[v]};
    }
    out.push_back(triangle);
  }
  return out;
}

void expect_same(const QuantizedMesh& mesh, const DecodedTile& tile) {
  ASSERT_EQ(tile.indices.size(), 3 * mesh.triangles.size());
  const auto decoded = triangles(tile);
  for (std::size_t i = 0; i < decoded.size(); ++i) {
    for (std::size_t k = 0; k < 3; ++k) {
      const QuantizedVertex& v = mesh.vertices[mesh.triangles[i][k]];
      ASSERT_EQ(decoded[i][k], (Place{v.u, v.v, v.h}));
    }
  }
}

TEST(QuantizedMeshTest, ADecoderSeesTheSameTriangles) {
  for (const std::uint32_t n : {2U, 3U, 33U, 256U, 257U}) {  // 256 x 256 vertices are the most that 16 bits count
    const QuantizedMesh mesh = grid(n);
    const DecodedTile tile = decode_tile(encode_quantized_mesh(mesh, {}));
    EXPECT_EQ(tile.u.size(), n * n);
    expect_same(mesh, tile);
    EXPECT_EQ(tile.min_height, -16);
    EXPECT_EQ(tile.max_height, 4080);
    for (const auto& edge : tile.edges) EXPECT_EQ(edge.size(), n);
  }
}

TEST(QuantizedMeshTest, EdgesListTheVerticesOfEachSideInOrder) {
  const DecodedTile tile = decode_tile(encode_quantized_mesh(grid(5), {}));
  const auto& [west, south, east, north] = tile.edges;
  for (std::size_t i = 0; i < 5; ++i) {
    EXPECT_EQ(tile.u[west[i]], 0);
    EXPECT_EQ(tile.v[south[i]], 0);
    EXPECT_EQ(tile.u[east[i]], 32767);
    EXPECT_EQ(tile.v[north[i]], 32767);
    if (i == 0) continue;
    EXPECT_LT(tile.v[west[i - 1]], tile.v[west[i]]);
    EXPECT_LT(tile.u[north[i - 1]], tile.u[north[i]]);
  }
}

TEST(QuantizedMeshTest, ExtensionsComeWhenTheyAreWanted) {
  const QuantizedMesh mesh = grid(3);
  const DecodedTile plain = decode_tile(encode_quantized_mesh(mesh, {}));
  EXPECT_TRUE(plain.normals.empty());
  EXPECT_TRUE(plain.metadata.empty());
  const DecodedTile rich = decode_tile(encode_quantized_mesh(mesh, {true, R"({"geometricerror":0.5})"}));
  EXPECT_EQ(rich.metadata, R"({"geometricerror":0.5})");
  ASSERT_EQ(rich.normals.size(), 9U);
  for (std::size_t i = 0; i < 9; ++i) {
    // The vertical, decoded from its octahedron, is the direction of the ellipsoid's normal.
    double x = rich.normals[i][0] / 255.0 * 2 - 1, y = rich.normals[i][1] / 255.0 * 2 - 1;
    double z = 1 - std::abs(x) - std::abs(y);
    if (z < 0) {
      const double old_x = x;
      x = (1 - std::abs(y)) * (old_x < 0 ? -1 : 1);
      y = (1 - std::abs(old_x)) * (y < 0 ? -1 : 1);
    }
    const double size = std::sqrt(x * x + y * y + z * z), lon = (7 + rich.u[i] / 32767.0) * M_PI / 180,
                 lat = (45 + rich.v[i] / 32767.0) * M_PI / 180;
    EXPECT_NEAR(x / size, std::cos(lat) * std::cos(lon), 0.01);
    EXPECT_NEAR(y / size, std::cos(lat) * std::sin(lon), 0.01);
    EXPECT_NEAR(z / size, std::sin(lat), 0.01);
  }
}

TEST(QuantizedMeshTest, TheHeaderBoundsTheTile) {
  const QuantizedMesh mesh = grid(9);
  const DecodedTile tile = decode_tile(encode_quantized_mesh(mesh, {}));
  for (std::size_t i = 0; i < tile.u.size(); ++i) {
    const auto at = proto::formats::earth_centred(7 + tile.u[i] / 32767.0, 45 + tile.v[i] / 32767.0, tile.height(i));
    double squared = 0;
    for (std::size_t k = 0; k < 3; ++k) squared += std::pow(at[k] - tile.sphere_centre[k], 2);
    EXPECT_LE(std::sqrt(squared), tile.radius * (1 + 1e-12));
  }
  // The horizon point lies outside the ellipsoid, above the tile.
  double out = 0, along = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    out += tile.horizon[k] * tile.horizon[k];
    along += tile.horizon[k] * tile.centre[k];
  }
  EXPECT_GT(out, 1);
  EXPECT_LT(out, 1.1);
  EXPECT_GT(along, 0);
}

TEST(EarthCentredTest, MeetsKnownPlaces) {
  const auto expect = [](double lon, double lat, double h, std::array<double, 3> at) {
    const auto found = proto::formats::earth_centred(lon, lat, h);
    for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(found[i], at[i], 1e-3);
  };
  expect(0, 0, 0, {6378137, 0, 0});
  expect(90, 0, 10, {0, 6378147, 0});
  expect(12, 90, 0, {0, 0, 6356752.3142});
  // EPSG guidance note 7-2, geographic to geocentric: 53°48'33.820"N, 2°07'46.380"E, 73 m.
  expect(2 + 7 / 60.0 + 46.380 / 3600, 53 + 48 / 60.0 + 33.820 / 3600, 73.0, {3771793.968, 140253.342, 5124304.349});
}

}  // namespace
