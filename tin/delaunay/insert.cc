// Insertion: the triangles whose perturbed circle holds the new point make way for its star (Bowyer, Watson).
#include <algorithm>

#include "tin/delaunay/triangulation.h"
#include "tin/exact/predicates.h"

namespace tin::delaunay {

using exact::orientation;
using exact::Point;
using mesh::HalfEdge;
using mesh::kInfinite;
using mesh::next3;
using mesh::prev3;
using mesh::TriangleSlot;
using mesh::VertexSlot;

Triangulation::Inserted Triangulation::insert(Point p) {
  if (mesh_.dimension() < 2) return insert_below_plane(p);
  return insert_located(p, locate(p));
}

Triangulation::Inserted Triangulation::insert_near(Point p, VertexSlot hint) {
  if (mesh_.dimension() < 2) return insert_below_plane(p);
  return insert_located(p, locate_from(p, mesh_.triangle_at(hint)));
}

Triangulation::Inserted Triangulation::insert_located(Point p, const Location& where) {
  if (where.kind == Location::Kind::kOnVertex) return {where.vertex, false};
  find_cavity(p, where.triangle);
  const VertexSlot v = mesh_.add_vertex(p);
  fill_cavity(v);
  starts_.remember(mesh_, v);
  return {v, true};
}

/// Whether `p` lies inside the triangle's perturbed circle; for an infinite triangle, beyond its hull edge or on it.
bool Triangulation::in_conflict(TriangleSlot t, Point p) const {
  const auto& [a, b, c] = mesh_.triangle(t).vertices;
  const Point pa = mesh_.point(a), pb = mesh_.point(b), pc = mesh_.point(c);
  const auto beyond = [p](Point from, Point to) {
    const std::int64_t side = orientation(from, to, p);
    return side > 0 || (side == 0 && std::min(from, to) < p && p < std::max(from, to));
  };
  if (a == kInfinite) return beyond(pb, pc);
  if (b == kInfinite) return beyond(pc, pa);
  if (c == kInfinite) return beyond(pa, pb);
  return exact::in_circle(pa, pb, pc, p);
}

/// Collects the triangles in conflict, from `first` on. They hold no vertex inside, so their dual is a tree; crossing edges
/// depth first, counter-clockwise, meets the boundary in order.
void Triangulation::find_cavity(Point p, TriangleSlot first) {
  cavity_.assign(1, first);
  cavity_edge_.clear();
  to_cross_.assign({HalfEdge(first, 2), HalfEdge(first, 1), HalfEdge(first, 0)});
  while (!to_cross_.empty()) {
    const HalfEdge beyond = mesh_.twin(to_cross_.back());
    to_cross_.pop_back();
    const TriangleSlot t = beyond.triangle();
    if (in_conflict(t, p)) {
      cavity_.push_back(t);
      to_cross_.emplace_back(t, prev3(beyond.index()));
      to_cross_.emplace_back(t, next3(beyond.index()));
    } else {
      cavity_edge_.push_back(beyond);
    }
  }
}

/// Stars the cavity from `v`: its slots are used again, and two more triangles are made.
void Triangulation::fill_cavity(VertexSlot v) {
  const std::size_t count = cavity_edge_.size();
  fresh_.clear();
  for (std::size_t i = 0; i < count; ++i) {
    const HalfEdge outer = cavity_edge_[i];
    const VertexSlot from = mesh_.destination(outer), to = mesh_.origin(outer);
    TriangleSlot t;
    if (i < cavity_.size()) {
      t = cavity_[i];
      mesh_.set_triangle(t, v, from, to);
    } else {
      t = mesh_.add_triangle(v, from, to);
    }
    mesh_.join(HalfEdge(t, 0), outer);
    if (i > 0) mesh_.join(HalfEdge(fresh_.back(), 1), HalfEdge(t, 2));
    fresh_.push_back(t);
  }
  mesh_.join(HalfEdge(fresh_.back(), 1), HalfEdge(fresh_.front(), 2));
}

Triangulation::Inserted Triangulation::insert_below_plane(Point p) {
  fresh_.clear();
  auto& line = mesh_.mutable_line();
  const auto at = std::lower_bound(line.begin(), line.end(), p,
                                   [this](VertexSlot v, Point q) { return mesh_.point(v) < q; });
  if (at != line.end() && mesh_.point(*at) == p) return {*at, false};
  const bool leaves_line = line.size() >= 2 && orientation(mesh_.point(line.front()), mesh_.point(line.back()), p) != 0;
  const VertexSlot v = mesh_.add_vertex(p);
  if (leaves_line) {
    raise_to_plane(v);
    starts_.remember(mesh_, v);
  } else {
    line.insert(at, v);
  }
  return {v, true};
}

/// The first vertex off the line: a fan from it over the line, and infinite triangles around.
void Triangulation::raise_to_plane(VertexSlot apex) {
  std::vector<VertexSlot> line;
  line.swap(mesh_.mutable_line());
  if (orientation(mesh_.point(line[0]), mesh_.point(line[1]), mesh_.point(apex)) < 0) std::reverse(line.begin(), line.end());
  // Triangles (inf, b, a) over the hull edges a -> b, counter-clockwise: along the line, then line.back() -> apex -> line[0].
  for (std::size_t i = 0; i + 1 < line.size(); ++i) {
    const TriangleSlot inner = mesh_.add_triangle(line[i], line[i + 1], apex);
    const TriangleSlot outer = mesh_.add_triangle(kInfinite, line[i + 1], line[i]);
    mesh_.join(HalfEdge(inner, 2), HalfEdge(outer, 0));
    fresh_.push_back(inner);
    fresh_.push_back(outer);
    if (i == 0) continue;
    mesh_.join(HalfEdge(fresh_[fresh_.size() - 4], 0), HalfEdge(inner, 1));
    mesh_.join(HalfEdge(outer, 1), HalfEdge(fresh_[fresh_.size() - 3], 2));
  }
  const TriangleSlot first_inner = fresh_[0], first_outer = fresh_[1];
  const TriangleSlot last_inner = fresh_[fresh_.size() - 2], last_outer = fresh_[fresh_.size() - 1];
  const TriangleSlot up = mesh_.add_triangle(kInfinite, apex, line.back());
  const TriangleSlot down = mesh_.add_triangle(kInfinite, line.front(), apex);
  mesh_.join(HalfEdge(last_inner, 0), HalfEdge(up, 0));
  mesh_.join(HalfEdge(first_inner, 1), HalfEdge(down, 0));
  mesh_.join(HalfEdge(first_outer, 1), HalfEdge(down, 2));
  mesh_.join(HalfEdge(down, 1), HalfEdge(up, 2));
  mesh_.join(HalfEdge(up, 1), HalfEdge(last_outer, 2));
  fresh_.push_back(up);
  fresh_.push_back(down);
}

}  // namespace tin::delaunay
