// Tiles that were made already: kept by the revision that they show, and served for later ones as long as no edit came near.
#pragma once

#include <cstdint>
#include <functional>
#include <list>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <unordered_map>

#include "server/app/tin.h"
#include "server/tiles/tileset.h"

namespace server::tiles {

enum class TileKind { kTerrain, kTerrainWithNormals, kTerrarium, kMapbox, kHillshade };

struct CachedTile {
  std::string bytes;  // of terrain tiles: gzipped
  std::string etag;   // strong, by the bytes
};

/// Thread-safe. Two who ask for the same missing tile at once both make it.
class TileCache {
 public:
  /// `max_bytes` bounds what is kept; 0 keeps nothing. What is kept counts as memory of `memory`, which must
  /// outlive the cache; nothing more is kept when that is full.
  TileCache(std::size_t max_bytes, app::MemoryBudget& memory)
      : max_bytes_(max_bytes), memory_(memory), lease_(memory, 0) {}

  /// The tile of the TIN's present revision. Errors: kNotFound: there is no such tile; as make_terrain_tile(), picture_tile().
  tin::base::Result<std::shared_ptr<const CachedTile>> get(const app::Tin& tin, TileKind kind, const TileId& id);

  /// The pyramid of the present revision. Errors: as make_tileset().
  tin::base::Result<Tileset> tileset(const app::Tin& tin, const app::Version& version);

  struct Statistics {
    std::uint64_t made = 0, served = 0;  // made anew; taken from what was kept
    std::size_t bytes = 0;
  };
  Statistics statistics() const;

 private:
  struct Entry {
    std::string key;
    std::shared_ptr<const CachedTile> tile;
    std::uint64_t revision = 0;
    std::optional<tin::terrain::Box> area;  // of the lattice; nothing: not known
    HeightLattice heights;
    int levels = 0;
    bool lowest = false;
    std::optional<proto::formats::TileRectangle> extent;  // of the terrain, where the tile says which are below it
  };
  struct KnownTileset {
    std::string key;
    std::uint64_t revision = 0;
    Tileset tiles;
  };

  std::shared_ptr<const CachedTile> find(const app::Tin& tin, std::uint64_t revision, const std::string& key,
                                         const std::optional<Tileset>& tiles);
  void keep(Entry entry);
  void drop(std::list<Entry>::iterator entry);

  const std::size_t max_bytes_;
  const app::MemoryBudget& memory_;
  mutable std::mutex mutex_;
  std::list<Entry> entries_;  // the one used last stands first
  std::unordered_map<std::string, std::list<Entry>::iterator> by_key_;
  std::list<KnownTileset> tilesets_;  // of a few TINs
  Statistics statistics_;
  app::MemoryBudget::Lease lease_;
};

/// Of gzip, RFC 1952, with nothing in its head that changes from run to run.
std::string gzipped(const std::string& bytes);
/// Requires: what gzipped() gave.
std::string gunzipped(const std::string& bytes);

}  // namespace server::tiles
