#include "server/tiles/tile_cache.h"

#include <gtest/gtest.h>

#include "server/store/sqlite_store.h"
#include "server/app/catalogue.h"
#include "server/gdal/crs.h"
#include "tests/server/tiles/terrains.h"
#include "tests/support/quantized_mesh.h"
#include "tests/support/temp_dir.h"

namespace {

using namespace server::tiles;
using tests::support::decode_tile;

class TileCacheTest : public testing::Test {
 protected:
  TileCacheTest() {
    auto store = server::store::open_sqlite_store(folder_.path());
    catalogue_ = std::move(*server::app::Catalogue::open(std::move(*store), {}));
    tin_ = *catalogue_->create({"hills", "Hills", tests::tiles::scattered(20000), tin::terrain::Duplicates::kReplace, std::nullopt, {}});
  }
  std::shared_ptr<const CachedTile> get(TileKind kind, const TileId& id) {
    auto tile = cache_.get(*tin_, kind, id);
    EXPECT_TRUE(tile.ok()) << (tile.ok() ? "" : tile.error().message);
    return tile.ok() ? *tile : nullptr;
  }
  /// Tiles of the lowest level in its corners and its middle.
  std::vector<TileId> some_tiles() {
    const auto tiles = *cache_.tileset(*tin_, tin_->version());
    const int z = tiles.levels - 1;
    const auto [x0, y0, x1, y1] = tiles.available(z);
    return {{z, x0, y0}, {z, x1, y1}, {z, (x0 + x1) / 2, (y0 + y1) / 2}, {z - 2, x0 / 4, y0 / 4}};
  }
  void insert(double x, double y, double z) {
    const server::app::WorldEdit edit = server::app::InsertAt{x, y, z};
    ASSERT_TRUE(tin_->edit({&edit, 1}, server::app::Terms{}).ok());
  }

  tests::support::TempDir folder_;
  std::unique_ptr<server::app::Catalogue> catalogue_;
  std::shared_ptr<server::app::Tin> tin_;
  std::uint64_t terrains_bytes_ = 0;  // as the budget sees it
  server::app::MemoryBudget memory_{100 << 20, [this] { return terrains_bytes_; }};
  TileCache cache_{64 << 20, memory_};
};

TEST_F(TileCacheTest, ATileIsMadeOnceAndAgainWhereAnEditCameNear) {
  const auto ids = some_tiles();
  std::vector<std::shared_ptr<const CachedTile>> before;
  for (const TileId& id : ids) before.push_back(get(TileKind::kTerrain, id));
  for (std::size_t i = 0; i < ids.size(); ++i) EXPECT_EQ(get(TileKind::kTerrain, ids[i]), before[i]);
  EXPECT_EQ(cache_.statistics().made, ids.size());
  // An edit in the tile of the middle, away from the corners.
  const auto rectangle = geographic_rectangle(ids[2]);
  double x = (rectangle.west + rectangle.east) / 2, y = (rectangle.south + rectangle.north) / 2;
  std::uint8_t ok = 1;
  auto to_own = *server::gdal::CrsTransform::create("EPSG:4326", "EPSG:32632");
  ASSERT_TRUE(to_own.transform({&x, 1}, {&y, 1}, {&ok, 1}));
  insert(x, y, 1100);
  EXPECT_EQ(get(TileKind::kTerrain, ids[0]), before[0]);
  EXPECT_EQ(get(TileKind::kTerrain, ids[1]), before[1]);
  EXPECT_EQ(cache_.statistics().made, ids.size());
  const auto middle = get(TileKind::kTerrain, ids[2]);
  EXPECT_NE(middle->etag, before[2]->etag);
  EXPECT_EQ(cache_.statistics().made, ids.size() + 1);
}

/// Whatever is served from the cache after edits is what a cache without memory makes.
TEST_F(TileCacheTest, WhatIsKeptIsWhatWouldBeMade) {
  support::Random random(support::seed());
  SCOPED_TRACE(support::seed());
  TileCache forgetful(0, memory_);
  for (int round = 0; round < 12; ++round) {
    insert(460000 + static_cast<double>(random() % 22000) - 11000, 5240000 + static_cast<double>(random() % 17000) - 8500,
           static_cast<double>(random() % 1000));
    for (const TileId& id : some_tiles()) {
      EXPECT_EQ(get(TileKind::kTerrain, id)->bytes, (*forgetful.get(*tin_, TileKind::kTerrain, id))->bytes) << round;
    }
  }
  EXPECT_GT(cache_.statistics().served, 0U);
  EXPECT_EQ(forgetful.statistics().served, 0U);
  EXPECT_EQ(forgetful.statistics().bytes, 0U);
}

/// Cesium reads nothing else than these lists where tiles bear metadata.
TEST_F(TileCacheTest, EveryTenthLevelListsTheTilesBelow) {
  const auto tiles = *cache_.tileset(*tin_, tin_->version());
  ASSERT_GT(tiles.levels, 11);
  const auto ranges = [&](const TileId& id) {
    std::string list;
    for (int z = id.z + 1; z <= id.z + 10 && z < tiles.levels; ++z) {
      std::array<std::uint32_t, 4> r{UINT32_MAX, UINT32_MAX, 0, 0};
      const auto [x0, y0, x1, y1] = tiles.available(z);
      for (std::uint32_t y = y0; y <= y1; ++y) {
        for (std::uint32_t x = x0; x <= x1; ++x) {
          if (x >> (z - id.z) != id.x || y >> (z - id.z) != id.y) continue;
          r = {std::min(r[0], x), std::min(r[1], y), std::max(r[2], x), std::max(r[3], y)};
        }
      }
      list += list.empty() ? "" : ",";
      const auto text = [](std::uint32_t n) { return std::to_string(n); };
      list += r[0] > r[2] ? "[]"
                          : "[{\"startX\":" + text(r[0]) + ",\"startY\":" + text(r[1]) +
                                ",\"endX\":" + text(r[2]) + ",\"endY\":" + text(r[3]) + "}]";
    }
    return "\"available\":[" + list + "]";
  };
  std::vector<TileId> listing{{0, 0, 0}, {0, 1, 0}};
  const auto [x0, y0, x1, y1] = tiles.available(10);
  for (std::uint32_t y = y0; y <= y1; ++y) {
    for (std::uint32_t x = x0; x <= x1; ++x) listing.push_back({10, x, y});
  }
  for (const TileId& id : listing) {
    const auto tile = decode_tile(gunzipped(get(TileKind::kTerrain, id)->bytes));
    EXPECT_NE(tile.metadata.find(ranges(id)), std::string::npos)
        << id.z << "/" << id.x << "/" << id.y << ": " << tile.metadata << " lacks " << ranges(id);
  }
  const auto below = tiles.available(11);
  EXPECT_EQ(decode_tile(gunzipped(get(TileKind::kTerrain, {11, below[0], below[1]})->bytes))
                .metadata.find("available"),
            std::string::npos);
  // A vertex far out widens the terrain's extent, and so what lies below tiles that no triangle of it
  // touches.
  TileCache forgetful(0, memory_);
  insert(500000, 5240000, 600);
  for (const TileId& id : listing)
    EXPECT_EQ(get(TileKind::kTerrain, id)->bytes, (*forgetful.get(*tin_, TileKind::kTerrain, id))->bytes);
}

TEST_F(TileCacheTest, MemoryIsBounded) {
  TileCache small(200'000, memory_);
  for (std::uint32_t x = 0; x < 8; ++x) {
    ASSERT_TRUE(small.get(*tin_, TileKind::kTerrarium, {13, 4285 + x, 2870}).ok());
    EXPECT_LE(small.statistics().bytes, 200'000U);
  }
  EXPECT_EQ(small.statistics().made, 8U);
}

TEST_F(TileCacheTest, WhatIsKeptCountsAsMemoryAndIsNotKeptWhereThatIsFull) {
  const auto ids = some_tiles();
  {
    TileCache cache(64 << 20, memory_);
    ASSERT_TRUE(cache.get(*tin_, TileKind::kTerrain, ids[0]).ok());
    EXPECT_GT(cache.statistics().bytes, 0U);
    EXPECT_EQ(memory_.used(), cache.statistics().bytes);
  }
  EXPECT_EQ(memory_.used(), 0U) << "given back";
  terrains_bytes_ = memory_.limit();
  server::app::MemoryBudget full(memory_.limit(), [this] { return terrains_bytes_; });
  TileCache cache(64 << 20, full);
  ASSERT_TRUE(cache.get(*tin_, TileKind::kTerrain, ids[0]).ok());
  EXPECT_EQ(cache.statistics().bytes, 0U);
}

TEST_F(TileCacheTest, WhatThereIsNotIsNotFound) {
  for (const TileId& id : {TileId{24, 0, 0}, TileId{1, 0, 0}, TileId{0, 2, 0}, TileId{-1, 0, 0}}) {
    EXPECT_EQ(cache_.get(*tin_, TileKind::kTerrain, id).error().code, tin::base::Code::kNotFound);
  }
  EXPECT_FALSE(cache_.get(*tin_, TileKind::kMapbox, {3, 8, 0}).ok());
  EXPECT_TRUE(cache_.get(*tin_, TileKind::kTerrain, {0, 0, 0}).ok());
  EXPECT_TRUE(cache_.get(*tin_, TileKind::kTerrain, {0, 1, 0}).ok());
}

TEST_F(TileCacheTest, TerrainIsGzipped) {
  const auto plain = get(TileKind::kTerrain, some_tiles()[2]), rich = get(TileKind::kTerrainWithNormals, some_tiles()[2]);
  EXPECT_TRUE(decode_tile(gunzipped(plain->bytes)).normals.empty());
  EXPECT_FALSE(decode_tile(gunzipped(rich->bytes)).normals.empty());
  EXPECT_NE(plain->etag, rich->etag);
  EXPECT_NE(decode_tile(gunzipped(plain->bytes)).metadata.find("geometricerror"), std::string::npos);
  EXPECT_EQ(gunzipped(gzipped("")), "");
}

}  // namespace
