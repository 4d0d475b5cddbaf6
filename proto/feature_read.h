// GeoJSON features that clients send (OGC API Features Part 4).
#pragma once

#include <optional>
#include <string_view>

#include "proto/messages.h"
#include "tin/base/result.h"

namespace proto {

/// What a body says of a vertex, coordinates in the order in which they stand there.
struct VertexBody {
  std::optional<Position2> at;
  std::optional<double> z;
};

enum class FeatureBody {
  kWhole,  // a Feature: its place and elevation must be there
  kPatch,  // a JSON merge patch (RFC 7396) of one: at least one of them
};

/// Reads a Point feature whose elevation is its third coordinate or its property "z"; both must agree. Members that GeoJSON lets
/// anybody add to a Feature are taken and not heeded.
/// Errors: kMalformed, kNotFinite, kInvalidValue (no elevation, two that differ, another geometry, another property).
tin::base::Result<VertexBody> read_vertex_feature(std::string_view body, FeatureBody kind);

}  // namespace proto
