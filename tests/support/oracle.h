// The canonical Delaunay triangulation from scratch: once by trying all triples (tiny sets), once by CGAL.
#pragma once

#include <span>
#include <vector>

#include "tests/support/mesh_view.h"

namespace support {

/// Every triple whose perturbed circle holds no other point, decided with rational arithmetic and explicit
/// infinitesimals. O(n^4): for a few dozen points.
std::vector<Corners> brute_force_delaunay(std::span<const tin::exact::Point> points);

/// CGAL's Delaunay_triangulation_2 of the points. Empty when they are all collinear.
std::vector<Corners> cgal_delaunay(std::span<const tin::exact::Point> points);

}  // namespace support
