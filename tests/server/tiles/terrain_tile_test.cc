#include "server/tiles/terrain_tile.h"

#include <gtest/gtest.h>

#include <map>
#include <set>

#include "server/gdal/crs.h"
#include "tests/server/tiles/terrains.h"
#include "tests/support/quantized_mesh.h"
#include "tin/query/elevation.h"

namespace {

using namespace server::tiles;
using tests::support::decode_tile;
using tests::support::DecodedTile;
using tests::tiles::aligned_grid;
using tests::tiles::scattered;
using tin::terrain::Terrain;

struct Made {
  DecodedTile tile;
  double error_m = -1;
};

/// Made, encoded, and decoded by other code.
Made made(const Terrain& terrain, const Tileset& tiles, const TileId& id) {
  const auto tile = make_terrain_tile(terrain, tiles, id);
  EXPECT_TRUE(tile.ok()) << id.z << "/" << id.x << "/" << id.y << ": " << (tile.ok() ? "" : tile.error().message);
  if (!tile) return {};
  return {decode_tile(proto::formats::encode_quantized_mesh(tile->mesh, {true, "{}"})), tile->error_m};
}

/// Along a side: where its vertices are, how high, exactly as a client computes it.
std::set<std::pair<int, double>> side(const DecodedTile& tile, std::size_t which) {
  std::set<std::pair<int, double>> out;
  for (const std::uint32_t i : tile.edges[which]) out.emplace(which % 2 == 0 ? tile.v[i] : tile.u[i], tile.height(i));
  return out;
}

/// The triangles cover the tile once: their areas add up to it, and all turn the same way.
void expect_whole(const DecodedTile& tile) {
  std::int64_t sum = 0;
  for (std::size_t i = 0; i < tile.indices.size(); i += 3) {
    const std::uint32_t a = tile.indices[i], b = tile.indices[i + 1], c = tile.indices[i + 2];
    const std::int64_t area = std::int64_t{tile.u[b] - tile.u[a]} * (tile.v[c] - tile.v[a]) -
                              std::int64_t{tile.u[c] - tile.u[a]} * (tile.v[b] - tile.v[a]);
    EXPECT_GT(area, 0);
    sum += area;
  }
  EXPECT_NEAR(static_cast<double>(sum), 2.0 * 32767 * 32767, 2.0 * 32767 * 32767 * 1e-3);
}

void check_all_tiles(const Terrain& terrain) {
  const auto tiles = make_tileset(terrain);
  ASSERT_TRUE(tiles.ok());
  for (int level = std::max(0, tiles->levels - 3); level < tiles->levels; ++level) {
    const auto [x0, y0, x1, y1] = tiles->available(level);
    std::map<std::pair<std::uint32_t, std::uint32_t>, DecodedTile> decoded;
    for (std::uint32_t y = y0; y <= y1; ++y) {
      for (std::uint32_t x = x0; x <= x1; ++x) {
        const DecodedTile& tile = decoded.emplace(std::pair(x, y), made(terrain, *tiles, {level, x, y}).tile).first->second;
        expect_whole(tile);
        if (x > x0) {
          EXPECT_EQ(side(decoded.at({x - 1, y}), 2), side(tile, 0)) << level << "/" << x << "/" << y;
        }
        if (y > y0) {
          EXPECT_EQ(side(decoded.at({x, y - 1}), 3), side(tile, 1)) << level << "/" << x << "/" << y;
        }
        EXPECT_TRUE(tiles->has({level, x, y}));
        if (level > 0) {
          EXPECT_TRUE(tiles->has({level - 1, x / 2, y / 2})) << "a parent for each child";
        }
      }
    }
  }
}

TEST(TerrainTileTest, NeighboursMeetExactlyOnThreeLevels) {
  SCOPED_TRACE(support::seed());
  check_all_tiles(scattered(6000));
}

TEST(TerrainTileTest, NeighboursMeetWhereVerticesStandOnTheirSides) {
  check_all_tiles(aligned_grid(128));
}

TEST(TerrainTileTest, SidesNeedNoVerticesNearby) {
  check_all_tiles(scattered(12));
}

/// The elevation at random places against the triangle of the decoded tile there.
void check_errors(const Terrain& terrain) {
  const auto tiles = *make_tileset(terrain);
  const int level = tiles.levels - 1;
  auto to_own = *server::gdal::CrsTransform::create("EPSG:4326", terrain.frame().crs);
  tin::query::ElevationQuery query(terrain, tin::query::Voids::kFill);
  support::Random random(support::seed());
  SCOPED_TRACE(support::seed());
  const auto [x0, y0, x1, y1] = tiles.available(level);
  int checked = 0;
  for (std::uint32_t y = y0; y <= y1; ++y) {
    for (std::uint32_t x = x0; x <= x1; ++x) {
      const Made m = made(terrain, tiles, {level, x, y});
      const auto rectangle = geographic_rectangle({level, x, y});
      for (std::size_t i = 0; i < m.tile.indices.size() && checked < 20000; i += 3) {
        const std::array<std::uint32_t, 3> c{m.tile.indices[i], m.tile.indices[i + 1], m.tile.indices[i + 2]};
        double wa = static_cast<double>(random() % 1000), wb = static_cast<double>(random() % 1000),
               wc = 1 + static_cast<double>(random() % 1000);
        const double w = wa + wb + wc;
        wa /= w, wb /= w, wc /= w;
        const auto mean = [&](const std::vector<int>& of) {
          return wa * of[c[0]] + wb * of[c[1]] + wc * of[c[2]];
        };
        double lon = rectangle.west + (rectangle.east - rectangle.west) * mean(m.tile.u) / 32767,
               lat = rectangle.south + (rectangle.north - rectangle.south) * mean(m.tile.v) / 32767;
        const double height = wa * m.tile.height(c[0]) + wb * m.tile.height(c[1]) + wc * m.tile.height(c[2]);
        std::uint8_t ok = 1;
        to_own.transform({&lon, 1}, {&lat, 1}, {&ok, 1});
        const auto at = terrain.frame().to_lattice(lon, lat);
        const auto found = at ? query.at(*at) : std::nullopt;
        if (!found) continue;  // ground beyond the terrain
        EXPECT_NEAR(found->z, height, m.error_m);
        ++checked;
      }
    }
  }
  EXPECT_GT(checked, 100);
}

/// The largest stated error of the lowest level.
double stated_error(const Terrain& terrain) {
  const auto tiles = *make_tileset(terrain);
  const auto [x0, y0, x1, y1] = tiles.available(tiles.levels - 1);
  double largest = 0;
  for (std::uint32_t y = y0; y <= y1; ++y) {
    for (std::uint32_t x = x0; x <= x1; ++x)
      largest = std::max(largest, made(terrain, tiles, {tiles.levels - 1, x, y}).error_m);
  }
  return largest;
}

struct Needle {
  double slope = 0, height_m = 0;  // of the steepest triangle, and its shortest height in the plan
  double longest_m = 0;            // of all edges
};

Needle steepest(const Terrain& terrain) {
  const auto& mesh = terrain.mesh();
  Needle found;
  for (std::uint32_t i = 0; i < mesh.triangle_slots(); ++i) {
    const tin::mesh::TriangleSlot t{i};
    if (!mesh.is_alive(t) || mesh.is_infinite(t)) continue;
    std::array<std::array<double, 3>, 3> c;
    for (int k = 0; k < 3; ++k) {
      const auto at = mesh.point(mesh.vertex(t, k));
      c[static_cast<std::size_t>(k)] = {terrain.frame().x.world(at.x), terrain.frame().y.world(at.y),
                                        terrain.z(mesh.vertex(t, k))};
    }
    const double ux = c[1][0] - c[0][0], uy = c[1][1] - c[0][1], uz = c[1][2] - c[0][2];
    const double vx = c[2][0] - c[0][0], vy = c[2][1] - c[0][1], vz = c[2][2] - c[0][2];
    const double twice = ux * vy - uy * vx;
    const double slope = std::hypot((uz * vy - vz * uy) / twice, (vz * ux - uz * vx) / twice);
    const double longest = std::max({std::hypot(ux, uy), std::hypot(vx, vy), std::hypot(ux - vx, uy - vy)});
    found.longest_m = std::max(found.longest_m, longest);
    if (slope > found.slope) {
      found.slope = slope;
      found.height_m = twice / longest;
    }
  }
  return found;
}

TEST(TerrainTileTest, TheLowestLevelKeepsToItsStatedError) {
  check_errors(scattered(4000));
  check_errors(aligned_grid(64));
}

/// A step of a tile is some decimetres, and edges that are straight in the terrain's CRS stray from straight
/// ones on the globe by the square of their length, decimetres for kilometres. The stated error is both times
/// the steepest slope, not more. Where the terrain has no needles it says little. Among random vertices there
/// are some, mostly on the hull, and over those a tile really is off by that.
TEST(TerrainTileTest, TheStatedErrorIsHowFarPlacesMoveOnTheSteepestSlope) {
  SCOPED_TRACE(support::seed());
  EXPECT_LT(stated_error(aligned_grid(64)), 1.5);
  const Terrain terrain = scattered(4000);
  const Needle needle = steepest(terrain);
  const auto tiles = *make_tileset(terrain);
  constexpr double kRadius_m = 6371008.8, kTangent = 1.1;  // of the latitude
  const double step_m = tile_degrees(tiles.levels - 1) * 111'320 / 32767;
  const double stray_m = needle.longest_m * needle.longest_m * kTangent / (8 * kRadius_m);
  const double stated = stated_error(terrain);
  EXPECT_LE(stated, 2.5 * needle.slope * (step_m + stray_m) + tiles.heights.step_m);
  if (stated > 8) {
    EXPECT_LT(needle.height_m, 10 * (step_m + stray_m)) << "a needle, of slope " << needle.slope;
  }
}

TEST(TerrainTileTest, BytesDependOnTheContentOnly) {
  const Terrain terrain = scattered(2000);
  const auto again = Terrain::restore(terrain.frame(), terrain.vertices_by_id(), terrain.next_id());
  const auto tiles = *make_tileset(terrain), tiles_again = *make_tileset(*again);
  EXPECT_EQ(tiles.levels, tiles_again.levels);
  const auto [x0, y0, x1, y1] = tiles.available(tiles.levels - 1);
  for (std::uint32_t y = y0; y <= y1; ++y) {
    const TileId id{tiles.levels - 1, (x0 + x1) / 2, y};
    EXPECT_EQ(encode_quantized_mesh(make_terrain_tile(terrain, tiles, id)->mesh, {true, ""}),
              encode_quantized_mesh(make_terrain_tile(*again, tiles_again, id)->mesh, {true, ""}));
  }
}

TEST(TilesetTest, CoversTheGlobeAtItsTopAndTheTerrainBelow) {
  const auto tiles = *make_tileset(scattered(40000));
  EXPECT_EQ(tiles.available(0), (std::array<std::uint32_t, 4>{0, 0, 1, 0}));
  EXPECT_GT(tiles.levels, 9);
  for (int level = 1; level < tiles.levels; ++level) {
    const auto [x0, y0, x1, y1] = tiles.available(level);
    EXPECT_LE(-180 + x0 * tile_degrees(level), tiles.extent.west);
    EXPECT_GE(-180 + (x1 + 1) * tile_degrees(level), tiles.extent.east);
    EXPECT_LE(-90 + y0 * tile_degrees(level), tiles.extent.south);
    EXPECT_GE(-90 + (y1 + 1) * tile_degrees(level), tiles.extent.north);
    EXPECT_FALSE(tiles.has({level, x1 + 1, y1}));
    EXPECT_FALSE(tiles.has({level, x0, y0 - 1}));
  }
  EXPECT_FALSE(tiles.has({tiles.levels, 0, 0}));
}

TEST(TilesetTest, NeedsTrianglesAndAPlaceOnTheGlobe) {
  EXPECT_FALSE(make_tileset(Terrain{tin::frame::Frame{}}).ok());
  tin::frame::Frame frame;
  frame.crs = "EPSG:32632";
  EXPECT_FALSE(make_tileset(Terrain{frame}).ok());
  const std::vector<tin::terrain::Placement> three{{{0, 0}, 1}, {{9, 0}, 1}, {{0, 9}, 1}};
  EXPECT_FALSE(make_tileset(*Terrain::build({}, three, tin::terrain::Duplicates::kReplace)).ok()) << "no CRS";
}

TEST(HeightLatticeTest, HoldsItsRangeInFloatsAndSeldomMoves) {
  for (const auto& [low, high] : std::vector<std::pair<double, double>>{
           {0, 0}, {0, 1}, {-3, 2}, {-11000, 9000}, {1e-3, 2e-3}, {-500, -400}, {1e6, 1e6 + 1}, {0, 4095}, {-1e7, 1e7}}) {
    const HeightLattice lattice = height_lattice(low, high);
    EXPECT_LE(lattice.base_m, std::min(low, 0.0));
    EXPECT_GE(lattice.top_m(), std::max(high, 0.0));
    EXPECT_EQ(static_cast<double>(static_cast<float>(lattice.base_m)), lattice.base_m);
    EXPECT_EQ(static_cast<double>(static_cast<float>(lattice.top_m())), lattice.top_m());
    EXPECT_LE(lattice.step_m, std::max(0x1p-10, 4 * (std::max(high, 0.0) - std::min(low, 0.0)) / 32767));
    EXPECT_NEAR(lattice.base_m + lattice.step_m * lattice.quantised(high), high, lattice.step_m / 2);
  }
  EXPECT_EQ(height_lattice(200, 1300), height_lattice(190, 1310));
}

}  // namespace
