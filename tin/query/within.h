// Which vertices lie in a polygon, decided exactly.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "tin/exact/point.h"
#include "tin/query/region.h"
#include "tin/terrain/terrain.h"

namespace tin::query {

/// A polygon that may have holes and cross itself: a point is inside if it lies on a side, or if an odd
/// number of turns encloses it.
class Inside {
 public:
  /// Outlines and holes in any order. The last position need not repeat the first. Requires: positions on the
  /// lattice.
  explicit Inside(std::span<const Ring> rings);
  explicit Inside(const Ring& ring) : Inside(std::span(&ring, 1)) {}

  /// Cost: the sides that begin at most the longest one's height below the point.
  bool holds(exact::Point p) const;

 private:
  struct Side {
    exact::Point low, high;
  };
  std::vector<Side> sides_;  // by the y of `low`
  std::int64_t tallest_ = 0;
  exact::Point min_{}, max_{};
};

/// The ids of the vertices inside, ascending; no more than `most` + 1 of them. Cost: O(n), and as holds() for
/// those in the polygon's box.
std::vector<terrain::VertexId> vertices_within(const terrain::Terrain& terrain, const Ring& ring,
                                               std::size_t most);

}  // namespace tin::query
