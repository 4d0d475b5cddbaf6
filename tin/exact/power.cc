#include "tin/exact/power.h"

#include <algorithm>
#include <functional>
#include <utility>

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

using XY = std::pair<std::int64_t, std::int64_t>;

/// Two roundings at most: of each half, and of the sum. (The compiler's own conversion is a function call.)
double to_double(Uint128 value) {
  return static_cast<double>(static_cast<std::uint64_t>(value >> 64)) * 0x1p64 +
         static_cast<double>(static_cast<std::uint64_t>(value));
}

XY place(const Lifted& q) { return {q.x, q.y}; }

/// Barycentric coefficient of the origin at the corner `q` of the ear, times the ear's orientation; 0 if q is no corner.
std::int64_t coefficient(const Corners& ear, const XY& q) {
  for (std::size_t i = 0; i < 3; ++i) {
    const Lifted &next = ear[(i + 1) % 3], &last = ear[(i + 2) % 3];
    if (place(ear[i]) == q) return next.x * last.y - next.y * last.x;
  }
  return 0;
}

}  // namespace

Power make_power(Int128 in_circle, std::int64_t orientation) {
  TIN_DCHECK(orientation > 0 && in_circle >= 0);
  return {in_circle, orientation, to_double(static_cast<Uint128>(in_circle)) / static_cast<double>(orientation)};
}

Power power(const Corners& ear) {
  return make_power(in_circle_determinant(ear[0], ear[1], ear[2]), orientation(ear[0], ear[1], ear[2]));
}

PowerMinors power_minors(const Lifted& a, const Lifted& b) {
  return {Int128{a.y} * b.z - Int128{a.z} * b.y, Int128{a.z} * b.x - Int128{a.x} * b.z, a.x * b.y - a.y * b.x};
}

Int128 in_circle_determinant(const PowerMinors& minors, const Lifted& c) {
  return minors.x * c.x + minors.y * c.y + Int128{minors.z} * c.z;
}

int compare_exact(const Power& a, const Power& b) {
  const Limbs left = multiply(static_cast<Uint128>(a.in_circle), static_cast<std::uint64_t>(b.orientation));
  const Limbs right = multiply(static_cast<Uint128>(b.in_circle), static_cast<std::uint64_t>(a.orientation));
  return (left > right) - (left < right);
}

int compare_perturbed(const Corners& a, std::int64_t orientation_a, const Corners& b, std::int64_t orientation_b) {
  std::array<XY, 6> descending{place(a[0]), place(a[1]), place(a[2]), place(b[0]), place(b[1]), place(b[2])};
  std::sort(descending.begin(), descending.end(), std::greater<>());
  for (const XY& q : descending) {
    const Int128 left = static_cast<Int128>(coefficient(a, q)) * orientation_b;
    const Int128 right = static_cast<Int128>(coefficient(b, q)) * orientation_a;
    if (left != right) return left > right ? 1 : -1;
  }
  return 0;
}

}  // namespace tin::exact
