#include "tin/simplify/reduce.h"

#include "tin/simplify/fast.h"
#include "tin/simplify/greedy.h"
#include "tin/simplify/decimate.h"

namespace tin::simplify {

std::optional<Reduced> reduce(const Samples& samples, std::span<const SampleIndex> corners, const Options& options,
                              const Phase& phase) {
  auto pins = reach_tolerance(samples, corners, *options.tolerance, options.threads, phase);
  if (!pins) return std::nullopt;
  return Reduced{std::move(*pins), true, *options.tolerance};
}

}  // namespace tin::simplify
