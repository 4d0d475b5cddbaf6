#include <gmpxx.h>

#include "tests/support/oracle.h"

namespace support {
namespace {

using tin::exact::Point;

/// Determinant of the rows (x, y, lift, 1) with the lifts given apart, by cofactors.
struct Lifted {
  mpz_class x, y;
};

mpz_class area(const Lifted& a, const Lifted& b, const Lifted& c) { return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x); }

Lifted lift(Point p) { return {mpz_class(p.x), mpz_class(p.y)}; }

/// Whether d lies above the plane through a, b, c (counter-clockwise) once lifted and perturbed.
bool is_above(Point a, Point b, Point c, Point d) {
  const std::array<Point, 4> p{a, b, c, d};
  std::array<Lifted, 4> l;
  for (std::size_t i = 0; i < 4; ++i) l[i] = lift(p[i]);
  // Height of d above the plane times area(a, b, c): sum of lift_i * weight_i.
  const std::array<mpz_class, 4> weight{-area(l[3], l[1], l[2]), -area(l[0], l[3], l[2]), -area(l[0], l[1], l[3]),
                                        area(l[0], l[1], l[2])};
  mpz_class height = 0;
  for (std::size_t i = 0; i < 4; ++i) height += (l[i].x * l[i].x + l[i].y * l[i].y) * weight[i];
  if (height != 0) return height > 0;
  std::array<std::size_t, 4> order{0, 1, 2, 3};
  std::sort(order.begin(), order.end(), [&p](std::size_t i, std::size_t j) { return p[j] < p[i]; });
  for (const std::size_t i : order) {
    if (weight[i] != 0) return weight[i] > 0;
  }
  return true;
}

}  // namespace

std::vector<Corners> brute_force_delaunay(std::span<const Point> points) {
  std::vector<Corners> out;
  for (const Point a : points) {
    for (const Point b : points) {
      for (const Point c : points) {
        if (!(a < b && a < c) || area(lift(a), lift(b), lift(c)) <= 0) continue;
        const auto holds = [&](Point d) { return d != a && d != b && d != c && !is_above(a, b, c, d); };
        if (std::none_of(points.begin(), points.end(), holds)) out.push_back({a, b, c});
      }
    }
  }
  std::sort(out.begin(), out.end());
  return out;
}

}  // namespace support
