#include "tin/exact/power.h"

#include <algorithm>

#include "tin/base/check.h"

namespace tin::exact {
namespace {

/// An unsigned product of up to 192 bits, most significant limb first.
using Limbs = std::array<std::uint64_t, 3>;

Limbs multiply(Uint128 a, std::uint64_t b) {
  const Uint128 low = static_cast<Uint128>(static_cast<std::uint64_t>(a)) * b;
  const Uint128 high = static_cast<Uint128>(static_cast<std::uint64_t>(a >> 64)) * b + (low >> 64);
  return {static_cast<std::uint64_t>(high >> 64), static_cast<std::uint64_t>(high), static_cast<std::uint64_t>(low)};
}

int sign(Int128 value) { return (value > 0) - (value < 0); }

/// Barycentric coefficient of p at the corner `q` of the ear, times the ear's orientation; 0 if q is no corner.
std::int64_t coefficient(const EarPower& ear, Point q, Point p) {
  const auto& [a, b, c] = ear.corners;
  if (q == a) return orientation(p, b, c);
  if (q == b) return orientation(a, p, c);
  if (q == c) return orientation(a, b, p);
  return 0;
}

}  // namespace

EarPower ear_power(Point q0, Point q1, Point q2, Point p) {
  EarPower ear{{q0, q1, q2}, in_circle_determinant(q0, q1, q2, p), orientation(q0, q1, q2), 0};
  TIN_DCHECK(ear.orientation > 0 && ear.in_circle >= 0);
  ear.approximate = static_cast<double>(ear.in_circle) / static_cast<double>(ear.orientation);
  return ear;
}

namespace internal {

int compare_exact(const EarPower& a, const EarPower& b) {
  const Limbs left = multiply(static_cast<Uint128>(a.in_circle), static_cast<std::uint64_t>(b.orientation));
  const Limbs right = multiply(static_cast<Uint128>(b.in_circle), static_cast<std::uint64_t>(a.orientation));
  return (left > right) - (left < right);
}

int compare_perturbed(const EarPower& a, const EarPower& b, Point p) {
  std::array<Point, 6> corners{a.corners[0], a.corners[1], a.corners[2], b.corners[0], b.corners[1], b.corners[2]};
  std::sort(corners.begin(), corners.end(), [](Point l, Point r) { return r < l; });
  for (const Point q : corners) {
    const Int128 left = static_cast<Int128>(coefficient(a, q, p)) * b.orientation;
    const Int128 right = static_cast<Int128>(coefficient(b, q, p)) * a.orientation;
    if (left != right) return sign(left - right);
  }
  return 0;
}

}  // namespace internal

bool comes_before(const EarPower& a, const EarPower& b, Point p) {
  // Three roundings of relative size 2^-53 stand behind each quotient: a gap of 2^-49 of the sum is certain.
  const double gap = a.approximate - b.approximate;
  const double doubt = (a.approximate + b.approximate) * 0x1p-49;
  if (gap < -doubt) return true;
  if (gap > doubt) return false;
  const int exact = internal::compare_exact(a, b);
  if (exact != 0) return exact < 0;
  return internal::compare_perturbed(a, b, p) < 0;
}

}  // namespace tin::exact
