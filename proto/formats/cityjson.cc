#include "proto/formats/cityjson.h"

#include <algorithm>
#include <cmath>

#include "proto/crs_uri.h"
#include "proto/json_write.h"
#include "proto/numbers.h"

namespace proto::formats {
namespace {

constexpr double kHeightScale = 0.001, kProjectedScale = 0.001, kDegreeScale = 1e-9;

/// "https://www.opengis.net/def/crs/EPSG/0/7415", as CityJSON wants it; nothing for other CRSs. Longitude comes first
/// here, so WGS 84 is called CRS84.
std::optional<std::string> reference_system(const std::string& crs) {
  auto uri = crs_uri(crs == "EPSG:4326" ? kCrs84 : crs);
  if (uri && uri->starts_with("http://")) uri->insert(4, "s");
  return uri;
}

void append_whole(std::string& out, double value) {
  const auto whole = std::llround(value);
  if (whole < 0) out += '-';
  append_integer(out, static_cast<std::uint64_t>(whole < 0 ? -whole : whole));
}

}  // namespace

void CityJsonFormat::begin(std::string& out, const MeshHead& head) {
  const double across = head.geographic ? kDegreeScale : kProjectedScale;
  scale_ = {across, across, kHeightScale};
  origin_ = {std::floor(head.low.x), std::floor(head.low.y), 0};
  if (head.frame) {
    scale_ = {head.frame->x.step(), head.frame->y.step(), kHeightScale};
    origin_ = {head.frame->x.origin, head.frame->y.origin, 0};
  }
  // Whole numbers that a double holds, also of heights that are no terrain's.
  while (std::max(std::abs(head.low.z), std::abs(head.high.z)) / scale_[2] > 9e15) scale_[2] *= 10;
  first_ = true;
  JsonWriter json;
  json.begin_object().key("type").string("CityJSON").key("version").string("1.1");
  json.key("transform").begin_object();
  json.key("scale").begin_array();
  for (const double scale : scale_) json.number(scale);
  json.end_array().key("translate").begin_array();
  json.number(origin_.x).number(origin_.y).number(origin_.z).end_array().end_object();
  json.key("metadata").begin_object();
  if (!head.title.empty()) json.key("title").string(head.title);
  if (const auto uri = reference_system(head.crs)) json.key("referenceSystem").string(*uri);
  json.key("geographicalExtent").begin_array();
  for (const Position& at : {head.low, head.high}) json.number(at.x).number(at.y).number(at.z);
  json.end_array().end_object();
  json.key("vertices").begin_array();
  out += json.take();
}

void CityJsonFormat::vertex(std::string& out, const MeshVertex& vertex) {
  out += first_ ? "\n[" : ",\n[";
  first_ = false;
  append_whole(out, (vertex.at.x - origin_.x) / scale_[0]);
  out += ',';
  append_whole(out, (vertex.at.y - origin_.y) / scale_[1]);
  out += ',';
  append_whole(out, vertex.at.z / scale_[2]);
  out += ']';
}

void CityJsonFormat::between(std::string& out) {
  out +=
      "\n],\"CityObjects\":{\"terrain\":{\"type\":\"TINRelief\",\"geometry\":"
      "[{\"type\":\"CompositeSurface\",\"lod\":\"1\",\"boundaries\":[";
  first_ = true;
}

void CityJsonFormat::triangle(std::string& out, const MeshTriangle& triangle) {
  out += first_ ? "\n[[" : ",\n[[";
  first_ = false;
  for (std::size_t i = 0; i < 3; ++i) {
    if (i > 0) out += ',';
    append_integer(out, triangle.corners[i]);
  }
  out += "]]";
}

void CityJsonFormat::end(std::string& out) {
  out += "\n]}]}}}\n";
}

}  // namespace proto::formats
