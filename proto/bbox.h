// Numbers and boxes in query strings: the whole text, finite, in range, or an error that names the parameter.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "tin/base/result.h"

namespace proto {

/// A decimal integer within [min, max], without sign. Errors: kMalformed, kInvalidValue (out of range).
tin::base::Result<std::uint64_t> parse_count(std::string_view text, std::uint64_t min, std::uint64_t max,
                                             std::string where);

/// A decimal number. Errors: kMalformed, kNotFinite (also of "nan", "inf" and 1e999).
tin::base::Result<double> parse_number(std::string_view text, std::string where);

struct Bbox {
  double min_x = 0, min_y = 0, max_x = 0, max_y = 0;
  std::optional<double> min_z, max_z;  // both or none
  friend bool operator==(const Bbox&, const Bbox&) = default;
};

/// "minx,miny,maxx,maxy" or "minx,miny,minz,maxx,maxy,maxz"; a box may be a point.
/// Errors: kMalformed, kNotFinite, kInvalidValue (a minimum above its maximum).
tin::base::Result<Bbox> parse_bbox(std::string_view text, std::string where);

/// The same for longitudes and latitudes, where a box whose first longitude is the larger one goes over the antimeridian:
/// then it is two boxes.
tin::base::Result<std::vector<Bbox>> parse_lon_lat_bbox(std::string_view text, std::string where);

}  // namespace proto
