// The power of a removed point with respect to the circle of an ear, and the order of two powers (Devillers 2002,
// sections 2.4 and 3). The removed point is the origin of the lifted corners.
//
// A comparison goes through stages, each of which answers or passes on: floating point with an error bound; a product
// of 192 bits, which holds any on the lattice, so that nothing wider is ever needed; the infinitesimals, for equal powers.
#pragma once

#include <array>
#include <cstdint>

#include "tin/exact/lifted.h"

namespace tin::exact {

/// |power| = in_circle / orientation: how far above the lifted removed point the plane of the ear passes.
struct Power {
  Int128 in_circle = 0;          // >= 0: the removed point lies in the circle
  std::int64_t orientation = 0;  // > 0
  double approximate = 0;        // in_circle / orientation, relative error below 2^-50
};

/// The corners of an ear, counter-clockwise.
using Corners = std::array<Lifted, 3>;

/// The part of a power that two corners determine: with it the power for another third corner costs 7 multiplications
/// instead of 15 (section 3.1).
struct PowerMinors {
  Int128 x = 0, y = 0;
  std::int64_t z = 0;
};

Power make_power(Int128 in_circle, std::int64_t orientation);
/// Requires: the corners turn counter-clockwise and their circle holds the origin, or passes through it.
Power power(const Corners& ear);
PowerMinors power_minors(const Lifted& a, const Lifted& b);
/// The in-circle determinant of a, b, c and the origin from the minors of a and b.
Int128 in_circle_determinant(const PowerMinors& minors, const Lifted& c);

/// Stage 1, semi-static: the sign of a - b, 0 when floating point leaves it in doubt.
inline int compare_filtered(double a, double b) {
  // Four roundings of relative size 2^-53 stand behind each quotient: a gap of 2^-49 of the sum is certain.
  const double gap = a - b, doubt = (a + b) * 0x1p-49;
  return (gap > doubt) - (gap < -doubt);
}

/// Stage 2: the sign of a - b.
int compare_exact(const Power& a, const Power& b);

/// Stage 3: the sign of the difference of two *perturbed* powers that are equal without perturbation: the barycentric
/// coefficients of the origin at the largest corner where they differ. 0 only for equal ears.
int compare_perturbed(const Corners& a, std::int64_t orientation_a, const Corners& b, std::int64_t orientation_b);

}  // namespace tin::exact
