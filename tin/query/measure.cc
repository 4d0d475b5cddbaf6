#include "tin/query/measure.h"

#include <cmath>

namespace tin::query {

FixedSum::FixedSum(double bound) {
  int exponent = 0;
  std::frexp(bound, &exponent);
  exponent_ = exponent - 100;
}

void FixedSum::add(double term) {
  if (term == 0) return;
  // The mantissa as an integer, shifted to the quantum.
  int exponent = 0;
  const auto mantissa = static_cast<std::int64_t>(std::ldexp(std::frexp(term, &exponent), 53));
  const int shift = exponent - 53 - exponent_;
  if (shift >= 0) {
    quanta_ += exact::Int128{mantissa} * (exact::Int128{1} << shift);
  } else if (shift > -63) {
    quanta_ += mantissa / (std::int64_t{1} << -shift);
  }
}

double FixedSum::value() const {
  return static_cast<double>(std::ldexp(static_cast<long double>(quanta_), exponent_));
}

}  // namespace tin::query
