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

constexpr std::size_t kLarge =
    64;  // a star worth to be stored in the order of its link, for those who will walk around it

/// Whether the new point, at the origin and in line with the hull edge from q to r, lies on it.
template <class Seen>
bool on_hull_edge(const Seen& q, const Seen& r) {
  return q.x * r.x < 0 || (q.x == 0 && q.y * r.y < 0);
}

constexpr std::size_t kAhead = 2;  // edges

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
  corners_.resize(room_ + 2);
  edges_.resize(2 * room_ + 1);
  rim_.resize(room_ + 2);
  triangles_.resize(room_ + 2);
}

/// Field by field: a copy of the whole would be read from where its parts are still being written.
inline void Cavity::see(std::int64_t x, std::int64_t y, VertexSlot v, Seen& out) {
  const std::int64_t finite = v == kInfinite ? 0 : -1;
  out.x = x &= finite;
  out.y = y &= finite;
  out.square = x * x + y * y + finite + 1;
  out.vertex = v;
}

void Cavity::start(const Mesh& mesh, const Stop& stop) {
  if (room_ == 0) enlarge();
  see(stop.c.x, stop.c.y, stop.c.vertex, corners_[0]);
  see(stop.b.x, stop.b.y, stop.b.vertex, corners_[1]);
  see(stop.a.x, stop.a.y, stop.a.vertex, corners_[2]);
  const bool finite = stop.kind != Stop::Kind::kOutside;
  const auto& neighbours = mesh.triangle(stop.triangle).neighbours;
  const auto beyond = [&](int i) { return neighbours[static_cast<std::size_t>(i)]; };
  edges_[0] = {finite ? stop.cb : 0, beyond(prev3(stop.apex)), 0, 1};
  edges_[1] = {stop.ba, beyond(stop.apex), 1, 2};
  edges_[2] = {finite ? stop.ac : 0, beyond(next3(stop.apex)), 2, 0};
  for (int i = 0; i < 3; ++i) mesh.prefetch(beyond(i).triangle());
  triangles_[0] = stop.triangle;
  triangle_count_ = 1;
}

/// What decides when the determinant of the triangle to, from, apex is zero.
[[gnu::cold, gnu::noinline]] bool Cavity::tie(const Mesh& mesh, Point p, const Seen& from, const Seen& to,
                                              const Seen& apex) {
  if (apex.vertex == kInfinite) return on_hull_edge(to, from);
  if (to.vertex == kInfinite) return on_hull_edge(from, apex);
  if (from.vertex == kInfinite) return on_hull_edge(apex, to);
  return exact::tie_is_inside(mesh.point(to.vertex), mesh.point(from.vertex), mesh.point(apex.vertex), p);
}

/// The triangles in conflict hold no vertex inside, so their dual is a tree, which is searched breadth first.
/// What a test finds is hard to foresee, so nothing branches on it: the triangle's two other edges are always
/// written behind the last, and count if it is in conflict. Edges from one corner come one after the other,
/// each nearer to the rim: the last stays.
///
/// Where the next edge is written depends on this test, so the processor cannot look ahead by itself: triangles
/// are asked for when their edge is written, whether it counts or not, and corners kAhead edges before their turn.
template <class Owner>
bool Cavity::carve(const Mesh& mesh, Point p, const Stop& stop, const Owner& owner) {
  if (!owner.owns(stop.a.vertex) || !owner.owns(stop.b.vertex) || !owner.owns(stop.c.vertex)) return false;
  start(mesh, stop);
  std::size_t count = 1;
  Seen* corners = corners_.data();
  Edge* edges = edges_.data();
  Rim* rim = rim_.data();
  TriangleSlot* triangles = triangles_.data();
  for (std::size_t i = 0; i < 2 * count + 1; ++i) {
    if (count + 1 > room_) [[unlikely]] {
      enlarge();
      corners = corners_.data();
      edges = edges_.data();
      rim = rim_.data();
      triangles = triangles_.data();
    }
    const Edge edge = edges[i];
    if (i + kAhead < 2 * count + 1) {
      const HalfEdge later = edges[i + kAhead].beyond;
      mesh.prefetch_point(mesh.vertex(later.triangle(), later.index()));
    }
    const TriangleSlot t = edge.beyond.triangle();
    const int j = edge.beyond.index();
    const VertexSlot v = mesh.vertex(t, j);
    const Point q = mesh.point(v);
    const auto middle = static_cast<std::uint32_t>(count + 2);
    Seen& apex = corners[middle];
    see(std::int64_t{q.x} - p.x, std::int64_t{q.y} - p.y, v, apex);
    const Seen &from = corners[edge.from], &to = corners[edge.to];
    const std::int64_t from_apex = from.x * apex.y - from.y * apex.x, apex_to = apex.x * to.y - apex.y * to.x;
    rim[edge.from] = {edge.beyond, edge.to};
    triangles[count] = t;
    edges[2 * count + 1] = {from_apex, mesh.twin(t, next3(j)), edge.from, middle};
    edges[2 * count + 2] = {apex_to, mesh.twin(t, prev3(j)), middle, edge.to};
    mesh.prefetch(edges[2 * count + 1].beyond.triangle());
    mesh.prefetch(edges[2 * count + 2].beyond.triangle());
    const Int128 determinant =
        Int128{to.square} * from_apex + Int128{from.square} * apex_to - Int128{apex.square} * edge.cross;
    bool conflict = determinant > 0;
    if (determinant == 0) [[unlikely]] conflict = tie(mesh, p, from, to, apex);
    // Beyond a foreign vertex somebody else may be at work. Up to here each edge looked over has two vertices
    // that are the owner's, so what is read of the triangle beyond it changes by nobody else.
    if (conflict && !owner.owns(v)) [[unlikely]] return false;
    count += conflict ? 1 : 0;
  }
  triangle_count_ = count;
  return true;
}

template bool Cavity::carve(const Mesh&, Point, const Stop&, const Everywhere&);
template bool Cavity::carve(const Mesh&, Point, const Stop&, const Territory&);
template bool Cavity::carve(const Mesh&, Point, const Stop&, const OwnedFrom&);

TriangleSlot Cavity::fill(Mesh& mesh, VertexSlot v, TriangleSlot extra1, TriangleSlot extra2,
                          Direction toward) {
  triangles_[triangle_count_++] = extra1;
  triangles_[triangle_count_++] = extra2;
  if (triangle_count_ > kLarge)
    std::sort(triangles_.begin(), triangles_.begin() + static_cast<std::ptrdiff_t>(triangle_count_));
  const auto side = [&](std::uint32_t corner) {
    return corners_[corner].x * toward.y - corners_[corner].y * toward.x;
  };
  std::uint32_t at = 0;
  VertexSlot from = corners_[0].vertex;
  std::int64_t from_side = side(0);
  TriangleSlot previous = triangles_[triangle_count_ - 1], facing = triangles_[0];
  for (std::size_t i = 0; i < triangle_count_; ++i) {
    const Rim rim = rim_[at];
    const TriangleSlot t = triangles_[i], next = triangles_[i + 1 == triangle_count_ ? 0 : i + 1];
    at = rim.to;
    const VertexSlot to = corners_[at].vertex;
    const std::int64_t to_side = side(at);
    mesh.write_triangle(t, {{v, from, to}, {rim.beyond, HalfEdge(next, 2), HalfEdge(previous, 1)}});
    mesh.set_twin(rim.beyond, HalfEdge(t, 0));
    mesh.set_triangle_at(from, t);
    facing = (from_side >= 0) & (to_side < 0) ? t : facing;
    from = to;
    from_side = to_side;
    previous = t;
  }
  mesh.set_triangle_at(v, triangles_[0]);
  return facing;
}

}  // namespace tin::delaunay
