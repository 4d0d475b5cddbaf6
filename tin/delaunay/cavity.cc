#include "tin/delaunay/cavity.h"

#include <algorithm>

#include "tin/exact/predicates.h"

namespace tin::delaunay {

using exact::Int128;
using exact::Point;
using mesh::HalfEdge;
using mesh::kInfinite;
using mesh::Mesh;
using mesh::next3;
using mesh::prev3;
using mesh::TriangleSlot;
using mesh::VertexSlot;

namespace {

/// For an infinite triangle with the hull edge q -> r (counter-clockwise around with the infinite vertex): whether the new
/// point, at the origin, lies beyond that edge or on it. `side` is cross(q, r).
bool beyond_hull_edge(const Corner& q, const Corner& r, std::int64_t side) {
  if (side != 0) return side > 0;
  return q.x * r.x < 0 || (q.x == 0 && q.y * r.y < 0);
}

}  // namespace

bool at_vertex(const Stop& stop, VertexSlot& vertex) {
  if (stop.kind != Stop::Kind::kInside || (stop.cb != 0 && stop.ba != 0 && stop.ac != 0)) return false;
  for (const Corner* corner : {&stop.a, &stop.b, &stop.c}) {
    if (corner->x != 0 || corner->y != 0) continue;
    vertex = corner->vertex;
    return true;
  }
  return false;
}

void Cavity::enlarge() {
  room_ = room_ == 0 ? 64 : 2 * room_;
  corners_.resize(room_);
  to_cross_.resize(room_);
  rim_.resize(room_);
  triangles_.resize(room_);
}

void Cavity::start(const Stop& stop) {
  if (room_ == 0) enlarge();
  const auto seen = [](const Corner& at) { return Seen{at, at.x * at.x + at.y * at.y}; };
  corners_[0] = seen(stop.c);
  corners_[1] = seen(stop.b);
  corners_[2] = seen(stop.a);
  to_cross_[0] = {HalfEdge(stop.triangle, next3(stop.apex)), 2, 0, stop.ac};
  to_cross_[1] = {HalfEdge(stop.triangle, stop.apex), 1, 2, stop.ba};
  to_cross_[2] = {HalfEdge(stop.triangle, prev3(stop.apex)), 0, 1, stop.cb};
  triangles_[0] = stop.triangle;
  corner_count_ = to_cross_count_ = 3;
  rim_count_ = 0;
  triangle_count_ = 1;
}

/// The perturbed in-circle test of the triangle to, from, apex; for infinite ones whether p is beyond the hull edge.
inline bool Cavity::in_conflict(const Mesh& mesh, Point p, const Seen& from, const Seen& to, const Seen& apex,
                                const ToCross& edge, std::int64_t from_apex, std::int64_t apex_to) {
  if (apex.at.vertex == kInfinite) [[unlikely]] return beyond_hull_edge(to.at, from.at, -edge.cross);
  if (to.at.vertex == kInfinite) [[unlikely]] return beyond_hull_edge(from.at, apex.at, from_apex);
  if (from.at.vertex == kInfinite) [[unlikely]] return beyond_hull_edge(apex.at, to.at, apex_to);
  const Int128 determinant =
      Int128{to.square} * from_apex + Int128{from.square} * apex_to - Int128{apex.square} * edge.cross;
  if (determinant != 0) [[likely]] return determinant > 0;
  return exact::tie_is_inside(mesh.point(to.at.vertex), mesh.point(from.at.vertex), mesh.point(apex.at.vertex), p);
}

/// The triangles in conflict hold no vertex inside, so their dual is a tree; crossing edges depth first,
/// counter-clockwise, meets the rim in order.
template <class Owner>
bool Cavity::carve(const Mesh& mesh, Point p, const Stop& stop, const Owner& owner) {
  if (!owner.owns(stop.a.vertex) || !owner.owns(stop.b.vertex) || !owner.owns(stop.c.vertex)) return false;
  start(stop);
  while (to_cross_count_ > 0) {
    ToCross edge = to_cross_[--to_cross_count_];
    for (;;) {
      const HalfEdge beyond = mesh.twin(edge.edge);
      const TriangleSlot t = beyond.triangle();
      const Corner corner = corner_at(mesh, mesh.vertex(t, beyond.index()), p);
      const Seen apex{corner, corner.x * corner.x + corner.y * corner.y};
      const Seen &from = corners_[edge.from], &to = corners_[edge.to];
      const std::int64_t from_apex = cross(from.at, corner), apex_to = cross(corner, to.at);
      if (!in_conflict(mesh, p, from, to, apex, edge, from_apex, apex_to)) {
        rim_[rim_count_++] = {beyond, edge.from};
        break;
      }
      if (!owner.owns(corner.vertex)) return false;
      if (corner_count_ + 2 > room_) enlarge();
      const auto middle = static_cast<std::uint32_t>(corner_count_++);
      triangles_[triangle_count_++] = t;
      corners_[middle] = apex;
      to_cross_[to_cross_count_++] = {HalfEdge(t, prev3(beyond.index())), middle, edge.to, apex_to};
      edge = {HalfEdge(t, next3(beyond.index())), edge.from, middle, from_apex};
    }
  }
  return true;
}

template bool Cavity::carve(const Mesh&, Point, const Stop&, const Everywhere&);
template bool Cavity::carve(const Mesh&, Point, const Stop&, const Territory&);
template bool Cavity::carve(const Mesh&, Point, const Stop&, const OwnedFrom&);

void Cavity::fill(Mesh& mesh, VertexSlot v, TriangleSlot extra1, TriangleSlot extra2) {
  triangles_[triangle_count_++] = extra1;
  triangles_[triangle_count_++] = extra2;
  const std::size_t count = rim_count_;
  VertexSlot from = corners_[rim_[0].from].at.vertex;
  const VertexSlot first = from;
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t next = i + 1 == count ? 0 : i + 1, previous = i == 0 ? count - 1 : i - 1;
    const VertexSlot to = next == 0 ? first : corners_[rim_[next].from].at.vertex;
    const TriangleSlot t = triangles_[i];
    mesh.write_triangle(t, {{v, from, to}, {rim_[i].outer, HalfEdge(triangles_[next], 2), HalfEdge(triangles_[previous], 1)}});
    mesh.set_twin(rim_[i].outer, HalfEdge(t, 0));
    mesh.set_triangle_at(from, t);
    from = to;
  }
  mesh.set_triangle_at(v, triangles_[0]);
}

}  // namespace tin::delaunay
