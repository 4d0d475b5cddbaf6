// Simplification with a guarantee: a TIN of fewer vertices that stays within a vertical tolerance of all it
// came from.
//
//   auto outcome = simplify(*snapshot, {.tolerance = 5.0}, &progress);
//   // outcome->removed: ids to remove; outcome->report: what is left, and how far it is from the samples
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "tin/base/progress.h"
#include "tin/base/result.h"
#include "tin/terrain/terrain.h"

namespace tin::simplify {

/// What is asked for; at least one of the two.
struct Options {
  /// Largest vertical distance allowed between any sample and the result, in the terrain's vertical unit:
  /// finite, >= 0.
  std::optional<double> tolerance;
  /// How many vertices may remain: at least those at the corners of the convex hull.
  std::optional<std::size_t> max_vertices;
};

/// The sample that is furthest from the result.
struct Worst {
  terrain::VertexId id;
  exact::Point at;
  double error = 0;  // vertical unit
};

struct Report {
  std::size_t vertices_before = 0, vertices_after = 0;
  double max_error = 0;        // vertical unit, over all samples; never above a tolerance that is met
  std::optional<Worst> worst;  // nothing when every sample lies on the result (max_error is 0)
  double rmse = 0;             // vertical unit, over all samples
  /// Every sample is within the tolerance. True when none was asked for; false only when max_vertices got in
  /// its way.
  bool tolerance_met = true;
};

struct Outcome {
  std::vector<terrain::VertexId> removed;  // ascending
  Report report;
};

/// Chooses vertices of `source` that can go. The samples are the vertices of `source`; the result is the
/// canonical Delaunay triangulation of those that remain.
///
/// `tolerance`: every sample ends up within it, compared as <= on the exact values of the doubles: the
/// heights, the tolerance, and the interpolated height as a fraction. `max_vertices` alone: the smallest
/// largest error that was found within the budget. Both: the result for the tolerance if it fits the budget;
/// otherwise max_vertices wins, and report.tolerance_met says so. The convex hull keeps its shape: its
/// corners stay, and vertices on its edges go only as the tolerance allows. With fewer than three samples, or
/// all of them in a line, nothing is removed.
///
/// Units:    vertical ones of source.frame(); positions on its lattice.
/// Errors:   kInvalidValue (no option, tolerance negative or not finite, max_vertices below what the hull
///           needs: the message says how many), kCancelled.
/// Ensures:  the same set of vertices gives the same result, whatever its history (rmse up to rounding).
/// Cost:     O(n log n) expected. Memory beyond the terrain: 4 bytes per raster cell where heights are whole
///           multiples of a power of two (8 otherwise), 20 per sample off the raster, and about 150 per
///           vertex kept on the way.
/// Threads:  reads `source`; safe beside other readers.
/// Source:   greedy insertion as in Garland and Heckbert 1995; deletion as in Devillers 2002.
base::Result<Outcome> simplify(const terrain::Terrain& source, const Options& options,
                               base::Progress* progress);

}  // namespace tin::simplify
