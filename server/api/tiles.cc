// Tiles of the live TIN: quantized-mesh for Cesium, elevations and relief as pictures for MapLibre and others.
#include <algorithm>
#include <cmath>

#include "proto/bbox.h"
#include "proto/formats/png.h"
#include "proto/tile_documents.h"
#include "server/api/answer.h"
#include "server/api/links.h"
#include "server/api/routes.h"
#include "server/tiles/tile_cache.h"

namespace server::api {

using tiles::CachedTile;
using tiles::TileId;
using tiles::TileKind;
using tin::base::Code;
using tin::base::error;

namespace {

tin::base::Error no_such_tile() {
  return error(Code::kNotFound, "There is no such tile.");
}

/// The number in a path. Errors: kNotFound.
Result<std::uint32_t> path_number(const Request& request, std::string_view name, std::uint64_t most) {
  const auto number = proto::parse_count(request.path_parameter(name), 0, most, "");
  if (!number) return no_such_tile();
  return static_cast<std::uint32_t>(*number);
}

Result<TileId> tile_of(const Request& request) {
  const auto z = path_number(request, "z", tiles::kMostLevels);
  if (!z) return z.error();
  const auto x = path_number(request, "x", UINT32_MAX), y = path_number(request, "y", UINT32_MAX);
  if (!x) return x.error();
  if (!y) return y.error();
  return TileId{static_cast<int>(*z), *x, *y};
}

/// Whether the request names the revision that it gets, so that it may be kept for good. Errors: kMalformed at "query:v".
Result<bool> names_revision(const Request& request, std::uint64_t revision) {
  const auto text = request.query_value("v");
  if (!text) return false;
  const auto asked = proto::parse_count(*text, 0, UINT64_MAX, "query:v");
  if (!asked) return error(Code::kMalformed, asked.error().message, "query:v");
  return *asked == revision;
}

void add_caching(Response& response, bool for_good, std::string etag) {
  response.headers.emplace_back("Cache-Control", for_good ? "public, max-age=31536000, immutable" : "no-cache");
  response.headers.emplace_back("ETag", std::move(etag));
}

struct Found {
  std::shared_ptr<const CachedTile> tile;
  bool for_good = false;
};

Result<Found> find_tile(Context& context, const Request& request, TileKind kind) {
  const auto tin = context.catalogue.find(request.path_parameter("tin"));
  if (!tin) return tin.error();
  const auto id = tile_of(request);
  if (!id) return id.error();
  // The revision before the tile: an edit between them makes the tile newer than what is said, never older.
  const std::uint64_t revision = (*tin)->read([](const auto&, std::uint64_t now) { return now; });
  const auto for_good = names_revision(request, revision);
  if (!for_good) return for_good.error();
  const auto tile = context.tiles.get(**tin, kind, *id);
  if (!tile) return tile.error();
  return Found{*tile, *for_good};
}

Result<Response> terrain(Context& context, const Request& request) {
  const bool normals = http::lower_case(request.header("accept")).find("octvertexnormals") != std::string::npos;
  const auto found = find_tile(context, request, normals ? TileKind::kTerrainWithNormals : TileKind::kTerrain);
  if (!found) return found.error();
  Response response{200,
                    {{"Content-Type", std::string(proto::formats::kQuantizedMeshMediaType)},
                     {"Vary", "Accept, Accept-Encoding"}},
                    std::string()};
  std::string tag = found->tile->etag;
  if (http::lower_case(request.header("accept-encoding")).find("gzip") != std::string::npos) {
    response.headers.emplace_back("Content-Encoding", "gzip");
    response.body = found->tile->bytes;
  } else {
    tag.insert(tag.size() - 1, "-plain");
    response.body = tiles::gunzipped(found->tile->bytes);
  }
  add_caching(response, found->for_good, std::move(tag));
  return response;
}

Result<Response> picture(Context& context, const Request& request, TileKind kind) {
  const auto found = find_tile(context, request, kind);
  if (!found) return found.error();
  Response response{200, {{"Content-Type", std::string(proto::formats::kPngMediaType)}}, found->tile->bytes};
  add_caching(response, found->for_good, found->tile->etag);
  return response;
}

Result<TileKind> kind_of(const Request& request) {
  const auto encoding = request.path_parameter("encoding");
  if (encoding == "terrarium") return TileKind::kTerrarium;
  if (encoding == "mapbox") return TileKind::kMapbox;
  return error(Code::kNotFound, "The encodings of elevations are terrarium and mapbox.");
}

Result<Response> elevation(Context& context, const Request& request) {
  const auto kind = kind_of(request);
  return kind ? picture(context, request, *kind) : kind.error();
}

Result<Response> relief(Context& context, const Request& request) {
  return picture(context, request, TileKind::kHillshade);
}

std::array<double, 4> bounds_of(const tiles::Tileset& tileset) {
  return {tileset.extent.west, tileset.extent.south, tileset.extent.east, tileset.extent.north};
}

Result<Response> layer(Context& context, const Request& request) {
  const auto tin = context.catalogue.find(request.path_parameter("tin"));
  if (!tin) return tin.error();
  const app::Version version = (*tin)->version();
  const auto tileset = context.tiles.tileset(**tin, version);
  if (!tileset) return tileset.error();
  proto::LayerDocument document{(*tin)->title(), version.revision, bounds_of(*tileset), {}};
  for (int level = 0; level < tileset->levels; ++level) document.available.push_back(tileset->available(level));
  Response response = json_answer(proto::layer_json(document));
  add_caching(response, false, entity_tag(**tin, version.revision, request));
  return response;
}

/// The zoom at which a pixel is about as large as the space between two vertices.
int finest_zoom(const tiles::Tileset& tileset, std::size_t vertices) {
  const double area = (tileset.extent.east - tileset.extent.west) * (tileset.extent.north - tileset.extent.south);
  const double spacing = std::sqrt(std::max(area, 1e-12) / static_cast<double>(vertices));
  return std::clamp(static_cast<int>(std::ceil(std::log2(360 / (256 * spacing)))), 0, 22);
}

Result<Response> tilejson(Context& context, const Request& request, const std::string& encoding, const std::string& path) {
  const auto tin = context.catalogue.find(request.path_parameter("tin"));
  if (!tin) return tin.error();
  const app::Version version = (*tin)->version();
  const auto tileset = context.tiles.tileset(**tin, version);
  if (!tileset) return tileset.error();
  const std::string url = base_url(context.config, request) + "/tins/" + (*tin)->id() + path + "/{z}/{x}/{y}.png?v=" +
                          std::to_string(version.revision);
  Response response = json_answer(proto::tilejson_json({(*tin)->title(), url, encoding,
                                                        finest_zoom(*tileset, version.terrain->vertex_count()),
                                                        bounds_of(*tileset), version.revision}));
  add_caching(response, false, entity_tag(**tin, version.revision, request));
  return response;
}

Result<Response> elevation_tilejson(Context& context, const Request& request) {
  if (const auto kind = kind_of(request); !kind) return kind.error();
  const std::string encoding(request.path_parameter("encoding"));
  return tilejson(context, request, encoding, "/dem/" + encoding);
}

Result<Response> relief_tilejson(Context& context, const Request& request) {
  return tilejson(context, request, "", "/hillshade");
}

}  // namespace

void add_tiles(http::Router& router, Context& context) {
  using http::Method;
  const auto add = [&](const std::string& pattern, std::vector<std::string> query, auto f) {
    router.add({.method = Method::kGet,
                .pattern = "/tins/{tin}" + pattern,
                .query = std::move(query),
                .handler = guarded([&context, f](Request& request) { return f(context, request); })});
  };
  add("/terrain/layer.json", {}, layer);
  add("/terrain/{z}/{x}/{y}.terrain", {"v"}, terrain);
  add("/dem/{encoding}/tilejson.json", {}, elevation_tilejson);
  add("/dem/{encoding}/{z}/{x}/{y}.png", {"v"}, elevation);
  add("/hillshade/tilejson.json", {}, relief_tilejson);
  add("/hillshade/{z}/{x}/{y}.png", {"v"}, relief);
}

}  // namespace server::api
