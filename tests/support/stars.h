// Rings of points that are all linked to the origin, as far as the lattice allows: stars of a given degree.
#pragma once

#include <cstddef>
#include <string_view>
#include <vector>

#include "tests/support/point_sets.h"

namespace support {

enum class StarShape {
  kAlternating,  // K: the paper's figure 5, every second radius is 1, the others random between 1 and 1 + O(1 / k^2)
  kRandom,       // R: all radii random in such a range
  kEllipse,      // E: the inverse of an ellipse, where no two circles are nearly the same
};

enum class StarCentre { kInside, kOnHull };

inline constexpr StarShape kStarShapes[] = {StarShape::kAlternating, StarShape::kRandom, StarShape::kEllipse};

constexpr std::string_view name(StarShape shape) {
  if (shape == StarShape::kAlternating) return "K";
  return shape == StarShape::kRandom ? "R" : "E";
}

/// `degree` points around the origin, or on one side of it (y >= 0) when it is to lie on the hull; in angular order. Rounding
/// to the lattice leaves all linked up to degree 10,000. Requires: degree >= 3.
std::vector<tin::exact::Point> star_ring(StarShape shape, StarCentre centre, std::size_t degree, Random& random);

}  // namespace support
