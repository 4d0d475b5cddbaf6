#include "tin/query/flood.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace tin::query {

using delaunay::Location;
using exact::Point;
using mesh::HalfEdge;
using mesh::TriangleSlot;

namespace {

constexpr double kNear = 1.5;  // steps: more than rounding to the lattice moves a corner

/// Whether p lies further than kNear to the right of the line from a to b.
bool far_right(Place a, Place b, Place p) {
  return cross(a, b, p) < -kNear * (std::abs(b.x - a.x) + std::abs(b.y - a.y));
}

bool all_far_right(Place a, Place b, const std::array<Place, 3>& corners) {
  return far_right(a, b, corners[0]) && far_right(a, b, corners[1]) && far_right(a, b, corners[2]);
}

/// False only when the segment and the counter-clockwise triangle are apart.
bool near_segment(Place p, Place q, const std::array<Place, 3>& corners) {
  if (all_far_right(p, q, corners) || all_far_right(q, p, corners)) return false;
  for (std::size_t i = 0; i < 3; ++i) {
    const Place a = corners[i], b = corners[(i + 1) % 3];
    if (far_right(a, b, p) && far_right(a, b, q)) return false;
  }
  const auto apart = [&](auto ordinate) {
    const auto [low, high] = std::minmax({ordinate(corners[0]), ordinate(corners[1]), ordinate(corners[2])});
    return std::max(ordinate(p), ordinate(q)) < low - kNear ||
           std::min(ordinate(p), ordinate(q)) > high + kNear;
  };
  return !apart([](Place c) { return c.x; }) && !apart([](Place c) { return c.y; });
}

/// The nearest lattice point; nothing beyond the lattice, where no hull reaches.
std::optional<Point> nearest(Place p) {
  const double x = std::round(p.x), y = std::round(p.y);
  constexpr double kHalf = exact::kLatticeHalf;
  if (!(x >= -kHalf && x < kHalf && y >= -kHalf && y < kHalf)) return std::nullopt;
  return Point{static_cast<std::int32_t>(x), static_cast<std::int32_t>(y)};
}

}  // namespace

void Flood::push(TriangleSlot t) {
  if (mesh_.is_infinite(t) || seen_[t.value()] == call_) return;
  seen_[t.value()] = call_;
  to_visit_.push_back(t);
}

bool Flood::seed(const Corners& corners) {
  if (++call_ == 0) {
    std::fill(seen_.begin(), seen_.end(), 0);
    call_ = 1;
  }
  to_visit_.clear();
  const auto& triangulation = terrain_.triangulation();
  for (const Place& corner : corners) {
    const auto p = nearest(corner);
    if (!p) continue;
    const Location where =
        last_.value() == mesh::kNone ? triangulation.locate(*p) : triangulation.locate_from(*p, last_);
    last_ = where.triangle;
    if (where.kind != Location::Kind::kOutsideHull) {
      push(where.triangle);
      return true;
    }
    const TriangleSlot outside = where.triangle;
    // Wholly beyond one line of the hull: the usual case of those that do not meet it.
    const HalfEdge edge = mesh_.twin(outside, mesh_.index_of(outside, mesh::kInfinite));
    if (all_far_right(frame::place(mesh_.point(mesh_.origin(edge))),
                      frame::place(mesh_.point(mesh_.destination(edge))), corners)) {
      return false;
    }
  }
  return seed_on_hull(corners);
}

bool Flood::seed_on_hull(const Corners& corners) {
  const TriangleSlot first = mesh_.triangle_at(mesh::kInfinite);
  TriangleSlot t = first;
  do {
    const int infinite = mesh_.index_of(t, mesh::kInfinite);
    const HalfEdge edge = mesh_.twin(t, infinite);
    // Also when the whole hull is in the triangle.
    if (near_segment(frame::place(mesh_.point(mesh_.origin(edge))),
                     frame::place(mesh_.point(mesh_.destination(edge))), corners)) {
      push(edge.triangle());
      return true;
    }
    t = mesh_.twin(t, mesh::next3(infinite)).triangle();
  } while (t != first);
  return false;
}

void Flood::spread(TriangleSlot t, const Corners& corners) {
  for (int i = 0; i < 3; ++i) {
    const HalfEdge edge(t, i);
    const TriangleSlot beyond = mesh_.twin(edge).triangle();
    if (mesh_.is_infinite(beyond) || seen_[beyond.value()] == call_) continue;
    if (near_segment(frame::place(mesh_.point(mesh_.origin(edge))),
                     frame::place(mesh_.point(mesh_.destination(edge))), corners)) {
      push(beyond);
    }
  }
}

}  // namespace tin::query
