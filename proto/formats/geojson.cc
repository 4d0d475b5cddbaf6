#include "proto/formats/geojson.h"

#include "proto/formats/frame_note.h"
#include "proto/json_write.h"
#include "proto/messages_internal.h"
#include "proto/numbers.h"

namespace proto::formats {
namespace {

constexpr int kDegreeDecimals = 9;
constexpr int kProjectedDecimals = 4;

/// Index of the smallest id: where a triangle's description begins.
std::size_t first_corner(const std::array<VertexId, 3>& ids) {
  if (ids[0] < ids[1]) return ids[0] < ids[2] ? 0 : 2;
  return ids[1] < ids[2] ? 1 : 2;
}

std::array<VertexId, 3> rotated(const std::array<VertexId, 3>& ids) {
  const std::size_t first = first_corner(ids);
  return {ids[first], ids[(first + 1) % 3], ids[(first + 2) % 3]};
}

void append_ids(std::string& out, const std::array<VertexId, 3>& ids, char separator) {
  append_integer(out, ids[0].value());
  out += separator;
  append_integer(out, ids[1].value());
  out += separator;
  append_integer(out, ids[2].value());
}

}  // namespace

std::string triangle_id(const std::array<VertexId, 3>& ids) {
  std::string id;
  append_ids(id, rotated(ids), '-');
  return id;
}

std::string feature_with_links(std::string_view feature, std::span<const Link> links) {
  const std::size_t begin = feature.find('{');
  std::string out(feature.substr(begin, feature.rfind('}') - begin));
  JsonWriter json;
  json.begin_object();
  write_links(json, links);
  json.end_object();
  return out + "," + json.take().substr(1);
}

GeoJsonWriter::GeoJsonWriter(std::string& out, Coordinates coordinates, bool continued)
    : out_(out), coordinates_(coordinates), first_(!continued) {}

void GeoJsonWriter::begin(const CollectionHead& head) {
  JsonWriter json;
  json.begin_object().key("type").string("FeatureCollection");
  if (head.crs_urn) {
    json.key("crs").begin_object().key("type").string("name");
    json.key("properties").begin_object().key("name").string(*head.crs_urn).end_object().end_object();
  }
  if (head.number_matched) json.key("numberMatched").integer(*head.number_matched);
  if (head.number_returned) json.key("numberReturned").integer(*head.number_returned);
  if (!head.links.empty()) write_links(json, head.links);
  if (head.frame_note) json.key(kFrameNoteName).raw(*head.frame_note);
  json.key("features").begin_array();
  out_ += json.take();
  first_ = true;
}

void GeoJsonWriter::vertex(VertexId id, const Position& at) {
  separate();
  out_ += R"({"type":"Feature","id":)";
  append_integer(out_, id.value());
  out_ += R"(,"geometry":{"type":"Point","coordinates":)";
  append_position(at);
  out_ += R"(},"properties":{"z":)";
  // Always with a point or exponent: GDAL takes the type of a property from the first page.
  const std::size_t begin = out_.size();
  append_shortest(out_, at.z);
  if (out_.find_first_of(".e", begin) == std::string::npos) out_ += ".0";
  out_ += "}}";
}

void GeoJsonWriter::triangle(const std::array<VertexId, 3>& ids, const std::array<Position, 3>& corners) {
  const std::size_t first = first_corner(ids);
  const std::array<VertexId, 3> ordered = rotated(ids);
  separate();
  out_ += R"({"type":"Feature","id":")";
  append_ids(out_, ordered, '-');
  out_ += R"(","geometry":{"type":"Polygon","coordinates":[[)";
  for (std::size_t i = 0; i < 4; ++i) {
    if (i > 0) out_ += ',';
    append_position(corners[(first + i) % 3]);
  }
  out_ += R"(]]},"properties":{"vertices":[)";
  append_ids(out_, ordered, ',');
  out_ += "]}}";
}

void GeoJsonWriter::edge(const std::array<VertexId, 2>& ids, const std::array<Position, 2>& ends, bool hull) {
  separate();
  out_ += R"({"type":"Feature","id":")";
  append_integer(out_, ids[0].value());
  out_ += '-';
  append_integer(out_, ids[1].value());
  out_ += R"(","geometry":{"type":"LineString","coordinates":[)";
  append_position(ends[0]);
  out_ += ',';
  append_position(ends[1]);
  out_ += R"(]},"properties":{"vertices":[)";
  append_integer(out_, ids[0].value());
  out_ += ',';
  append_integer(out_, ids[1].value());
  out_ += R"(],"hull":)";
  out_ += hull ? "true}}" : "false}}";
}

void GeoJsonWriter::contour(double z, bool closed, std::span<const Position2> at) {
  separate();
  out_ += R"({"type":"Feature","geometry":{"type":"LineString","coordinates":[)";
  for (std::size_t i = 0; i < at.size(); ++i) {
    if (i > 0) out_ += ',';
    append_position({at[i].x, at[i].y, z});
  }
  out_ += R"(]},"properties":{"elevation":)";
  append_shortest(out_, z);
  out_ += closed ? R"(,"closed":true}})" : R"(,"closed":false}})";
}

void GeoJsonWriter::sample(Position2 at, std::optional<double> z) {
  separate();
  out_ += R"({"type":"Feature","geometry":{"type":"Point","coordinates":)";
  if (z) {
    append_position({at.x, at.y, *z});
  } else {
    out_ += '[';
    append_place(at);
    out_ += ']';
  }
  out_ += R"(},"properties":{"elevation":)";
  z ? append_shortest(out_, *z) : void(out_ += "null");
  out_ += "}}";
}

void GeoJsonWriter::stretch(std::span<const Position2> at, std::span<const double> z,
                            std::span<const double> elevation, std::span<const double> distance) {
  separate();
  const bool line = at.size() > 1;
  out_ += R"({"type":"Feature","geometry":{"type":")";
  out_ += line ? R"(LineString","coordinates":[)" : R"(Point","coordinates":)";
  for (std::size_t i = 0; i < at.size(); ++i) {
    if (i > 0) out_ += ',';
    append_position({at[i].x, at[i].y, z[i]});
  }
  if (line) out_ += ']';
  JsonWriter properties;
  properties.begin_object();
  const auto write = [&properties](std::string_view name, std::span<const double> values) {
    if (values.empty()) return;
    properties.key(name).begin_array();
    for (const double value : values) properties.number(value);
    properties.end_array();
  };
  write("elevation", elevation);
  write("distance", distance);
  properties.end_object();
  out_ += R"(},"properties":)";
  out_ += properties.take();
  out_ += '}';
}

void GeoJsonWriter::end() {
  out_ += "\n]}\n";
}

void GeoJsonWriter::separate() {
  out_ += first_ ? "\n" : ",\n";
  first_ = false;
}

void GeoJsonWriter::append_place(Position2 at) {
  if (coordinates_ == Coordinates::kExact) {
    append_shortest(out_, at.x);
    out_ += ',';
    append_shortest(out_, at.y);
    return;
  }
  const int decimals = coordinates_ == Coordinates::kDegrees ? kDegreeDecimals : kProjectedDecimals;
  append_rounded(out_, at.x, decimals);
  out_ += ',';
  append_rounded(out_, at.y, decimals);
}

void GeoJsonWriter::append_position(const Position& at) {
  out_ += '[';
  append_place({at.x, at.y});
  out_ += ',';
  append_shortest(out_, at.z);
  out_ += ']';
}

}  // namespace proto::formats
