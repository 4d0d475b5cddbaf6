// Positions on the lattice: the only coordinates that geometric decisions see.
#pragma once

#include <compare>
#include <cstdint>

namespace tin::exact {

/// Lattice coordinates lie in [-kLatticeHalf, kLatticeHalf), so that differences fit 31 bits with sign,
/// an orientation fits int64 and an in-circle determinant fits 128 bits.
inline constexpr std::int32_t kLatticeHalf = std::int32_t{1} << 29;

/// A lattice point; ordered by x, then y.
struct Point {
  std::int32_t x = 0;
  std::int32_t y = 0;
  friend constexpr auto operator<=>(const Point&, const Point&) = default;
};

/// Whether both coordinates lie on the lattice. Wider integers, so that callers can ask before narrowing.
constexpr bool in_lattice(std::int64_t x, std::int64_t y) {
  return x >= -kLatticeHalf && x < kLatticeHalf && y >= -kLatticeHalf && y < kLatticeHalf;
}

}  // namespace tin::exact
