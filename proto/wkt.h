// Geometries as well-known text, as OGC API EDR takes them: POINT(7 46), LINESTRING(7 46, 7.1 46.2) ...
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "proto/messages.h"
#include "tin/base/result.h"

namespace proto {

/// Points are one part of one sequence, lines a part each, polygons a part each whose sequences are rings.
struct WktGeometry {
  enum class Kind { kPoint, kMultiPoint, kLineString, kMultiLineString, kPolygon, kMultiPolygon };
  using Sequence = std::vector<Position2>;
  Kind kind = Kind::kPoint;
  std::vector<std::vector<Sequence>> parts;
};

/// Two-dimensional geometries, in letters of any case; points of a MULTIPOINT with and without parentheses.
/// Ensures: lines have two positions at least, rings end where they begin and have four at least. Errors:
/// kMalformed (also of other kinds, Z and M, EMPTY, text after the end), kNotFinite, kTooLarge.
tin::base::Result<WktGeometry> parse_wkt(std::string_view text, std::size_t max_positions,
                                         const std::string& where);

}  // namespace proto
