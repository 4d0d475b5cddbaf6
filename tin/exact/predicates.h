// Exact geometric predicates on lattice points: orientation, in-circle, and the rule that breaks ties.
//
// Coordinates differ by less than 2^30, so an orientation is below 2^61 and fits int64, and an in-circle
// determinant is below 2^124 and fits 128 bits: there is nothing to round, and no filter to fail on grids,
// where determinants are zero by nature.
//
// Ties: lift each point p to x^2 + y^2 + e(p), with infinitesimals e(p) > 0 such that of two points the one
// that is larger by (x, y) has an e that dominates every multiple of the other's. No four points lie on one
// circle any more, so the Delaunay triangulation is unique. It depends on coordinates only: neither on
// names nor on the order of insertion. (The rule of CGAL's 2D Delaunay triangulation.)
#pragma once

#include <cstdint>

#include "tin/exact/point.h"

namespace tin::exact {

__extension__ using Int128 = __int128;
__extension__ using Uint128 = unsigned __int128;

/// Twice the signed area of the triangle a, b, c: positive when they turn counter-clockwise.
constexpr std::int64_t orientation(Point a, Point b, Point c) {
  const std::int64_t bx = std::int64_t{b.x} - a.x, by = std::int64_t{b.y} - a.y;
  const std::int64_t cx = std::int64_t{c.x} - a.x, cy = std::int64_t{c.y} - a.y;
  return bx * cy - by * cx;
}

/// The in-circle determinant: positive when `p` lies inside the circle of the counter-clockwise a, b, c, zero
/// on it. Divided by orientation(a, b, c) it is minus the power of `p` with respect to the circle.
constexpr Int128 in_circle_determinant(Point a, Point b, Point c, Point p) {
  const std::int64_t ax = std::int64_t{a.x} - p.x, ay = std::int64_t{a.y} - p.y;
  const std::int64_t bx = std::int64_t{b.x} - p.x, by = std::int64_t{b.y} - p.y;
  const std::int64_t cx = std::int64_t{c.x} - p.x, cy = std::int64_t{c.y} - p.y;
  return Int128{ax * ax + ay * ay} * (bx * cy - by * cx) + Int128{bx * bx + by * by} * (cx * ay - cy * ax) +
         Int128{cx * cx + cy * cy} * (ax * by - ay * bx);
}

/// The tie rule: whether `p`, on the circle of the counter-clockwise a, b, c and distinct from them, counts
/// as inside. The coefficient of e(q) in the perturbed determinant is, but for a positive factor, the
/// orientation in which `p` takes the place of q; that of e(p) is negative. The largest point with a
/// coefficient decides.
bool tie_is_inside(Point a, Point b, Point c, Point p);

/// Whether `p` lies inside the perturbed circle of the counter-clockwise a, b, c. Requires: distinct points.
inline bool in_circle(Point a, Point b, Point c, Point p) {
  const Int128 determinant = in_circle_determinant(a, b, c, p);
  if (determinant != 0) return determinant > 0;
  return tie_is_inside(a, b, c, p);
}

}  // namespace tin::exact
