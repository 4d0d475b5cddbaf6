// The first state within a tolerance: greedy insertion tile by tile, then repair and deletion across the seams.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "tin/simplify/patch.h"
#include "tin/simplify/phase.h"

namespace tin::simplify {

/// Vertices such that every sample is within the tolerance, and none of which can go.
/// Nothing when cancelled, or when more than `hopeless` vertices were needed on the way.
std::optional<std::vector<Pin>> reach_tolerance(const Samples& samples, std::span<const SampleIndex> corners,
                                                double tolerance, unsigned threads, const Phase& phase);

/// Inserts where samples are over the tolerance, then removes what is not needed, all over. False when cancelled.
bool repair(const Samples& samples, std::vector<Pin>& pins, double tolerance, unsigned threads, const Phase& phase);

}  // namespace tin::simplify
