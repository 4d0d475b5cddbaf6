#include "proto/tile_documents.h"

#include "proto/json_write.h"

namespace proto {
namespace {

void write_bounds(JsonWriter& json, const std::array<double, 4>& bounds) {
  json.key("bounds").begin_array();
  for (const double bound : bounds) json.number(bound);
  json.end_array();
}

}  // namespace

std::string layer_json(const LayerDocument& layer) {
  JsonWriter json;
  json.begin_object();
  json.key("tilejson").string("2.1.0");
  json.key("name").string(layer.name);
  json.key("version").string(std::to_string(layer.revision));
  json.key("format").string("quantized-mesh-1.0");
  json.key("scheme").string("tms");
  json.key("projection").string("EPSG:4326");
  json.key("extensions").begin_array().string("octvertexnormals").string("metadata").end_array();
  json.key("tiles").begin_array().string("{z}/{x}/{y}.terrain?v={version}").end_array();
  write_bounds(json, layer.bounds);
  json.key("minzoom").integer(0);
  json.key("maxzoom").integer(layer.available.size() - 1);
  json.key("metadataAvailability").integer(kMetadataLevels);
  json.key("available").begin_array();
  for (const auto& [x0, y0, x1, y1] : layer.available) {
    json.begin_array().begin_object();
    json.key("startX").integer(x0).key("startY").integer(y0).key("endX").integer(x1).key("endY").integer(y1);
    json.end_object().end_array();
  }
  json.end_array();
  json.end_object();
  return json.take();
}

std::string tilejson_json(const TileJsonDocument& document) {
  JsonWriter json;
  json.begin_object();
  json.key("tilejson").string("3.0.0");
  json.key("name").string(document.name);
  json.key("version").string("1.0." + std::to_string(document.revision));
  json.key("scheme").string("xyz");
  json.key("format").string("png");
  json.key("tiles").begin_array().string(document.tiles).end_array();
  if (!document.encoding.empty()) json.key("encoding").string(document.encoding);
  json.key("tileSize").integer(256);
  json.key("minzoom").integer(0);
  json.key("maxzoom").integer(static_cast<std::uint64_t>(document.max_zoom));
  write_bounds(json, document.bounds);
  json.end_object();
  return json.take();
}

}  // namespace proto
