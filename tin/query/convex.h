// Small convex polygons in the plane, and what a half-plane leaves of them.
#pragma once

#include <array>
#include <cstddef>

#include "tin/frame/ground.h"

namespace tin::query {

using frame::Place;

/// A convex polygon, counter-clockwise, of few corners: a triangle has three, and each cut adds one at most.
struct Convex {
  static constexpr std::size_t kMost = 20;
  std::array<Place, kMost> corners;
  std::size_t size = 0;

  /// Beyond its room a polygon cannot have corners of its own: rounding can make some where it is next to nothing, and those
  /// are left out.
  void add(Place p) {
    if (size < kMost) corners[size++] = p;
  }
  const Place* begin() const { return corners.data(); }
  const Place* end() const { return corners.data() + size; }
  bool empty() const { return size < 3; }
};

inline Convex triangle(Place a, Place b, Place c) {
  Convex out;
  out.add(a);
  out.add(b);
  out.add(c);
  return out;
}

/// Twice the area of the triangle a, b, c, positive counter-clockwise.
inline double cross(Place a, Place b, Place c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

/// The part of `polygon` where `height`, a linear function of the place, is not negative; empty when that has
/// no area.
template <class Height>
Convex clip(const Convex& polygon, const Height& height) {
  Convex out;
  if (polygon.empty()) return out;
  Place last = polygon.corners[polygon.size - 1];
  double last_height = height(last);
  bool inside = false;
  for (const Place& corner : polygon) {
    const double here = height(corner);
    if ((here > 0 && last_height < 0) || (here < 0 && last_height > 0)) {
      const double part = last_height / (last_height - here);
      out.add({last.x + part * (corner.x - last.x), last.y + part * (corner.y - last.y)});
    }
    if (here >= 0) out.add(corner);
    inside = inside || here > 0;
    last = corner;
    last_height = here;
  }
  if (!inside || out.empty()) out.size = 0;
  return out;
}

}  // namespace tin::query
