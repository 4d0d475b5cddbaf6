// Order along the Hilbert curve: points that are near on the curve are near on the ground.
#pragma once

#include <array>
#include <cstdint>

#include "tin/exact/point.h"

namespace tin::delaunay {

namespace internal {

/// One step down four levels of the curve: from the orientation of the cell and four bits of x and of y to the eight bits of
/// the index (low byte) and the orientation of the cell reached (high byte). An orientation is made of two bits: 1, x and y
/// are exchanged; 2, both run backwards.
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

/// Position of `p` along the Hilbert curve over the lattice, below 2^60; different points have different positions.
constexpr std::uint64_t hilbert_index(exact::Point p) {
  const std::uint32_t x = static_cast<std::uint32_t>(p.x + exact::kLatticeHalf);
  const std::uint32_t y = static_cast<std::uint32_t>(p.y + exact::kLatticeHalf);
  std::uint64_t index = 0;
  std::uint32_t orientation = 0;
  for (int shift = 28; shift >= 0; shift -= 4) {
    const std::uint16_t step = internal::kHilbertTable[orientation << 8 | (x >> shift & 15U) << 4 | (y >> shift & 15U)];
    index = index << 8 | (step & 255U);
    orientation = step >> 8;
  }
  return index;
}

}  // namespace tin::delaunay
