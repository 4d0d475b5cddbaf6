// OGC API EDR: what a query of the surface says, and its answers as CoverageJSON.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "proto/json_write.h"
#include "proto/messages.h"
#include "tin/base/result.h"

namespace proto {

inline constexpr std::string_view kCovJsonMediaType = "application/vnd.cov+json";
/// Names of the formats, as "f" and the collection's document have them.
inline constexpr std::string_view kCoverageJson = "CoverageJSON", kGeoJsonName = "GeoJSON";

// Questions ------------------------------------------------------------------------

/// Levels that "z" selects: "850", "100/550", "10,80,100" or "R20/100/50" (20 levels from 100 on, 50 apart).
class Levels {
 public:
  /// Errors: kMalformed, kNotFinite, kTooLarge (more than 10,000 levels).
  static tin::base::Result<Levels> parse(std::string_view text, const std::string& where);
  static Levels between(double low, double high);
  bool contains(double level) const;

 private:
  double low_ = 0, high_ = 0;   // when there are no values
  std::vector<double> values_;  // ascending
};

/// Which of the surface's parameters are wanted.
struct SurfaceParameters {
  bool elevation = true;
  bool distance = false;  // along a trajectory
};

/// "elevation", "distance" or both, with a comma. Errors: kMalformed for other names, and for "distance"
/// where nothing has one.
tin::base::Result<SurfaceParameters> parse_parameter_names(const std::optional<std::string>& text,
                                                           bool has_distance, const std::string& where);

// Answers --------------------------------------------------------------------------

/// Elevations at places: at the nodes of a grid, row by row from the south and from the west, or at each
/// place.
struct SurfaceCoverage {
  struct Axis {
    double start = 0, stop = 0;
    std::int64_t count = 0;
  };
  std::vector<Position2> at;  // empty: the nodes of the grid
  Axis x, y;
  bool single = false;  // `at` is one place that was asked for alone
  std::vector<std::optional<double>> elevation;
  std::vector<double> distance;  // metres along the line
};

/// What coverages of one answer have in common.
struct CoverageSetting {
  std::string crs_uri;
  bool geographic = true;
  bool northing_first = false;  // the authority's order; x stays longitude or easting
  std::string vertical_unit;    // empty: not known
  SurfaceParameters parameters;
};

/// One coverage as a Coverage, several as a CoverageCollection.
std::string coverage_json(std::span<const SurfaceCoverage> coverages, const CoverageSetting& setting,
                          bool collection);

/// "elevation" as an object: what a collection and a coverage say of it. UCUM symbols for known units.
void write_elevation_parameter(JsonWriter& json, std::string_view vertical_unit);

/// "m", "[ft_i]" or "[ft_us]"; empty for other units.
std::string_view ucum_symbol(std::string_view unit);

}  // namespace proto
