// Simplification with a guarantee: a TIN of fewer vertices that stays within a vertical tolerance of all it
// came from.
//
//   auto outcome = simplify(*snapshot, &source, {}, {.tolerance = 5.0, .threads = 2}, &progress);
//   // outcome->removed, ->inserted: how the terrain becomes the result; ->report: how far that is from the samples
//
//   auto chosen = simplify_samples(source, {.tolerance = 5.0}, &progress);   // no terrain needed: the straight import
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory_resource>
#include <optional>
#include <span>
#include <vector>

#include "tin/base/progress.h"
#include "tin/base/result.h"
#include "tin/terrain/source_samples.h"
#include "tin/terrain/terrain.h"

namespace tin::simplify {

/// How much time goes into fewer vertices.
enum class Effort {
  kFast,      // greedy insertion, then deletion of all that is not needed, and a little local search
  kBalanced,  // about three times as long: more of it
  kThorough,  // ten times
  kBest,      // until out_of_time says so; without it, fifty times
};

/// Which heights vertices have.
enum class Elevations {
  kSource,  // those of the samples where they stand
  kFit,     // any within the tolerance of these: local search finds fewer vertices so. What never goes keeps its own
};

/// What stays within the tolerance of the result.
enum class Against {
  kSamples,
  kSurface,  // and the surface that they make: their canonical TIN, wherever its edges cross the result's
};

/// What is asked for; a tolerance, a number of vertices, or both.
struct Options {
  /// Largest vertical distance allowed between any sample and the result, in the terrain's vertical unit:
  /// finite, >= 0.
  std::optional<double> tolerance;
  /// How many vertices may remain: at least those at the corners of the convex hull.
  std::optional<std::size_t> max_vertices;
  Effort effort = Effort::kBalanced;
  Elevations elevations = Elevations::kSource;
  Against against = Against::kSamples;
  /// Plateaus of at least so many samples must not be tilted: those lie on the result exactly that are level with all their
  /// neighbours (the eight pixels around, or what the triangulation of all samples links them to). 0: none.
  std::size_t keep_flat = 0;
  /// Asked now and then, by several threads at once: once it says true, the best state so far is certified and
  /// returned. (The engine knows no clock.) While the first certified state is not reached yet, work goes on.
  std::function<bool()> out_of_time;
  /// Where samples stay vertices, whatever they are worth; a position without a sample does not count.
  std::vector<exact::Point> protect;
  /// Local search follows it; the result depends on it, but not on the threads.
  std::uint64_t seed = 1;
  unsigned threads = 1;
  /// For the one array that is as large as the raster: 4 bytes a cell where heights are whole multiples of 2^-16, else 8. It is filled
  /// row by row and then read where the work is. All else, but for keep_flat and Against::kSurface, grows with the result.
  std::pmr::memory_resource* memory = std::pmr::get_default_resource();
  /// Asked, by one thread at a time, before all else takes more: whether there is room for so many bytes
  /// together. An estimate that errs upwards: of the TIN that is worked on, of samples that are no raster's,
  /// of plateaus, of the samples' triangulation. Empty: there always is.
  std::function<bool(std::size_t bytes)> room;
};

/// The sample that is furthest from the result, or a place between two of them.
struct Worst {
  exact::Point at;
  double z = 0;      // the sample's own height; the surface's, between two
  double error = 0;  // vertical unit
  /// Between two: the other one, and what part of the way there.
  struct Between {
    exact::Point to;
    double along = 0;
  };
  std::optional<Between> between;
  /// Its index in the source, where one was given and the sample is from there (not a person's edit).
  std::optional<std::size_t> source_index;
};

/// Of a report's histogram.
inline constexpr std::size_t kBins = 16;

struct Report {
  std::size_t vertices_before = 0, vertices_after = 0;
  std::size_t samples = 0;     // what was certified
  std::size_t crossings = 0;   // the same, with edges of the samples' surface: Against::kSurface
  std::size_t level = 0;       // samples of plateaus, which lie on the result exactly: keep_flat
  double max_error = 0;        // vertical unit, over all samples and crossings; never above a tolerance that is met
  std::optional<Worst> worst;  // nothing when every sample lies on the result (max_error is 0)
  double rmse = 0;             // vertical unit, over all samples
  /// How many samples have an error in [i, i + 1) times `bin`; the last bin also holds all above. `bin` is a sixteenth of the
  /// tolerance when that is met, else of the largest error that the search itself saw.
  std::array<std::size_t, kBins> histogram{};
  double bin = 0;
  /// Every sample is within the tolerance. True when none was asked for; false only when max_vertices got in
  /// its way.
  bool tolerance_met = true;
};

struct Outcome {
  std::vector<terrain::VertexId> removed;     // ascending
  std::vector<terrain::Placement> inserted;   // samples that become vertices again, by position
  std::vector<terrain::Vertex> reset;         // vertices that stay and get this height, by id
  Report report;
};

/// Chooses the vertices that `terrain` should have. The samples are those of the `source` (null: none),
/// people's `own` beside them, and the vertices that stand where neither has a sample: somebody's edits, or
/// all there is. The result is the canonical Delaunay triangulation of some of the samples. What is in force
/// of a source after edits, and which samples are people's own, terrain::Amendments knows.
///
/// Requires: `own` ascends by position and shares none with the source; the terrain covers all samples.
///
/// Voids: a cell without a sample binds nothing. Triangles pass over voids, and over bays of the hull, so
/// that the TIN stays one Delaunay triangulation; what they say there is no terrain, and exports leave it out
/// by the source grid's mask.
///
/// `tolerance`: every sample ends up within it, compared as <= on the exact values of the doubles: the
/// heights, the tolerance, and the interpolated height as a fraction. `max_vertices` alone: the smallest
/// largest error that was found within the budget. Both: the result for the tolerance if it fits the budget;
/// otherwise max_vertices wins, and report.tolerance_met says so. The convex hull keeps its shape: its
/// corners stay, and vertices on its edges go only as the tolerance allows. With fewer than three samples, or
/// all of them in a line, all of them are kept.
///
/// Units:    vertical ones of terrain.frame(); positions on its lattice.
/// Errors:   kInvalidValue (no option, tolerance negative or not finite, max_vertices below what the hull
///           and what is protected need: the message says how many), kTooLarge (no room), kCancelled.
/// Ensures:  the same samples, options and seed give the same result for any number of threads, whatever the
///           terrain's history; unless out_of_time said true (rmse up to rounding).
/// Cost:     O(n log n) expected, times what the effort says.
/// Threads:  reads its arguments; safe beside other readers.
/// Source:   greedy insertion as in Garland and Heckbert 1995; deletion as in Devillers 2002; local search is
///           ruin and recreate (Schrimpf et al. 2000) that accepts equals.
base::Result<Outcome> simplify(const terrain::Terrain& terrain, const terrain::SourceSamples* source,
                               std::span<const terrain::Placement> own, const Options& options, base::Progress* progress);

/// What `terrain` should have after all, when the vertices of `start` were chosen for an earlier state of it: those of them that are
/// samples or vertices here, with their heights in `start` where the tolerance allows these, and all samples that the tolerance needs
/// beside them (greedy insertion; none of them goes), and what is protected. Of the options `effort`, `elevations`, `max_vertices`
/// and `out_of_time` mean nothing.
/// Requires: as simplify(); a tolerance; both terrains have dimension 2. Errors: kInvalidValue, kTooLarge, kCancelled.
/// Ensures:  report.tolerance_met. Cost: building the TIN of `start`, and a look at all samples.
base::Result<Outcome> mend(const terrain::Terrain& terrain, const terrain::SourceSamples* source,
                           std::span<const terrain::Placement> own, const terrain::Terrain& start,
                           const Options& options, base::Progress* progress);

struct Chosen {
  std::vector<terrain::Placement> vertices;  // by sample index
  Report report;
};
/// The same for samples that no terrain holds.
base::Result<Chosen> simplify_samples(const terrain::SourceSamples& source, const Options& options,
                                      base::Progress* progress);

}  // namespace tin::simplify
