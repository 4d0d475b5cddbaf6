// The first state within a tolerance: greedy insertion, deletion and a little local search tile by tile, then
// what is left to do at the seams.
#pragma once

#include <memory>
#include <span>

#include "tin/simplify/patch.h"
#include "tin/simplify/phase.h"

namespace tin::simplify {

/// A TIN of which every sample is within the tolerance, and none of whose vertices can go. Null when
/// cancelled.
std::unique_ptr<Patch> reach_tolerance(const Samples& samples, std::span<const SampleIndex> corners,
                                       double tolerance, unsigned threads, const Phase& phase);

/// Brings any TIN within the tolerance: inserts where samples are over it, then removes what is not needed.
/// False when cancelled; then `tin` is null.
bool repair(std::unique_ptr<Patch>& tin, double tolerance, unsigned threads, const Phase& phase);

}  // namespace tin::simplify
