// The way from samples to few vertices: the order of the steps.
#pragma once

#include <memory>
#include <optional>
#include <span>

#include "tin/simplify/patch.h"
#include "tin/simplify/phase.h"
#include "tin/simplify/simplify.h"

namespace tin::simplify {

struct Reduced {
  std::unique_ptr<Patch> tin;
  bool to_tolerance = false;  // every sample is within the tolerance asked for
  double error = 0;           // otherwise: about the largest one
};

/// Requires: options checked; `corners` are those of the samples' hull, at least three and within the budget.
/// Nothing when cancelled.
std::optional<Reduced> reduce(const Samples& samples, std::span<const SampleIndex> corners, const Options& options,
                              const Phase& phase);

}  // namespace tin::simplify
