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
  if (stop.kind == Stop::Kind::kOutside) return {Location::Kind::kOutsideHull, stop.triangle, stop.apex, VertexSlot(kNone)};
  if (stop.cb != 0 && stop.ba != 0 && stop.ac != 0) {
    return {Location::Kind::kInTriangle, stop.triangle, -1, VertexSlot(kNone)};
  }
  if (VertexSlot v; at_vertex(stop, v)) {
    const int index = v == stop.c.vertex ? stop.apex : v == stop.b.vertex ? next3(stop.apex) : prev3(stop.apex);
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
  const auto at = std::lower_bound(line.begin(), line.end(), p, [this](VertexSlot v, Point q) { return mesh().point(v) < q; });
  if (at != line.end() && mesh().point(*at) == p) return {Location::Kind::kOnVertex, TriangleSlot(kNone), -1, *at};
  return {};
}

Location Triangulation::locate_from(Point p, TriangleSlot hint) const {
  return location_of(walk(mesh(), p, finite_start(mesh(), hint), Everywhere{}));
}

/// A ring of walks in turns: while one waits for its triangle or its points to arrive from memory, the others go on. Each turn
/// touches only what was asked for a round before.
class ManyWalks {
 public:
  ManyWalks(const Triangulation& triangulation, std::span<const Point> points, std::vector<Location>& locations)
      : triangulation_(triangulation), mesh_(triangulation.mesh()), points_(points), locations_(locations) {
    if (points.size() >= kWorthSorting) order_ = hilbert_sorted(points);
  }

  void run() {
    const std::size_t width = std::min(kWalks, points_.size());
    std::size_t active = 0;
    for (; active < width; ++active) begin(walks_[active]);
    while (active > 0) {
      for (std::size_t i = 0; i < active; ++i) {
        while (!turn(walks_[i])) {
          if (next_ < points_.size()) {
            begin(walks_[i]);
            break;
          }
          if (--active == i) break;
          walks_[i] = walks_[active];
        }
      }
    }
  }

 private:
  static constexpr std::size_t kWalks = 24;
  static constexpr std::size_t kWorthSorting = 4096;
  enum class Stage { kCell, kHint, kPoints, kWalk };
  struct Walk {
    std::size_t index;
    Stage stage;
    TriangleSlot triangle;
  };

  void begin(Walk& walk) {
    walk = {order_.empty() ? next_ : order_[next_].index, Stage::kCell, TriangleSlot(kNone)};
    ++next_;
    triangulation_.grid_.prefetch_cell(points_[walk.index]);
  }

  /// False when the walk has ended.
  bool turn(Walk& w) {
    const Point p = points_[w.index];
    switch (w.stage) {
      case Stage::kCell:
        w.triangle = triangulation_.grid_.hint(p);
        if (w.triangle.value() >= mesh_.triangle_slots()) return finish(w, triangulation_.locate(p));
        mesh_.prefetch(w.triangle);
        w.stage = Stage::kHint;
        return true;
      case Stage::kHint:
        if (!mesh_.is_alive(w.triangle)) return finish(w, triangulation_.locate(p));
        fetch_around(w.triangle);
        w.stage = Stage::kPoints;
        return true;
      case Stage::kPoints:
        w.triangle = triangulation_.grid_.near(mesh_, p);
        if (w.triangle.value() == kNone) return finish(w, triangulation_.locate(p));
        fetch_across(w.triangle);
        w.triangle = finite_start(mesh_, w.triangle);
        w.stage = Stage::kWalk;
        return true;
      case Stage::kWalk: break;
    }
    return advance(w, p);
  }

  bool advance(Walk& w, Point p) {
    const Stop stop = walk(mesh_, p, w.triangle, Everywhere{}, kStride);
    if (stop.kind != Stop::Kind::kGaveUp) return finish(w, location_of(stop));
    w.triangle = stop.triangle;
    fetch_around(w.triangle);
    return true;
  }

  void fetch_around(TriangleSlot t) const {
    for (int i = 0; i < 3; ++i) {
      mesh_.prefetch_point(mesh_.vertex(t, i));
      mesh_.prefetch(mesh_.twin(t, i).triangle());
    }
  }

  void fetch_across(TriangleSlot t) const {
    for (int i = 0; i < 3; ++i) mesh_.prefetch_point(mesh_.apex(mesh_.twin(t, i)));
  }

  bool finish(const Walk& w, const Location& location) {
    locations_[w.index] = location;
    return false;
  }

  static constexpr std::uint32_t kStride = 2;

  const Triangulation& triangulation_;
  const mesh::Mesh& mesh_;
  const std::span<const Point> points_;
  std::vector<Location>& locations_;
  mesh::PageVector<OnCurve> order_;  // along the curve walks share what they fetch; empty for few points
  std::size_t next_ = 0;
  std::array<Walk, kWalks> walks_{};
};

void Triangulation::locate_many(std::span<const Point> points, std::vector<Location>& locations) const {
  locations.resize(points.size());
  if (mesh().dimension() == 2) return ManyWalks(*this, points, locations).run();
  std::transform(points.begin(), points.end(), locations.begin(), [this](Point p) { return locate(p); });
}

}  // namespace tin::delaunay
