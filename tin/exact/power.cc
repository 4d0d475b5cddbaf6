#include "tin/exact/power.h"

#include <gmp.h>

#include <algorithm>
#include <bit>
#include <functional>
#include <utility>

#include "tin/base/check.h"

namespace tin::exact {
namespace {

int width(Uint128 value) {
  const auto high = static_cast<std::uint64_t>(value >> 64);
  return high != 0 ? 64 + std::bit_width(high) : std::bit_width(static_cast<std::uint64_t>(value));
}

bool fits_128_bits(Int128 a, std::int64_t b) {
  return width(static_cast<Uint128>(a)) + width(static_cast<Uint128>(b)) <= 128;
}

/// A product of an in-circle determinant and an orientation, both >= 0, least significant limb first.
using Limbs = std::array<mp_limb_t, 3>;
static_assert(sizeof(mp_limb_t) == sizeof(std::uint64_t));

Limbs multiply(Int128 a, std::int64_t b) {
  const auto wide = static_cast<Uint128>(a);
  const std::array<mp_limb_t, 2> factor{static_cast<mp_limb_t>(wide), static_cast<mp_limb_t>(wide >> 64)};
  Limbs product;
  product[2] = mpn_mul_1(product.data(), factor.data(), 2, static_cast<mp_limb_t>(b));
  return product;
}

using XY = std::pair<std::int64_t, std::int64_t>;

/// Two roundings at most: of each half, and of the sum. (The compiler's own conversion is a function call.)
double to_double(Uint128 value) {
  return static_cast<double>(static_cast<std::uint64_t>(value >> 64)) * 0x1p64 +
         static_cast<double>(static_cast<std::uint64_t>(value));
}

XY place(const Lifted& q) { return {q.x, q.y}; }

/// Barycentric coefficient of the origin at the corner `q` of the ear, times the ear's orientation; 0 if q is
/// no corner.
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
  return {in_circle, orientation,
          to_double(static_cast<Uint128>(in_circle)) / static_cast<double>(orientation)};
}

Power power(const Corners& ear) {
  return make_power(in_circle_determinant(ear[0], ear[1], ear[2]), orientation(ear[0], ear[1], ear[2]));
}

PowerMinors power_minors(const Lifted& a, const Lifted& b) {
  return {Int128{a.y} * b.z - Int128{a.z} * b.y, Int128{a.z} * b.x - Int128{a.x} * b.z,
          a.x * b.y - a.y * b.x};
}

Int128 in_circle_determinant(const PowerMinors& minors, const Lifted& c) {
  return minors.x * c.x + minors.y * c.y + Int128{minors.z} * c.z;
}

std::optional<int> compare_in_128_bits(const Power& a, const Power& b) {
  if (!fits_128_bits(a.in_circle, b.orientation) || !fits_128_bits(b.in_circle, a.orientation))
    return std::nullopt;
  const Uint128 left = static_cast<Uint128>(a.in_circle) * static_cast<Uint128>(b.orientation);
  const Uint128 right = static_cast<Uint128>(b.in_circle) * static_cast<Uint128>(a.orientation);
  return (left > right) - (left < right);
}

int compare_by_gmp(const Power& a, const Power& b) {
  const Limbs left = multiply(a.in_circle, b.orientation), right = multiply(b.in_circle, a.orientation);
  const int sign = mpn_cmp(left.data(), right.data(), left.size());
  return (sign > 0) - (sign < 0);
}

int compare_perturbed(const Corners& a, std::int64_t orientation_a, const Corners& b,
                      std::int64_t orientation_b) {
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
