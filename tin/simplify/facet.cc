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

namespace {

/// Heights that are whole multiples of 2^-10 below 2^39, as those of most rasters are; nothing for others.
std::optional<Verdict> judge_by_integers(const Terms& terms, std::int64_t area, double tolerance) {
  constexpr int kShift = 10;
  const auto whole = [](double z) -> std::optional<std::int64_t> {
    const double scaled = z * (1 << kShift);
    if (!(std::abs(scaled) < 0x1p+49) || scaled != std::trunc(scaled)) return std::nullopt;
    return static_cast<std::int64_t>(scaled);
  };
  Int128 distance = 0;  // < 2^114
  for (const Term& term : terms) {
    const auto plus = whole(term.plus), minus = whole(term.minus);
    if (!plus || !minus) return std::nullopt;
    distance += Int128{term.weight} * (*plus - *minus);
  }
  const Int128 size = distance < 0 ? -distance : distance;
  const bool within = size <= floor_product(tolerance, kShift, area);
  const double error = static_cast<double>(size) / static_cast<double>(area) / (1 << kShift);
  return Verdict{within ? std::min(error, tolerance) : error, within};
}

Verdict judge_by_rationals(const Terms& terms, std::int64_t area, double tolerance) {
  mpq_class sum;
  for (const Term& term : terms) {
    const mpq_class weight(mpz_class(static_cast<long>(term.weight)));
    sum += weight * (mpq_class(term.plus) - mpq_class(term.minus));
  }
  const mpq_class error = abs(sum) / mpq_class(mpz_class(static_cast<long>(area)));
  const bool within = error <= mpq_class(tolerance);
  const double most = within ? tolerance : std::numeric_limits<double>::max();
  return {error > mpq_class(most) ? most : std::min(error.get_d(), most), within};
}

}  // namespace

Verdict judge_exactly(const Terms& terms, std::int64_t area, double tolerance) {
  const auto verdict = judge_by_integers(terms, area, tolerance);
  return verdict ? *verdict : judge_by_rationals(terms, area, tolerance);
}

Facet::Facet(Corner a, Corner b, Corner c)
    : a_(a), b_(b), c_(c), area_(exact::orientation(a.at, b.at, c.at)) {
  if (area_ >= 0) return;
  std::swap(b_, c_);
  area_ = -area_;
}

}  // namespace tin::simplify
