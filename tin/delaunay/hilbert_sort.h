// Sorting points along the Hilbert curve: a radix sort from the top digit down, on one or more threads.
#pragma once

#include <cstdint>
#include <span>

#include "tin/exact/point.h"
#include "tin/mesh/page_allocator.h"

namespace tin::delaunay {

struct OnCurve {
  std::uint64_t position;
  std::uint32_t index;  // of the point in the input
};

/// `points` by ascending position; equal points by ascending index. The same for any number of threads.
mesh::PageVector<OnCurve> hilbert_sorted(std::span<const exact::Point> points, unsigned threads = 1);

}  // namespace tin::delaunay
