#include "tin/simplify/reduce.h"

#include "tin/simplify/fast.h"
#include "tin/simplify/greedy.h"
#include "tin/simplify/decimate.h"
#include "tin/simplify/search.h"
#include "tin/simplify/tiles.h"
#include <cstdio>
#include <cstdlib>
#include <ctime>

namespace tin::simplify {

std::optional<Reduced> reduce(const Samples& samples, std::span<const SampleIndex> corners, const Options& options,
                              const Phase& phase) {
  auto tin = reach_tolerance(samples, corners, *options.tolerance, options.threads, phase);
  if (!tin) return std::nullopt;
  if (options.effort != Effort::kFast) {
    const int per = getenv("PER") ? atoi(getenv("PER")) : 8, rounds = getenv("ROUNDS") ? atoi(getenv("ROUNDS")) : 4;
    Random random(options.seed);
    for (int r = 0; r < rounds; ++r) {
      const Tiling tiling = Tiling::of_about(samples.extent(), patch_count(tin->mesh().vertex_count()), random.fraction(), random.fraction());
      const std::uint64_t seed = random.next();
      work_in_patches(tin, tiling, options.threads, phase, [&](Patch& patch, std::size_t tile) {
        Search(patch, *options.tolerance, Random(seed + tile).next()).run(per * patch.owned_count(), [&] { return phase.cancelled(); });
      });
      fprintf(stderr, "round %d: %zu cpu %.2f\n", r, tin->mesh().vertex_count(), double(clock()) / CLOCKS_PER_SEC);
    }
    repair(tin, *options.tolerance, options.threads, phase);
  }
  return Reduced{std::move(tin), true, *options.tolerance};
}

}  // namespace tin::simplify
