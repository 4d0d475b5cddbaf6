#include "tin/simplify/fast.h"

#include <algorithm>
#include <cstdlib>

#include "tin/simplify/decimate.h"
#include "tin/simplify/greedy.h"
#include "tin/simplify/tiles.h"

namespace tin::simplify {

namespace {

constexpr std::size_t kSamplesPerTile = std::size_t{1} << 16;
constexpr std::size_t kVerticesPerPatch = 4096;

/// Greedy insertion over the samples of each tile alone, from the corners of their hull on.
bool start_in_tiles(const Samples& samples, double tolerance, unsigned threads, const Phase& phase,
                    std::vector<Pin>& pins) {
  const Extent extent = samples.extent();
  const Tiling tiling = Tiling::of_about(extent, extent.samples / kSamplesPerTile);
  std::vector<std::vector<Pin>> found(tiling.size());
  const bool finished = for_each_tile(tiling.size(), threads, phase, [&](std::size_t tile) {
    std::vector<Pin> corners;
    for (const SampleIndex corner : hull_corners(samples, tiling.box(tile))) corners.push_back({samples.site(corner).z, corner});
    Patch patch(samples, {}, corners);
    if (patch.mesh().dimension() == 2) Greedy(patch, tolerance).run(Greedy::kNoBudget, phase.silent());
    patch.collect(found[tile]);
  });
  for (const auto& part : found) pins.insert(pins.end(), part.begin(), part.end());
  return finished;
}

/// Puts the fixed ones in, and each sample once.
void settle_duplicates(std::vector<Pin>& pins) {
  std::sort(pins.begin(), pins.end(), [](const Pin& a, const Pin& b) {
    return a.sample != b.sample ? a.sample < b.sample : a.fixed && !b.fixed;
  });
  const auto same = [](const Pin& a, const Pin& b) { return a.sample == b.sample; };
  pins.erase(std::unique(pins.begin(), pins.end(), same), pins.end());
}

}  // namespace

bool repair(const Samples& samples, std::vector<Pin>& pins, double tolerance, unsigned threads, const Phase& phase) {
  const std::size_t patches = pins.size() / kVerticesPerPatch;
  if (patches > 1) {
    const Tiling tiling = Tiling::of_about(samples.extent(), patches, 0.5, 0.5);
    const Phase part = phase.part(0, 0.8);
    const bool finished = work_in_patches(samples, pins, tiling, threads, part, [&](Patch& patch, std::size_t) {
      Greedy(patch, tolerance).run(Greedy::kNoBudget, part.silent());
      Decimation(patch, tolerance).run(part.silent());
    });
    if (!finished) return false;
  }
  const Phase rest = phase.part(patches > 1 ? 0.8 : 0, 1);
  Patch whole(samples, {}, pins, threads);
  if (Greedy(whole, tolerance).run(Greedy::kNoBudget, rest.part(0, 0.5)) == Greedy::End::kCancelled) return false;
  if (!Decimation(whole, tolerance).run(rest.part(0.5, 1))) return false;
  pins.clear();
  whole.collect(pins);
  return true;
}

std::optional<std::vector<Pin>> reach_tolerance(const Samples& samples, std::span<const SampleIndex> corners,
                                                double tolerance, unsigned threads, const Phase& phase) {
  std::vector<Pin> pins;
  for (const SampleIndex corner : corners) pins.push_back({samples.site(corner).z, corner, true});
  if (!start_in_tiles(samples, tolerance, threads, phase.part(0, 0.5), pins)) return std::nullopt;
  settle_duplicates(pins);
  if (!repair(samples, pins, tolerance, threads, phase.part(0.5, 1))) return std::nullopt;
  return pins;
}

}  // namespace tin::simplify
