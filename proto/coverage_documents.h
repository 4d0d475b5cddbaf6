// What OGC API Coverages says of a grid of elevations: the members of its older draft that GDAL 3.6 and OWSLib ask for.
#pragma once

#include <array>
#include <cstdint>
#include <string>

namespace proto {

/// A grid in longitude and latitude (CRS84). Degrees; bounds are those of the cells' outer sides.
struct CoverageGrid {
  std::array<double, 4> bounds{};  // west, south, east, north
  std::int64_t width = 0, height = 0;
};

std::string coverage_domain_json(const CoverageGrid& grid);

/// One field, "elevation". `unit` is the name of its unit, empty when it is not known.
std::string coverage_range_json(const std::string& unit);

}  // namespace proto
