// The process "simplify" on the wire.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "proto/messages.h"
#include "proto/processes/process.h"

namespace proto {

const ProcessDescription& simplify_description();

/// At least one of tolerance and max_vertices is there.
struct SimplifyInputs {
  std::string tin;
  std::optional<double> tolerance;            // >= 0, in the TIN's vertical unit
  std::optional<std::uint64_t> max_vertices;  // >= 3
  std::optional<std::string> as;  // id of the TIN to make; without it the TIN itself is simplified
};
tin::base::Result<SimplifyInputs> read_simplify_inputs(const Value& inputs);

struct SimplifyResults {
  std::uint64_t vertices_before = 0;
  std::uint64_t vertices_after = 0;
  double max_error = 0;                   // in the TIN's vertical unit, over every source sample
  std::optional<Position2> max_error_at;  // null when every sample lies on the result
  bool tolerance_met = true;              // false only when max_vertices got in its way
  bool edited_meanwhile = false;          // edits landed while it worked; the report is about what it saw
  double rmse = 0;
  double seconds = 0;
  std::string tin;
  std::uint64_t revision = 0;
};
std::string simplify_results_json(const SimplifyResults& results);

}  // namespace proto
