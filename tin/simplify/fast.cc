#include "tin/simplify/fast.h"

#include <algorithm>
#include <vector>

#include "tin/simplify/decimate.h"
#include "tin/simplify/greedy.h"
#include "tin/simplify/search.h"
#include "tin/simplify/tiles.h"

namespace tin::simplify {

using mesh::TriangleSlot;
using mesh::VertexSlot;

namespace {

constexpr std::size_t kSamplesPerTile = std::size_t{1} << 16;
/// Tiles that are worked on as one in the next round, when there are many.
constexpr std::size_t kTilesTogether = 8, kFewPatches = 8;

/// Each sample once, fixed if it is in any place.
void unite(std::vector<Pin>& pins) {
  std::sort(pins.begin(), pins.end(), [](const Pin& a, const Pin& b) {
    return a.sample != b.sample ? a.sample < b.sample : a.fixed && !b.fixed;
  });
  const auto same = [](const Pin& a, const Pin& b) { return a.sample == b.sample; };
  pins.erase(std::unique(pins.begin(), pins.end(), same), pins.end());
}

bool holds(const terrain::Box& box, exact::Point p) {
  return box.min.x <= p.x && p.x <= box.max.x && box.min.y <= p.y && p.y <= box.max.y;
}

/// How many samples lie in a tile, about.
std::size_t samples_in(const Samples& samples, const Tiling& tiling, std::size_t tile) {
  const auto area = [](const terrain::Box& box) {
    return (static_cast<double>(box.max.x) - box.min.x) * (static_cast<double>(box.max.y) - box.min.y);
  };
  const Extent extent = samples.extent();
  return static_cast<std::size_t>(static_cast<double>(extent.samples) * area(tiling.box(tile)) /
                                  std::max(area(extent.box), 1.0));
}

/// Brings a tile's TIN within the tolerance. A little local search finds what deletion alone does not, and
/// spares more than a detour over a looser tolerance in the same time.
void thin(Patch& patch, double tolerance, std::size_t samples, std::uint64_t seed, const Phase& phase) {
  constexpr std::size_t kVerticesPerTry = 6, kSamplesPerTry = 48;
  Greedy(patch, tolerance).run(Greedy::kNoBudget, phase);
  Decimation(patch, tolerance).run(phase);
  const std::size_t tries = std::min(patch.mesh().vertex_count() / kVerticesPerTry, samples / kSamplesPerTry);
  Search(patch, tolerance, Elevations::kSource, seed).run(tries, [&phase] { return phase.cancelled(); });
}

/// The samples of each tile alone, from the corners of their hull and from those in it on that never go. Tile by tile, behind those
/// that more than one tile may have.
bool start_in_tiles(const Samples& samples, const Tiling& tiling, std::span<const SampleIndex> fixed,
                    double tolerance, unsigned threads, const Phase& phase, std::vector<Pin>& pins) {
  struct Found {
    std::vector<Pin> own, shared;
  };
  std::vector<Found> found(tiling.size());
  const bool finished = for_each_tile(tiling.size(), threads, phase, [&](std::size_t tile) {
    std::vector<Pin> corners;
    for (const SampleIndex corner : hull_corners(samples, tiling.box(tile))) {
      corners.push_back({samples.site(corner).z, corner, true});
    }
    const terrain::Box box = tiling.box(tile);
    for (const SampleIndex sample : fixed) {
      if (holds(box, samples.position(sample))) corners.push_back({samples.site(sample).z, sample, true});
    }
    unite(corners);
    Patch patch(samples, {}, corners);
    if (patch.mesh().dimension() == 2)
      thin(patch, tolerance, samples_in(samples, tiling, tile), Random(tile).next(), phase.silent());
    patch.collect(found[tile].own);
    const auto is_own = [&](const Pin& pin) { return !pin.fixed && tiling.is_inside(tile, samples.position(pin.sample)); };
    auto& [own, shared] = found[tile];
    const auto end_of_own = std::partition(own.begin(), own.end(), is_own);
    shared.assign(end_of_own, own.end());
    own.erase(end_of_own, own.end());
    for (Pin& pin : shared) pin.fixed = false;
  });
  for (const SampleIndex sample : fixed) pins.push_back({samples.site(sample).z, sample, true});
  for (const Found& part : found) pins.insert(pins.end(), part.shared.begin(), part.shared.end());
  unite(pins);
  std::size_t count = pins.size();
  for (const Found& part : found) count += part.own.size();
  pins.reserve(count);  // they are many, and doubling would ask for twice as much
  for (Found& part : found) {
    pins.insert(pins.end(), part.own.begin(), part.own.end());
    std::vector<Pin>().swap(part.own);
  }
  return finished;
}

/// Which triangles are known from a tile's own TIN. A triangle with all corners inside one tile is empty of
/// its vertices, so it was there too; and where a vertex has only such triangles, its star is the same.
/// Unsettles all other vertices.
std::vector<bool> find_seams(Patch& tin, const Tiling& tiling) {
  const mesh::Mesh& mesh = tin.mesh();
  std::vector<std::uint32_t> tile_of(mesh.vertex_slots(), mesh::kNone);
  for (std::uint32_t i = 1; i < mesh.vertex_slots(); ++i) {
    const exact::Point p = mesh.point(VertexSlot(i));
    const std::size_t tile = tiling.tile_of(p);
    if (tiling.is_inside(tile, p)) tile_of[i] = static_cast<std::uint32_t>(tile);
  }
  std::vector<bool> on_seam(mesh.triangle_slots(), false);
  for (std::uint32_t i = 0; i < mesh.triangle_slots(); ++i) {
    const auto& v = mesh.triangle(TriangleSlot(i)).vertices;
    if (!mesh.is_alive(TriangleSlot(i))) continue;
    const std::uint32_t tile = tile_of[v[0].value()];
    if (tile != mesh::kNone && tile_of[v[1].value()] == tile && tile_of[v[2].value()] == tile) continue;
    on_seam[i] = true;
    for (const VertexSlot corner : v) tin.unsettle(corner);
  }
  return on_seam;
}

bool repair_patches(std::unique_ptr<Patch>& tin, std::size_t patches, double tolerance, unsigned threads,
                    const Phase& phase) {
  const Tiling tiling = Tiling::of_about(tin->samples().extent(), patches, 0.5, 0.5);
  return work_in_patches(tin, tiling, threads, phase, [&](Patch& patch, std::size_t) {
    Greedy(patch, tolerance).run(Greedy::kNoBudget, phase.silent());
    Decimation(patch, tolerance).run(phase.silent());
  });
}

/// Where there are many tiles, most of what is to be done at their seams is done in larger ones that lie
/// elsewhere, then in still larger ones: by all threads, and near by, so that little of a large raster is
/// needed at a time. False when cancelled.
bool join_tiles(std::unique_ptr<Patch>& tin, std::size_t tiles, double tolerance, unsigned threads,
                const Phase& phase) {
  double from = 0;
  for (std::size_t patches = tiles / kTilesTogether; patches >= kFewPatches; patches /= kTilesTogether) {
    const double to = from + (1 - from) / 2;
    if (!repair_patches(tin, patches, tolerance, threads, phase.part(from, to))) return false;
    from = to;
  }
  return true;
}

}  // namespace

bool repair(std::unique_ptr<Patch>& tin, double tolerance, unsigned threads, const Phase& phase) {
  const std::size_t patches = patch_count(tin->mesh().vertex_count());
  if (patches > 1 && !repair_patches(tin, patches, tolerance, threads, phase.part(0, 0.8))) return false;
  const Phase rest = phase.part(patches > 1 ? 0.8 : 0, 1);
  const bool finished =
      Greedy(*tin, tolerance).run(Greedy::kNoBudget, rest.part(0, 0.5)) != Greedy::End::kCancelled &&
      Decimation(*tin, tolerance).run(rest.part(0.5, 1));
  if (!finished) tin.reset();
  return finished;
}

std::unique_ptr<Patch> reach_tolerance(const Samples& samples, std::span<const SampleIndex> corners,
                                       double tolerance, unsigned threads, const Phase& phase) {
  const Extent extent = samples.extent();
  const Tiling tiling = Tiling::of_about(extent, extent.samples / kSamplesPerTile);
  std::vector<Pin> pins;
  if (!start_in_tiles(samples, tiling, corners, tolerance, threads, phase.part(0, 0.8), pins)) return nullptr;
  auto tin = std::make_unique<Patch>(samples, std::span<const Pin>(), pins, threads);
  std::vector<Pin>().swap(pins);
  const auto on_seam = find_seams(*tin, tiling);
  // An edge of the samples' surface may have called for a sample beyond the tile, so nothing is known of any
  // triangle. Nor is it after rounds in which others were made.
  const bool in_rounds = tiling.size() / kTilesTogether >= kFewPatches;
  const bool all = samples.has_surface() || in_rounds;
  if (!join_tiles(tin, tiling.size(), tolerance, threads, phase.part(0.8, 0.9))) return nullptr;
  const auto suspect = [&on_seam, all](TriangleSlot t) { return all || on_seam[t.value()]; };
  const Phase rest = phase.part(in_rounds ? 0.9 : 0.8, 1);
  if (Greedy(*tin, tolerance).run(Greedy::kNoBudget, rest.part(0, 0.5), suspect) == Greedy::End::kCancelled)
    return nullptr;
  if (!Decimation(*tin, tolerance).run(rest.part(0.5, 1))) return nullptr;
  return tin;
}

}  // namespace tin::simplify
