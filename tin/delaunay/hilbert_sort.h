// Sorting points along the Hilbert curve: a radix sort from the top digit down, on one or more threads.
#pragma once

#include <cstdint>
#include <span>

#include "tin/exact/point.h"
#include "tin/mesh/page_allocator.h"

namespace tin::delaunay {

struct OnCurve {
  std::uint32_t key;    // the top 32 bits of the position on the curve through all of the points
  std::uint32_t index;  // of the point in the input
};

/// `points` along the curve; equal points by ascending index. The same for any number of threads.
/// Cost: O(n); 16 bytes per point while it works.
mesh::PageVector<OnCurve> hilbert_sorted(std::span<const exact::Point> points, unsigned threads = 1);

}  // namespace tin::delaunay
