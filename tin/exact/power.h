// The power of a removed point with respect to the circle of an ear, and the order of two powers (Devillers
// 2002, sections 2.4 and 3). The removed point is the origin of the lifted corners.
//
// A comparison goes through stages, each of which answers or passes on: floating point with an error bound;
// products of 128 bits, where they fit; GMP, for any; the infinitesimals, for equal powers.
//
// There is no static filter in front (a bound that is absolute and known when compiling). The cross products
// reach 2^187, so their doubles may be wrong by 2^137, and a difference as large as that needs stars of some
// seven million lattice steps, seven kilometres at the usual 1 mm. The semi-static bound costs one
// multiplication and answers at every scale.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

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

/// The part of a power that two corners determine: with it the power for another third corner costs 7
/// multiplications instead of 15 (section 3.1).
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

/// Stage 2: the sign of a - b by products of 128 bits; nothing when these could overflow.
std::optional<int> compare_in_128_bits(const Power& a, const Power& b);

/// Stage 3: the sign of a - b by GMP.
int compare_by_gmp(const Power& a, const Power& b);

/// Stage 4: the sign of the difference of two *perturbed* powers that are equal without perturbation: the
/// barycentric coefficients of the origin at the largest corner where they differ. 0 only for equal ears.
int compare_perturbed(const Corners& a, std::int64_t orientation_a, const Corners& b,
                      std::int64_t orientation_b);

}  // namespace tin::exact
