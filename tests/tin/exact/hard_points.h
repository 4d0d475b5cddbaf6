// Points that are hard on predicates, and wide integers as GMP's, to judge by.
#pragma once

#include <gmpxx.h>

#include <array>

#include "tests/support/point_sets.h"
#include "tin/exact/predicates.h"

namespace exact_tests {

using support::Random;
using tin::exact::kLatticeHalf;
using tin::exact::Point;

/// Four points, often nearly or exactly co-circular or collinear, at every scale of the lattice.
inline std::array<Point, 4> hard_points(Random& random) {
  std::uniform_int_distribution<std::int32_t> pick(0, 3), wide(-kLatticeHalf, kLatticeHalf - 1), small(-3, 3);
  std::array<Point, 4> p;
  switch (pick(random)) {
    case 0:
      for (Point& q : p) q = {wide(random), wide(random)};
      break;
    case 1:
      for (Point& q : p) q = {small(random), small(random)};
      break;
    case 2: {  // corners of a square at the lattice's limits, nudged
      const std::int32_t h = kLatticeHalf - 4;
      p = {Point{-h, -h}, Point{h, -h}, Point{h, h}, Point{-h, h}};
      for (Point& q : p) q = {q.x + small(random), q.y + small(random)};
      break;
    }
    default:
      for (std::int32_t i = 0; i < 4; ++i) p[static_cast<std::size_t>(i)] = {i * 1000003 + small(random), i * 999983 + small(random)};
  }
  return p;
}

inline mpz_class to_mpz(tin::exact::Int128 value) {
  const bool negative = value < 0;
  const auto magnitude = negative ? -static_cast<tin::exact::Uint128>(value) : static_cast<tin::exact::Uint128>(value);
  mpz_class out = (mpz_class(static_cast<unsigned long>(magnitude >> 64)) << 64) + static_cast<unsigned long>(magnitude);
  return negative ? mpz_class(-out) : out;
}

}  // namespace exact_tests
