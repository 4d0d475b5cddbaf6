// The proof at the end: where each sample lies in the result, and how far from it.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "tin/simplify/patch.h"
#include "tin/simplify/phase.h"
#include "tin/simplify/simplify.h"

namespace tin::simplify {

struct Certificate {
  std::size_t samples = 0;
  double max_error = 0;
  std::optional<SampleIndex> worst;    // nothing when max_error is 0
  std::optional<EdgeScan> worst_edge;  // instead, where an edge of the samples' surface is further off than any sample
  std::size_t level = 0;               // samples that no distance at all is allowed to
  std::size_t crossings = 0;           // with edges of that surface, where it counts
  double rmse = 0;
  std::array<std::size_t, kBins> histogram{};  // as in Report
  bool within = true;                  // exact: every sample is within the tolerance asked about
};

/// Looks every sample up in `result` and measures, and every crossing of its edges where these count, sharing with the way there only the exact judgement of a single
/// sample. `bin`: width of the histogram's bins. Requires: dimension 2, all of it owned; tolerance finite and >= 0.
/// Nothing when cancelled.
std::optional<Certificate> certify(const Patch& result, double tolerance, double bin, unsigned threads,
                                   const Phase& phase);

}  // namespace tin::simplify
