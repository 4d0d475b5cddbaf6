// The process "simplify" on the wire.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "proto/json_write.h"
#include "proto/messages.h"
#include "proto/processes/process.h"

namespace proto {

const ProcessDescription& simplify_description();

/// How much time goes into fewer vertices.
enum class SimplifyEffort { kFast, kBalanced, kThorough, kBest };
/// "fast", "balanced", "thorough" or "best". Errors: kInvalidValue.
tin::base::Result<SimplifyEffort> parse_effort(std::string_view text, std::string where);

/// Which heights vertices have. Errors: kInvalidValue.
enum class SimplifyElevations { kSource, kFit };
tin::base::Result<SimplifyElevations> parse_elevations(std::string_view text, std::string where);

/// What the tolerance is held against. Errors: kInvalidValue.
enum class SimplifyAgainst { kSamples, kSurface };
tin::base::Result<SimplifyAgainst> parse_against(std::string_view text, std::string where);

/// How many level samples make a plateau, when a request does not say.
inline constexpr std::uint64_t kPlateauSamples = 64;
/// "true", "false" or a number of samples, as they stand in a query; 0: plateaus may be tilted. Errors:
/// kMalformed, kInvalidValue.
tin::base::Result<std::uint64_t> parse_keep_flat(std::string_view text, std::string where);

/// How many vertices may remain, after how many seconds the search ends, and what it follows, as they stand in a query. Errors:
/// kMalformed, kInvalidValue.
tin::base::Result<std::uint64_t> parse_max_vertices(std::string_view text, const std::string& where);
tin::base::Result<double> parse_max_seconds(std::string_view text, const std::string& where);
tin::base::Result<std::uint64_t> parse_seed(std::string_view text, const std::string& where);

/// Which vertices stay.
struct SimplifyProtect {
  using Ring = std::vector<Position2>;  // closed or not
  using Polygon = std::vector<Ring>;    // outer ring, holes
  struct Id {
    VertexId id;
    std::string where;  // its pointer
  };
  bool border = false;  // those on the outline
  std::vector<Id> ids;
  std::vector<Polygon> polygons;  // in the TIN's CRS: those inside
};

/// At least one of tolerance and max_vertices is there.
struct SimplifyInputs {
  std::string tin;
  std::optional<double> tolerance;            // >= 0, in the TIN's vertical unit
  std::optional<std::uint64_t> max_vertices;  // >= 3
  SimplifyEffort effort = SimplifyEffort::kBalanced;
  SimplifyElevations elevations = SimplifyElevations::kSource;
  SimplifyAgainst against = SimplifyAgainst::kSamples;
  std::uint64_t keep_flat = 0;  // samples of a plateau; 0: plateaus may be tilted
  std::optional<double> max_seconds;  // 0.001 to 86400
  std::uint64_t seed = 1;
  SimplifyProtect protect;
  std::optional<std::string> as;  // id of the TIN to make; without it the TIN itself is simplified
};
tin::base::Result<SimplifyInputs> read_simplify_inputs(const Value& inputs);

/// The sample that is furthest from the result, or a place between samples.
struct SimplifyWorst {
  double x = 0, y = 0;  // in the TIN's CRS
  double z = 0;         // its own height; the surface's between samples
  double error = 0;
  std::optional<std::uint64_t> column, row;  // of a source raster
  std::optional<std::uint64_t> index;        // of source points, by position from 0
};

struct SimplifyResults {
  std::string crs, vertical_unit;  // the TIN's; null when empty: not known
  std::uint64_t vertices_before = 0;
  std::uint64_t vertices_after = 0;
  double max_error = 0;                // in the TIN's vertical unit, over every sample
  std::optional<SimplifyWorst> worst;  // null when every sample lies on the result
  bool tolerance_met = true;              // false only when max_vertices got in its way
  bool edited_meanwhile = false;          // edits landed while it worked; the report is about what it saw
  double rmse = 0;
  bool against_source = false;      // else against the vertices that there were
  std::uint64_t samples = 0;        // that it was certified against
  std::uint64_t level = 0;          // of these, on plateaus that were kept flat
  std::uint64_t crossings = 0;      // of edges with those of the samples' surface, the same
  bool out_of_time = false;         // the search was ended by a time budget
  std::uint64_t out_of_force = 0;   // samples of the source that edits put out of force
  std::optional<std::uint64_t> duplicates;  // of a file: points that went because another stands at the same place
  double histogram_bin = 0;         // width; the last bin holds all above as well
  std::vector<std::uint64_t> histogram;
  double seconds = 0;
  std::string tin;
  std::uint64_t revision = 0;
};
/// The members that say how good the result is, those of an object that is open already.
void write_simplify_report(JsonWriter& json, const SimplifyResults& results);
/// The whole of it, as an object.
void write_simplify_results(JsonWriter& json, const SimplifyResults& results);
std::string simplify_results_json(const SimplifyResults& results);

}  // namespace proto
