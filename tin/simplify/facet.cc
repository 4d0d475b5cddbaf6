#include "tin/simplify/facet.h"

#include <gmpxx.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

namespace tin::simplify {

using exact::Int128;

Int128 floor_product(double value, int shift, std::int64_t area) {
  constexpr Int128 kMost = Int128{1} << 120;
  int exponent = 0;
  const auto mantissa = static_cast<std::int64_t>(std::ldexp(std::frexp(value, &exponent), 53));
  const Int128 product = Int128{mantissa} * area;  // < 2^115
  const int left = exponent - 53 + shift;
  if (left < 0) return left <= -120 ? Int128{0} : product >> -left;
  if (product == 0) return 0;
  return left >= 120 || product > (kMost >> left) ? kMost : product << left;
}

Facet::Facet(Corner a, Corner b, Corner c)
    : a_(a), b_(b), c_(c), area_(exact::orientation(a.at, b.at, c.at)) {
  if (area_ < 0) {
    std::swap(b_, c_);
    area_ = -area_;
  }
  rounded_area_ = static_cast<double>(area_);
}

Facet::Verdict Facet::judge_exactly(Weights w, double z, double tolerance) const {
  const auto verdict = judge_by_integers(w, z, tolerance);
  return verdict ? *verdict : judge_by_rationals(w, z, tolerance);
}

/// Heights that are whole multiples of 2^-10 below 2^39, as those of most rasters are; nothing for others.
std::optional<Facet::Verdict> Facet::judge_by_integers(Weights w, double z, double tolerance) const {
  constexpr int kShift = 10;
  std::array<std::int64_t, 4> whole{};
  const std::array<double, 4> heights{a_.z, b_.z, c_.z, z};
  for (std::size_t i = 0; i < 4; ++i) {
    const double scaled = heights[i] * (1 << kShift);
    if (!(std::abs(scaled) < 0x1p+49) || scaled != std::trunc(scaled)) return std::nullopt;
    whole[i] = static_cast<std::int64_t>(scaled);
  }
  const Int128 distance = Int128{w.b} * (whole[1] - whole[0]) + Int128{w.c} * (whole[2] - whole[0]) -
                          Int128{area_} * (whole[3] - whole[0]);  // < 2^114
  const Int128 size = distance < 0 ? -distance : distance;
  const bool within = size <= floor_product(tolerance, kShift, area_);
  const double error = static_cast<double>(size) / rounded_area_ / (1 << kShift);
  return Verdict{within ? std::min(error, tolerance) : error, within};
}

Facet::Verdict Facet::judge_by_rationals(Weights w, double z, double tolerance) const {
  const mpq_class base(a_.z), area(mpz_class(static_cast<long>(area_)));
  const mpq_class weight_b(mpz_class(static_cast<long>(w.b))), weight_c(mpz_class(static_cast<long>(w.c)));
  const mpq_class rise = (mpq_class(b_.z) - base) * weight_b + (mpq_class(c_.z) - base) * weight_c;
  const mpq_class error = abs(rise / area + base - mpq_class(z));
  const bool within = error <= mpq_class(tolerance);
  const double most = within ? tolerance : std::numeric_limits<double>::max();
  return {error > mpq_class(most) ? most : std::min(error.get_d(), most), within};
}

}  // namespace tin::simplify
