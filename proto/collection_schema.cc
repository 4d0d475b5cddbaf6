#include "proto/collection_schema.h"

#include "proto/json_write.h"

namespace proto {
namespace {

/// The members of a property that every collection has in its own way.
void write_geometry(JsonWriter& json, std::string_view format, std::string_view title) {
  json.key("geometry").begin_object();
  json.key("title").string(title);
  json.key("x-ogc-role").string("primary-geometry");
  json.key("format").string(format);
  json.end_object();
}

void write_id(JsonWriter& json, std::string_view type, std::string_view title) {
  json.key("id").begin_object();
  json.key("title").string(title);
  json.key("x-ogc-role").string("id");
  json.key("type").string(type);
  json.key("readOnly").boolean(true);
  json.end_object();
}

void write_vertex_ids(JsonWriter& json, std::uint64_t count) {
  json.key("vertices").begin_object();
  json.key("title").string("Ids of its vertices");
  json.key("type").string("array");
  json.key("items").begin_object().key("type").string("integer").end_object();
  json.key("minItems").integer(count).key("maxItems").integer(count);
  json.end_object();
}

}  // namespace

std::string collection_schema_json(std::string_view collection, std::string_view id) {
  JsonWriter json;
  json.begin_object();
  json.key("$schema").string("https://json-schema.org/draft/2020-12/schema");
  json.key("$id").string(id);
  json.key("title").string(collection);
  json.key("type").string("object");
  json.key("properties").begin_object();
  if (collection == "vertices") {
    write_id(json, "integer", "Id, as edits use it");
    write_geometry(json, "geometry-point", "Where it stands; the third coordinate is its elevation");
    json.key("z").begin_object().key("title").string("Elevation, in the TIN's vertical unit");
    json.key("type").string("number").end_object();
  } else if (collection == "triangles") {
    write_id(json, "string", "Ids of its vertices, the smallest first, counter-clockwise");
    write_geometry(json, "geometry-polygon", "Its three corners, with elevations");
    write_vertex_ids(json, 3);
  } else {
    write_id(json, "string", "Ids of its vertices, the smaller first");
    write_geometry(json, "geometry-linestring", "Its two ends, with elevations");
    write_vertex_ids(json, 2);
    json.key("hull").begin_object().key("title").string("Whether nothing lies on one of its sides");
    json.key("type").string("boolean").end_object();
  }
  json.end_object().end_object();
  return json.take();
}

}  // namespace proto
