// Comparing the powers of a removed point with respect to the circles of two ears (Devillers 2002, section 2.4).
#pragma once

#include <array>
#include <cstdint>

#include "tin/exact/point.h"
#include "tin/exact/predicates.h"

namespace tin::exact {

/// An ear q0 q1 q2 (counter-clockwise) and the power of the removed point p with respect to its circle, as a
/// fraction: |power| = in_circle / orientation, which is how far above the lifted p the ear's plane passes.
struct EarPower {
  std::array<Point, 3> corners;
  Int128 in_circle = 0;         // >= 0: p lies in the circle
  std::int64_t orientation = 0;  // > 0
  double approximate = 0;       // in_circle / orientation, relative error below 2^-50
};

/// Requires: the corners turn counter-clockwise and p lies inside or on their circle.
EarPower ear_power(Point q0, Point q1, Point q2, Point p);

/// Whether the ear `a` comes before `b` in the shelling order seen from `p`: smaller |power|; if equal, smaller
/// *perturbed* |power|, that is smaller barycentric coefficient of p at the largest corner where they differ.
/// Exact: floating-point filter, then 192-bit integers.
bool comes_before(const EarPower& a, const EarPower& b, Point p);

namespace internal {
/// Sign of a.in_circle / a.orientation - b.in_circle / b.orientation, by integers alone.
int compare_exact(const EarPower& a, const EarPower& b);
/// The same with infinitesimals, for equal powers.
int compare_perturbed(const EarPower& a, const EarPower& b, Point p);
}  // namespace internal

}  // namespace tin::exact
