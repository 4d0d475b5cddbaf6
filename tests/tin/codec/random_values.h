// Random values for the codec's tests, and the seed they come from.
#pragma once

#include <bit>
#include <cstdint>
#include <cstdlib>
#include <iostream>
#include <limits>
#include <random>
#include <string>

#include "tin/exact/point.h"
#include "tin/terrain/edit.h"

namespace tin::codec::testing {

using Random = std::mt19937_64;

/// From TINSMITH_SEED, or a new one; printed, so that a failure can be had again.
inline std::uint64_t seed() {
  static const std::uint64_t value = [] {
    const char* given = std::getenv("TINSMITH_SEED");
    const std::uint64_t chosen =
        given != nullptr ? std::strtoull(given, nullptr, 10) : std::random_device{}();
    std::cout << "TINSMITH_SEED=" << chosen << std::endl;
    return chosen;
  }();
  return value;
}

/// Uniform in [low, high].
template <class Int>
Int between(Random& random, Int low, Int high) {
  return std::uniform_int_distribution<Int>(low, high)(random);
}

inline bool chance(Random& random, double probability) {
  return std::bernoulli_distribution(probability)(random);
}

/// Any finite double by its bits: subnormal, huge and signed zeros included.
inline double any_finite(Random& random) {
  for (;;) {
    const double value = chance(random, 0.1) ? -0.0 : std::bit_cast<double>(random());
    if (value - value == 0) return value;
  }
}

inline exact::Point any_point(Random& random) {
  const std::int32_t reach = chance(random, 0.5) ? 1000 : exact::kLatticeHalf;
  const auto coordinate = [&] {
    if (chance(random, 0.05)) return chance(random, 0.5) ? -exact::kLatticeHalf : exact::kLatticeHalf - 1;
    return between<std::int32_t>(random, -reach, reach - 1);
  };
  const std::int32_t x = coordinate();
  return {x, coordinate()};
}

inline terrain::Placement any_placement(Random& random) {
  const exact::Point at = any_point(random);
  return {at, any_finite(random)};
}

inline std::string any_text(Random& random) {
  std::string text(between<std::size_t>(random, 0, 40), '\0');
  for (char& c : text) c = static_cast<char>(random());
  return text;
}

/// Changes `flips` random bits of `bytes`.
inline std::string damaged(std::string bytes, int flips, Random& random) {
  for (int i = 0; i < flips; ++i) {
    const auto at = between<std::size_t>(random, 0, bytes.size() - 1);
    bytes[at] = static_cast<char>(bytes[at] ^ (1 << between(random, 0, 7)));
  }
  return bytes;
}

}  // namespace tin::codec::testing
