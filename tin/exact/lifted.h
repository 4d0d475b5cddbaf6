// Link vertices as the removed point sees them: moved so that it is the origin, and lifted to the paraboloid.
//
// The lifted origin is a vertex of the lower hull, so the link is a convex polygon in its vertex figure,
// whatever it looks like in the plane: for link vertices a, b, c in cyclic order the determinant of
// in_circle_determinant(a, b, c) is positive, also when they turn clockwise. Filling the hole is
// triangulating that convex polygon, and the only question ever asked is on which side of the plane through
// three lifted points a fourth one lies: lifted_sign().
#pragma once

#include <cstdint>

#include "tin/exact/point.h"
#include "tin/exact/predicates.h"

namespace tin::exact {

/// A point relative to an origin, and its squared distance from there: z = x^2 + y^2 < 2^61.
struct Lifted {
  std::int64_t x = 0, y = 0, z = 0;
};

constexpr Lifted lift(Point q, Point origin) {
  const std::int64_t x = std::int64_t{q.x} - origin.x, y = std::int64_t{q.y} - origin.y;
  return {x, y, x * x + y * y};
}

constexpr std::int64_t orientation(const Lifted& a, const Lifted& b, const Lifted& c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

/// The in-circle determinant of a, b, c and the origin.
constexpr Int128 in_circle_determinant(const Lifted& a, const Lifted& b, const Lifted& c) {
  return Int128{a.z} * (b.x * c.y - b.y * c.x) + Int128{b.z} * (c.x * a.y - c.y * a.x) +
         Int128{c.z} * (a.x * b.y - a.y * b.x);
}

/// The in-circle determinant of a, b, c and d. The lifts need not be seen from d: a change of origin adds to
/// the third column multiples of the other two.
constexpr Int128 in_circle_determinant(const Lifted& a, const Lifted& b, const Lifted& c, const Lifted& d) {
  return in_circle_determinant(Lifted{a.x - d.x, a.y - d.y, a.z - d.z},
                               Lifted{b.x - d.x, b.y - d.y, b.z - d.z},
                               Lifted{c.x - d.x, c.y - d.y, c.z - d.z});
}

/// The sign of the perturbed determinant when it is zero without perturbation. First the infinitesimal lifts
/// of predicates.h, for any turn of a, b, c. Four collinear points stay coplanar under them; a second, far
/// smaller motion of the plane, x + i y -> x + i y + i e |x + i y|^2 (x + i y), leaves a cubic along every
/// line, so for four points in order along theirs the sign is always the same.
int tie_sign(const Lifted& a, const Lifted& b, const Lifted& c, const Lifted& d);

/// 1 if d lies below the plane through the lifted and perturbed a, b, c when these turn counter-clockwise,
/// that is in their circle; alternating in all four arguments, never 0. Requires: distinct points.
inline int lifted_sign(const Lifted& a, const Lifted& b, const Lifted& c, const Lifted& d) {
  const Int128 determinant = in_circle_determinant(a, b, c, d);
  if (determinant != 0) [[likely]] return determinant > 0 ? 1 : -1;
  return tie_sign(a, b, c, d);
}

}  // namespace tin::exact
