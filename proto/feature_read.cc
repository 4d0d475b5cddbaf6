#include "proto/feature_read.h"

#include "proto/json_read.h"

namespace proto {

using tin::base::Code;
using tin::base::error;
using tin::base::Result;

namespace {

Result<void> require_word(const Object& object, std::string_view name, std::string_view wanted) {
  const auto member = object.require(name);
  if (!member) return member.error();
  const auto text = member->string(64);
  if (!text) return text.error();
  if (*text == wanted) return {};
  return member->error(Code::kInvalidValue, "this must be \"" + std::string(wanted) + "\" here");
}

Result<void> read_geometry(const Value& value, VertexBody& vertex) {
  const auto geometry = value.object({"type", "coordinates", "bbox"});
  if (!geometry) return geometry.error();
  if (auto point = require_word(*geometry, "type", "Point"); !point) return point;
  const auto member = geometry->require("coordinates");
  if (!member) return member.error();
  const auto coordinates = member->array(1000);
  if (!coordinates) return coordinates.error();
  if (coordinates->size() < 2 || coordinates->size() > 3) return member->error(Code::kMalformed, "a position has two or three coordinates");
  double numbers[3] = {};
  std::size_t i = 0;
  for (const Value item : *coordinates) {
    const auto number = item.number();
    if (!number) return number.error();
    numbers[i++] = *number;
  }
  vertex.at = Position2{numbers[0], numbers[1]};
  if (i == 3) vertex.z = numbers[2];
  return {};
}

Result<void> read_properties(const Value& value, VertexBody& vertex) {
  if (value.is_null()) return {};
  const auto properties = value.object({"z"});
  if (!properties) {
    auto problem = properties.error();
    if (value.any_object()) problem.code = Code::kInvalidValue;
    return problem;
  }
  const auto member = properties->find("z");
  if (!member) return {};
  const auto z = member->number();
  if (!z) return z.error();
  if (vertex.z && *vertex.z != *z) {
    return member->error(Code::kInvalidValue, "the property z and the third coordinate must be equal where both are given");
  }
  vertex.z = *z;
  return {};
}

}  // namespace

Result<VertexBody> read_vertex_feature(std::string_view body, FeatureBody kind) {
  const auto document = Document::parse(body);
  if (!document) return document.error();
  const auto feature = document->root().any_object();
  if (!feature) return feature.error();
  VertexBody vertex;
  if (kind == FeatureBody::kWhole) {
    if (auto typed = require_word(*feature, "type", "Feature"); !typed) return typed.error();
    if (const auto geometry = feature->require("geometry"); !geometry) return geometry.error();
  }
  if (const auto geometry = feature->find("geometry")) {
    if (auto read = read_geometry(*geometry, vertex); !read) return read.error();
  }
  if (const auto properties = feature->find("properties")) {
    if (auto read = read_properties(*properties, vertex); !read) return read.error();
  }
  if (kind == FeatureBody::kWhole && !vertex.z) {
    return error(Code::kInvalidValue, "a vertex needs an elevation: a third coordinate or the property z", "/geometry");
  }
  if (!vertex.at && !vertex.z) {
    return error(Code::kInvalidValue, "the patch says nothing that can be changed: geometry or the property z");
  }
  return vertex;
}

}  // namespace proto
