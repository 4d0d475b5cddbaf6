// The part of the plane that a question is about: everything, or a polygon with holes.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "tin/base/result.h"
#include "tin/exact/point.h"

namespace tin::query {

using Ring = std::vector<exact::Point>;

/// A simple polygon with holes on the lattice, cut into triangles.
class Region {
 public:
  /// From rings without a repeated last position (one that repeats the first is dropped), in any orientation;
  /// the first is the outline, the others are holes in it. Errors, with `where` "/ring" or "/ring/position":
  /// kInvalidValue when a ring has no area, crosses or touches itself or another, or a hole is not inside the
  /// outline. Cost: O(n^2) simple tests.
  static base::Result<Region> make(std::span<const Ring> rings);

  using Triangle = std::array<exact::Point, 3>;  // counter-clockwise
  std::span<const Triangle> outline() const { return outline_; }
  /// Triangles of the holes, to be taken away from those of the outline.
  std::span<const Triangle> holes() const { return holes_; }

 private:
  std::vector<Triangle> outline_, holes_;
};

}  // namespace tin::query
