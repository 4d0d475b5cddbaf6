// Order along the Hilbert curve: points that are near on the curve are near on the ground.
#pragma once

#include <array>
#include <bit>
#include <cstdint>

#include "tin/exact/point.h"

namespace tin::delaunay {

namespace internal {

/// One step down four levels of the curve: from the orientation of the cell and four bits of x and of y to
/// the eight bits of the index (low byte) and the orientation of the cell reached (high byte). An orientation
/// is made of two bits: 1, x and y are exchanged; 2, both run backwards.
constexpr std::uint16_t hilbert_step(std::uint32_t orientation, std::uint32_t x, std::uint32_t y) {
  std::uint32_t index = 0;
  for (int level = 3; level >= 0; --level) {
    const std::uint32_t flip = orientation >> 1;
    std::uint32_t rx = (x >> level & 1U) ^ flip, ry = (y >> level & 1U) ^ flip;
    if ((orientation & 1U) != 0) {
      const std::uint32_t kept = rx;
      rx = ry;
      ry = kept;
    }
    index = index << 2 | ((3 * rx) ^ ry);
    if (ry == 0) orientation ^= rx << 1 | 1U;
  }
  return static_cast<std::uint16_t>(orientation << 8 | index);
}

constexpr auto make_hilbert_table() {
  std::array<std::uint16_t, 1024> table{};
  for (std::uint32_t i = 0; i < table.size(); ++i) table[i] = hilbert_step(i >> 8, i >> 4 & 15U, i & 15U);
  return table;
}

inline constexpr auto kHilbertTable = make_hilbert_table();

}  // namespace internal

/// The curve through a square that holds given points, no larger than it must be: the fewer its bits, the
/// more of them fit a sort key.
class HilbertCurve {
 public:
  /// Through all points of [low, high]. Requires: low <= high in both coordinates.
  constexpr HilbertCurve(exact::Point low, exact::Point high) : low_(low) {
    const auto width = static_cast<std::uint32_t>(high.x - low.x),
               height = static_cast<std::uint32_t>(high.y - low.y);
    bits_ = static_cast<int>(std::bit_width(width | height));
  }

  /// Bits of an index: 60 at most.
  constexpr int index_bits() const { return 2 * bits_; }

  /// Position of `p` along the curve; different points have different positions.
  constexpr std::uint64_t index(exact::Point p) const {
    const auto x = static_cast<std::uint32_t>(p.x - low_.x), y = static_cast<std::uint32_t>(p.y - low_.y);
    std::uint64_t index = 0;
    std::uint32_t orientation = 0;
    for (int shift = (bits_ - 1) & ~3; shift >= 0; shift -= 4) {
      const std::uint16_t step =
          internal::kHilbertTable[orientation << 8 | (x >> shift & 15U) << 4 | (y >> shift & 15U)];
      index = index << 8 | (step & 255U);
      orientation = step >> 8;
    }
    return index;
  }

 private:
  exact::Point low_;
  int bits_ = 0;  // of the square's side
};

}  // namespace tin::delaunay
