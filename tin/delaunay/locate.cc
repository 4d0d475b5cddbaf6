// Location by a visibility walk. In a Delaunay triangulation (and a perturbed one is the regular triangulation of nearby
// lifted points) the walk passes no triangle twice, so it ends.
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

Location Triangulation::locate(Point p) const {
  if (mesh_.dimension() == 2) return locate_from(p, mesh_.triangle_at(starts_.near(mesh_, p)));
  for (const VertexSlot v : mesh_.line()) {
    if (mesh_.point(v) == p) return {Location::Kind::kOnVertex, TriangleSlot(mesh::kNone), -1, v};
  }
  return {};
}

Location Triangulation::locate_from(Point p, TriangleSlot hint) const {
  TriangleSlot t = hint;
  int came_over = -1;
  if (mesh_.is_infinite(t)) {
    const HalfEdge inside = mesh_.twin(t, mesh_.index_of(t, kInfinite));
    t = inside.triangle();
  }
  for (;;) {
    const auto& vertices = mesh_.triangle(t).vertices;
    int cross = -1;
    for (int i = 0; i < 3 && cross < 0; ++i) {
      if (i == came_over) continue;
      const Point from = mesh_.point(vertices[static_cast<std::size_t>(next3(i))]);
      const Point to = mesh_.point(vertices[static_cast<std::size_t>(prev3(i))]);
      if (orientation(from, to, p) < 0) cross = i;
    }
    if (cross < 0) return classify(p, t);
    const HalfEdge beyond = mesh_.twin(t, cross);
    t = beyond.triangle();
    came_over = beyond.index();
    if (mesh_.vertex(t, came_over) == kInfinite) return {Location::Kind::kOutsideHull, t, came_over, {}};
  }
}

/// `p` lies in the closed finite triangle `t`: inside, on an edge or at a vertex.
Location Triangulation::classify(Point p, TriangleSlot t) const {
  int zero = -1;
  for (int i = 0; i < 3; ++i) {
    const VertexSlot v = mesh_.vertex(t, i);
    if (mesh_.point(v) == p) return {Location::Kind::kOnVertex, t, i, v};
    if (orientation(mesh_.point(mesh_.vertex(t, next3(i))), mesh_.point(mesh_.vertex(t, prev3(i))), p) == 0) zero = i;
  }
  if (zero >= 0) return {Location::Kind::kOnEdge, t, zero, VertexSlot(mesh::kNone)};
  return {Location::Kind::kInTriangle, t, -1, VertexSlot(mesh::kNone)};
}

}  // namespace tin::delaunay
