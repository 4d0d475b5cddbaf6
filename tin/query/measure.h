// Areas on the ground, and integrals over them.
#pragma once

#include <cstdint>

#include "tin/exact/predicates.h"
#include "tin/frame/ground.h"
#include "tin/query/convex.h"

namespace tin::query {

/// A sum that does not depend on the order of its terms: each is rounded to a whole number of quanta, 2^-100
/// of a bound, and those are added as integers.
class FixedSum {
 public:
  /// Requires: `bound` finite, and no partial sum larger.
  explicit FixedSum(double bound);
  void add(double term);
  double value() const;

 private:
  int exponent_ = 0;  // of the quantum
  exact::Int128 quanta_ = 0;
};

/// Square metres, and a function's integral over them.
struct Integral {
  double area = 0;
  double value = 0;
};

/// Integrates `f`, a linear function of the place, over a polygon: exactly (but for rounding) on a map plane.
/// On the ellipsoid, where the size of a square degree changes with latitude, by a rule of degree 5 in each
/// triangle: the relative error stays below 1e-10 for pieces of up to one degree.
template <class F>
Integral integrate(const frame::Ground& ground, const Convex& polygon, const F& f);

/// The rule for one triangle: places as weights of its corners, and their parts of its area (Radon's seven
/// points).
struct QuadratureNode {
  double a, b, c, weight;
};
inline constexpr QuadratureNode kQuadrature[] = {
    {1.0 / 3, 1.0 / 3, 1.0 / 3, 0.225},
    {0.059715871789770, 0.470142064105115, 0.470142064105115, 0.132394152788506},
    {0.470142064105115, 0.059715871789770, 0.470142064105115, 0.132394152788506},
    {0.470142064105115, 0.470142064105115, 0.059715871789770, 0.132394152788506},
    {0.797426985353087, 0.101286507323456, 0.101286507323456, 0.125939180544827},
    {0.101286507323456, 0.797426985353087, 0.101286507323456, 0.125939180544827},
    {0.101286507323456, 0.101286507323456, 0.797426985353087, 0.125939180544827},
};

template <class F>
Integral integrate_triangle(const frame::Ground& ground, Place a, Place b, Place c, const F& f) {
  const double steps = cross(a, b, c) / 2;
  if (!ground.geographic()) {
    const double area = steps * ground.area_at(0);
    return {area, area * ((f(a) + f(b) + f(c)) / 3)};
  }
  Integral sum;
  for (const QuadratureNode& n : kQuadrature) {
    const Place p{n.a * a.x + n.b * b.x + n.c * c.x, n.a * a.y + n.b * b.y + n.c * c.y};
    const double area = n.weight * steps * ground.area_at(p.y);
    sum.area += area;
    sum.value += area * f(p);
  }
  return sum;
}

template <class F>
Integral integrate(const frame::Ground& ground, const Convex& polygon, const F& f) {
  Integral sum;
  for (std::size_t i = 2; i < polygon.size; ++i) {
    const Integral part =
        integrate_triangle(ground, polygon.corners[0], polygon.corners[i - 1], polygon.corners[i], f);
    sum.area += part.area;
    sum.value += part.value;
  }
  return sum;
}

}  // namespace tin::query
