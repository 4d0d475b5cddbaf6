#include "server/tiles/tile_cache.h"

#include <zlib.h>

#include <algorithm>
#include <cmath>
#include <new>

#include "proto/json_write.h"
#include "proto/tile_documents.h"
#include "server/gdal/crs.h"
#include "server/tiles/picture.h"
#include "server/tiles/terrain_tile.h"
#include "tin/base/check.h"

namespace server::tiles {

using tin::base::Code;
using tin::base::error;
using tin::base::Result;
using tin::terrain::Terrain;

namespace {

constexpr std::size_t kTilesets = 16;
constexpr int kGzip = 15 + 16;  // zlib's name for the format
constexpr int kQuickly = 3;

bool is_terrain(TileKind kind) {
  return kind == TileKind::kTerrain || kind == TileKind::kTerrainWithNormals;
}

std::string tin_key(const app::Tin& tin) {
  return tin.id() + "/" + std::to_string(tin.created_ms());
}

std::string tile_key(const app::Tin& tin, TileKind kind, const TileId& id) {
  return tin_key(tin) + "/" + std::to_string(static_cast<int>(kind)) + "/" + std::to_string(id.z) + "/" +
         std::to_string(id.x) + "/" + std::to_string(id.y);
}

/// A strong entity tag of the bytes themselves.
std::string tag_of(std::string_view bytes) {
  std::uint64_t hash = 0xcbf29ce484222325ULL;  // FNV-1a
  for (const char c : bytes) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3ULL;
  std::string tag = "\"t";
  for (int i = 60; i >= 0; i -= 4) tag += "0123456789abcdef"[hash >> i & 15];
  return tag + "\"";
}

/// What a tile shows, and a tenth of its size around it, on the terrain's lattice; nothing where that cannot be said.
std::optional<tin::terrain::Box> lattice_area(const Terrain& terrain, bool geographic, const TileId& id) {
  constexpr int kParts = 16;
  constexpr double kAround = 0.1;
  double x0 = 0, y0 = 0, x1 = 0, y1 = 0;
  if (geographic) {
    const auto r = geographic_rectangle(id);
    x0 = r.west, y0 = r.south, x1 = r.east, y1 = r.north;
  } else {
    const auto s = mercator_square(id);
    x0 = s.west, y0 = s.south, x1 = s.east, y1 = s.north;
  }
  if (geographic ? tile_degrees(id.z) > 10 : id.z < 6) return std::nullopt;  // too bent for a few points to bound
  std::vector<double> x, y;
  for (int j = -1; j <= kParts + 1; ++j) {
    for (int i = -1; i <= kParts + 1; ++i) {
      x.push_back(x0 + (x1 - x0) * (i + (i < 0 ? 1 - kAround * kParts : i > kParts ? kAround * kParts - 1 : 0)) / kParts);
      y.push_back(y0 + (y1 - y0) * (j + (j < 0 ? 1 - kAround * kParts : j > kParts ? kAround * kParts - 1 : 0)) / kParts);
    }
  }
  const std::string from = geographic ? "EPSG:4326" : "EPSG:3857";
  std::vector<std::uint8_t> ok(x.size(), 1);
  if (from != terrain.frame().crs) {
    auto way = gdal::CrsTransform::create(from, terrain.frame().crs);
    if (!way || !way->transform(x, y, ok)) return std::nullopt;
  }
  const auto [min_x, max_x] = std::minmax_element(x.begin(), x.end());
  const auto [min_y, max_y] = std::minmax_element(y.begin(), y.end());
  const auto& frame = terrain.frame();
  const auto lattice = [](double value) { return static_cast<std::int32_t>(std::clamp(value, -1073741824.0, 1073741823.0)); };
  return tin::terrain::Box{{lattice(std::floor(frame.x.lattice(*min_x))), lattice(std::floor(frame.y.lattice(*min_y)))},
                           {lattice(std::ceil(frame.x.lattice(*max_x))), lattice(std::ceil(frame.y.lattice(*max_y)))}};
}

/// Ranges of tiles below this one, a list for each of the levels down to the next that has such lists.
void write_available(proto::JsonWriter& json, const Tileset& tiles, const TileId& id) {
  json.key("available").begin_array();
  for (int z = id.z + 1; z <= id.z + proto::kMetadataLevels && z < tiles.levels; ++z) {
    const int down = z - id.z;
    const auto [x0, y0, x1, y1] = tiles.available(z);
    const std::uint32_t first_x = id.x << down, first_y = id.y << down,
                        width = (std::uint32_t{1} << down) - 1;
    const std::uint32_t west = std::max(x0, first_x), east = std::min(x1, first_x + width);
    const std::uint32_t south = std::max(y0, first_y), north = std::min(y1, first_y + width);
    json.begin_array();
    if (west <= east && south <= north) {
      json.begin_object().key("startX").integer(west).key("startY").integer(south);
      json.key("endX").integer(east).key("endY").integer(north).end_object();
    }
    json.end_array();
  }
  json.end_array();
}

bool lists_available(const TileId& id) {
  return id.z % proto::kMetadataLevels == 0;
}

/// Extension 4: how far the tile may lie from the terrain, and in every tenth level which tiles lie below it.
std::string metadata_of(const TerrainTile& tile, const Tileset& tiles, const TileId& id) {
  proto::JsonWriter json;
  json.begin_object();
  if (tile.error_m >= 0) json.key("geometricerror").number(tile.error_m);
  if (lists_available(id)) write_available(json, tiles, id);
  json.end_object();
  return json.take();
}

Result<std::string> make(const Terrain& terrain, TileKind kind, const TileId& id, const std::optional<Tileset>& tiles) {
  if (is_terrain(kind)) {
    const auto tile = make_terrain_tile(terrain, *tiles, id);
    if (!tile) return tile.error();
    return gzipped(proto::formats::encode_quantized_mesh(
        tile->mesh, {kind == TileKind::kTerrainWithNormals, metadata_of(*tile, *tiles, id)}));
  }
  if (kind == TileKind::kTerrarium) return picture_tile(terrain, PictureKind::kTerrarium, id);
  return picture_tile(terrain, kind == TileKind::kMapbox ? PictureKind::kMapbox : PictureKind::kHillshade, id);
}

}  // namespace

std::string gzipped(const std::string& bytes) {
  z_stream stream{};
  if (deflateInit2(&stream, kQuickly, Z_DEFLATED, kGzip, 8, Z_DEFAULT_STRATEGY) != Z_OK) throw std::bad_alloc();
  std::string out(deflateBound(&stream, bytes.size()), '\0');
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));  // zlib only reads it
  stream.avail_in = static_cast<uInt>(bytes.size());
  stream.next_out = reinterpret_cast<Bytef*>(out.data());
  stream.avail_out = static_cast<uInt>(out.size());
  const int ended = deflate(&stream, Z_FINISH);
  out.resize(stream.total_out);
  deflateEnd(&stream);
  TIN_CHECK(ended == Z_STREAM_END);
  return out;
}

std::string gunzipped(const std::string& bytes) {
  z_stream stream{};
  if (inflateInit2(&stream, kGzip) != Z_OK) throw std::bad_alloc();
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));  // zlib only reads it
  stream.avail_in = static_cast<uInt>(bytes.size());
  std::string out;
  char piece[16384];
  int state = Z_OK;
  while (state == Z_OK) {
    stream.next_out = reinterpret_cast<Bytef*>(piece);
    stream.avail_out = sizeof piece;
    state = inflate(&stream, Z_NO_FLUSH);
    out.append(piece, sizeof piece - stream.avail_out);
  }
  inflateEnd(&stream);
  TIN_CHECK(state == Z_STREAM_END);
  return out;
}

Result<Tileset> TileCache::tileset(const app::Tin& tin, const app::Version& version) {
  const std::string key = tin_key(tin);
  {
    const std::lock_guard lock(mutex_);
    for (auto at = tilesets_.begin(); at != tilesets_.end(); ++at) {
      if (at->key != key || at->revision != version.revision) continue;
      tilesets_.splice(tilesets_.begin(), tilesets_, at);
      return tilesets_.front().tiles;
    }
  }
  const auto tiles = make_tileset(*version.terrain);
  if (!tiles) return tiles.error();
  const std::lock_guard lock(mutex_);
  tilesets_.remove_if([&](const KnownTileset& known) { return known.key == key; });
  tilesets_.push_front({key, version.revision, *tiles});
  if (tilesets_.size() > kTilesets) tilesets_.pop_back();
  return *tiles;
}

std::shared_ptr<const CachedTile> TileCache::find(const app::Tin& tin, std::uint64_t revision, const std::string& key,
                                                  const std::optional<Tileset>& tiles) {
  const std::lock_guard lock(mutex_);
  const auto found = by_key_.find(key);
  if (found == by_key_.end()) return nullptr;
  Entry& entry = *found->second;
  if (entry.revision != revision) {
    if (!entry.area || tin.changed_areas().may_differ(entry.revision, revision, *entry.area, entry.lowest)) return nullptr;
    if (tiles && (tiles->heights != entry.heights || tiles->levels != entry.levels)) return nullptr;
    if (tiles && entry.extent && tiles->extent != *entry.extent) return nullptr;
    entry.revision = std::max(entry.revision, revision);
  }
  ++statistics_.served;
  entries_.splice(entries_.begin(), entries_, found->second);
  return entry.tile;
}

void TileCache::keep(Entry entry) {
  const std::lock_guard lock(mutex_);
  ++statistics_.made;
  if (const auto known = by_key_.find(entry.key); known != by_key_.end()) drop(known->second);
  const std::size_t size = entry.tile->bytes.size();
  if (size <= max_bytes_ && memory_.check(size)) {
    entries_.push_front(std::move(entry));
    by_key_[entries_.front().key] = entries_.begin();
    statistics_.bytes += size;
    while (statistics_.bytes > max_bytes_) drop(std::prev(entries_.end()));
  }
  lease_.resize(statistics_.bytes);
}

void TileCache::drop(std::list<Entry>::iterator entry) {
  statistics_.bytes -= entry->tile->bytes.size();
  by_key_.erase(entry->key);
  entries_.erase(entry);
}

TileCache::Statistics TileCache::statistics() const {
  const std::lock_guard lock(mutex_);
  return statistics_;
}

Result<std::shared_ptr<const CachedTile>> TileCache::get(const app::Tin& tin, TileKind kind, const TileId& id) {
  const app::Version version = tin.version();
  std::optional<Tileset> tiles;
  if (is_terrain(kind)) {
    auto made = tileset(tin, version);
    if (!made) return made.error();
    tiles = std::move(*made);
    if (!tiles->has(id)) return error(Code::kNotFound, "There is no such tile.");
  } else if (!mercator_tile_exists(id)) {
    return error(Code::kNotFound, "There is no such tile.");
  }
  const std::string key = tile_key(tin, kind, id);
  if (auto known = find(tin, version.revision, key, tiles)) return known;
  auto bytes = make(*version.terrain, kind, id, tiles);
  if (!bytes) return bytes.error();
  auto tile = std::make_shared<CachedTile>(CachedTile{std::move(*bytes), ""});
  tile->etag = tag_of(tile->bytes);
  Entry entry{key,   tile, version.revision, lattice_area(*version.terrain, is_terrain(kind), id), {}, 0,
              false, {}};
  if (tiles) {
    entry.heights = tiles->heights;
    entry.levels = tiles->levels;
    entry.lowest = tiles->is_lowest(id);
    if (lists_available(id)) entry.extent = tiles->extent;
  }
  keep(std::move(entry));
  return std::shared_ptr<const CachedTile>(std::move(tile));
}

}  // namespace server::tiles
