// Order along the Hilbert curve: points that are near on the curve are near on the ground.
#pragma once

#include <cstdint>

#include "tin/exact/point.h"

namespace tin::delaunay {

/// Position of `p` along the Hilbert curve of order 30 over the lattice.
constexpr std::uint64_t hilbert_index(exact::Point p) {
  std::uint32_t x = static_cast<std::uint32_t>(p.x + exact::kLatticeHalf);
  std::uint32_t y = static_cast<std::uint32_t>(p.y + exact::kLatticeHalf);
  std::uint64_t index = 0;
  for (int level = 29; level >= 0; --level) {
    const std::uint32_t rx = x >> level & 1U, ry = y >> level & 1U;
    index = index << 2 | ((3 * rx) ^ ry);
    if (ry != 0) continue;
    if (rx != 0) {
      x = ~x;
      y = ~y;
    }
    const std::uint32_t swap = x;
    x = y;
    y = swap;
  }
  return index;
}

}  // namespace tin::delaunay
