// Location: what the stop of a walk means, and many walks at a time.
#include <algorithm>
#include <array>

#include "tin/delaunay/triangulation.h"

namespace tin::delaunay {

using exact::Point;
using mesh::kNone;
using mesh::next3;
using mesh::prev3;
using mesh::TriangleSlot;
using mesh::VertexSlot;

namespace {

Location location_of(const Stop& stop) {
  if (stop.kind == Stop::Kind::kOutside)
    return {Location::Kind::kOutsideHull, stop.triangle, stop.apex, VertexSlot(kNone)};
  if (stop.cb != 0 && stop.ba != 0 && stop.ac != 0) {
    return {Location::Kind::kInTriangle, stop.triangle, -1, VertexSlot(kNone)};
  }
  if (VertexSlot v; at_vertex(stop, v)) {
    const int index = v == stop.c.vertex   ? stop.apex
                      : v == stop.b.vertex ? next3(stop.apex)
                                           : prev3(stop.apex);
    return {Location::Kind::kOnVertex, stop.triangle, index, v};
  }
  const int opposite = stop.ba == 0 ? stop.apex : stop.cb == 0 ? prev3(stop.apex) : next3(stop.apex);
  return {Location::Kind::kOnEdge, stop.triangle, opposite, VertexSlot(kNone)};
}

}  // namespace

Location Triangulation::locate(Point p, std::uint64_t* steps) const {
  std::uint64_t counted = 0;
  if (mesh().dimension() == 2) {
    const Location where = location_of(find(p, counted));
    if (steps != nullptr) *steps += counted;
    return where;
  }
  const auto line = mesh().line();
  const auto at = std::lower_bound(line.begin(), line.end(), p,
                                   [this](VertexSlot v, Point q) { return mesh().point(v) < q; });
  if (at != line.end() && mesh().point(*at) == p)
    return {Location::Kind::kOnVertex, TriangleSlot(kNone), -1, *at};
  return {};
}

Location Triangulation::locate_from(Point p, TriangleSlot hint) const {
  return location_of(walk(mesh(), p, finite_start(mesh(), hint), Everywhere{}));
}

/// Many walks abreast: each step of the way is taken for all of a group before the next, so that what it asks
/// of memory has arrived when its turn comes. (A walk that kept its own state of progress would be as quick
/// to wait, but each look at that state is a branch that nobody can foresee.)
class ManyWalks {
 public:
  ManyWalks(const Triangulation& triangulation, std::span<const Point> points,
            std::vector<Location>& locations)
      : triangulation_(triangulation),
        grid_(triangulation.grid_),
        mesh_(triangulation.mesh()),
        points_(points),
        locations_(locations) {
    if (points.size() >= kWorthSorting) order_ = hilbert_sorted(points);
  }

  void run() {
    for (std::size_t first = 0; first < points_.size(); first += kAbreast) {
      const std::size_t size = std::min(kAbreast, points_.size() - first);
      find_hints(first, size);
      for (std::size_t active = set_out(size); active > 0;) active = go_on(active);
    }
  }

 private:
  static constexpr std::size_t kAbreast = 64;
  static constexpr std::size_t kWorthSorting = 4096;
  struct Query {
    std::size_t index;
    Point goal;
    TriangleSlot hint;
  };
  struct Walk {
    std::size_t index;
    Point goal;
    Stop at;
  };

  bool is_there(TriangleSlot t) const { return t.value() < mesh_.triangle_slots(); }

  void find_hints(std::size_t first, std::size_t size) {
    const auto queries = std::span(queries_).first(size);
    for (std::size_t i = 0; i < size; ++i) {
      const std::size_t index = order_.empty() ? first + i : order_[first + i].index;
      queries[i] = {index, points_[index], TriangleSlot(kNone)};
      grid_.prefetch_cell(points_[index]);
    }
    for (Query& q : queries) {
      q.hint = grid_.hint(q.goal);
      if (is_there(q.hint)) mesh_.prefetch(q.hint);
    }
    for (const Query& q : queries) {
      if (!is_there(q.hint) || !mesh_.is_alive(q.hint)) continue;
      for (const VertexSlot v : mesh_.triangle(q.hint).vertices) mesh_.prefetch_point(v);
    }
  }

  /// Takes the first step of each walk; returns how many go on.
  std::size_t set_out(std::size_t size) {
    std::size_t going = 0;
    for (const Query& q : std::span(queries_).first(size)) {
      const TriangleSlot start = grid_.near(mesh_, q.goal);
      if (start.value() == kNone) {
        locations_[q.index] = triangulation_.locate(q.goal);
        continue;
      }
      Walk& w = walks_[going];
      w.index = q.index;
      w.goal = q.goal;
      going += goes_over(begin_walk(mesh_, w.goal, finite_start(mesh_, start), w.at), w) ? 1 : 0;
    }
    return going;
  }

  /// Takes another step of the first `active` walks.
  std::size_t go_on(std::size_t active) {
    const auto walks = std::span(walks_).first(active);
    for (const Walk& w : walks) mesh_.prefetch_point(mesh_.vertex(w.at.triangle, w.at.apex));
    std::size_t going = 0;
    for (Walk& w : walks) {
      if (!goes_over(arrive(mesh_, w.goal, w.at), w)) continue;
      if (&walks_[going] != &w) walks_[going] = w;
      ++going;
    }
    return going;
  }

  /// Over the edge, and asks for what is beyond. False when the walk has ended; then its location is known.
  bool goes_over(int edge, Walk& w) {
    if (edge >= 0 && w.at.steps < kPatience) {
      go_over(mesh_, edge, w.at);
      mesh_.prefetch(w.at.triangle);
      return true;
    }
    locations_[w.index] = edge < 0 ? location_of(w.at) : triangulation_.locate(w.goal);
    return false;
  }

  const Triangulation& triangulation_;
  const StartGrid& grid_;
  const mesh::Mesh& mesh_;
  const std::span<const Point> points_;
  std::vector<Location>& locations_;
  mesh::PageVector<OnCurve> order_;  // along the curve walks share what they fetch; empty for few points
  std::array<Query, kAbreast> queries_;
  std::array<Walk, kAbreast> walks_;
};

void Triangulation::locate_many(std::span<const Point> points, std::vector<Location>& locations) const {
  locations.resize(points.size());
  if (mesh().dimension() == 2) return ManyWalks(*this, points, locations).run();
  std::transform(points.begin(), points.end(), locations.begin(), [this](Point p) { return locate(p); });
}

}  // namespace tin::delaunay
