// The visibility walk: from triangle to triangle, always over an edge that has the goal beyond it.
//
// It ends: the perturbed Delaunay triangulation is the lower hull of lifted points in general position, and
// with each crossing the height at which the vertical line over the goal meets the triangle's lifted plane
// grows. So no triangle comes twice, whatever the start.
#pragma once

#include <cstdint>
#include <type_traits>
#include <utility>

#include "tin/exact/point.h"
#include "tin/mesh/mesh.h"

namespace tin::delaunay {

/// A vertex as seen from the goal of the walk. The infinite vertex stands anywhere: its numbers are never
/// looked at.
struct Corner {
  std::int64_t x, y;
  mesh::VertexSlot vertex;
};

inline std::int64_t cross(const Corner& a, const Corner& b) { return a.x * b.y - a.y * b.x; }

inline Corner corner_at(const mesh::Mesh& mesh, mesh::VertexSlot v, exact::Point goal) {
  const exact::Point q = mesh.point(v);
  return {std::int64_t{q.x} - goal.x, std::int64_t{q.y} - goal.y, v};
}

/// Where a walk came to rest: in the triangle c, b, a (counter-clockwise), with c at its index `apex`, seen
/// from the goal. The crosses are orientations of the edges c -> b, b -> a and a -> c with the goal.
struct Stop {
  enum class Kind {
    kInside,   // the goal is in the closed finite triangle: no cross is negative
    kOutside,  // the triangle is infinite, c is the infinite vertex, and the goal lies strictly beyond the
               // hull edge
    kGaveUp,   // the limit of steps was reached, or the walk came to a place where it may not go
  };
  Kind kind;
  mesh::TriangleSlot triangle;
  int apex;
  Corner a, b, c;
  std::int64_t cb, ba, ac;
  std::uint32_t steps;  // edges crossed
};

/// The whole mesh is there to be read and changed.
struct Everywhere {
  static constexpr bool owns(mesh::VertexSlot) { return true; }
};

/// The vertices [begin, end) and the triangles that have all their vertices there: what one of several
/// threads that build together may change. (The others may be looked at, but not crossed between foreign
/// vertices: parallel.h.)
struct Territory {
  std::uint32_t begin, end;
  bool owns(mesh::VertexSlot v) const { return v.value() - begin < end - begin; }
};

inline constexpr std::uint32_t kNoLimit = 0xffffffffU;

/// The vertices from slot `first` on with the triangles among them, and the infinite vertex: what may change
/// in a piece of a larger mesh whose other vertices are there for their neighbours' sake only.
struct OwnedFrom {
  std::uint32_t first;
  bool owns(mesh::VertexSlot v) const { return v.value() - 1 >= first - 1; }
};

// A walk in single steps, for those who take many at a time: begin_walk(), then go_over() and arrive() while
// there is an edge to cross.

/// The next edge to cross, which has the goal beyond it and becomes a -> b (as seen from here); -1 when there
/// is none. Requires: the goal is not beyond b -> a.
inline int next_edge(Stop& s) {
  s.cb = cross(s.c, s.b);
  if (s.cb < 0) {
    s.ba = s.cb;
    s.a = s.c;
    return mesh::prev3(s.apex);
  }
  s.ac = cross(s.a, s.c);
  if (s.ac >= 0) return -1;
  s.ba = s.ac;
  s.b = s.c;
  return mesh::next3(s.apex);
}

/// Stands in the finite triangle `start`; returns the first edge to cross or -1.
inline int begin_walk(const mesh::Mesh& mesh, exact::Point goal, mesh::TriangleSlot start, Stop& s) {
  const auto& first = mesh.triangle(start).vertices;
  s = {Stop::Kind::kInside, start, 0, corner_at(mesh, first[2], goal), corner_at(mesh, first[1], goal),
       corner_at(mesh, first[0], goal), 0, 0, 0, 0};
  s.ba = cross(s.b, s.a);
  if (s.ba >= 0) return next_edge(s);
  std::swap(s.a, s.b);
  return 0;
}

/// Over the edge into the next triangle, where it is b -> a. Nothing is read of that triangle.
inline void go_over(const mesh::Mesh& mesh, int edge, Stop& s) {
  const mesh::HalfEdge beyond = mesh.twin(s.triangle, edge);
  s.triangle = beyond.triangle();
  s.apex = beyond.index();
  s.ba = -s.ba;
  ++s.steps;
}

/// Looks at the third corner, and returns the next edge to cross or -1.
inline int arrive(const mesh::Mesh& mesh, exact::Point goal, Stop& s) {
  const mesh::VertexSlot apex = mesh.vertex(s.triangle, s.apex);
  s.c = corner_at(mesh, apex, goal);
  if (apex != mesh::kInfinite) return next_edge(s);
  s.kind = Stop::Kind::kOutside;
  return -1;
}

/// Walks to `goal` from the finite triangle `start`. Const and safe beside other readers.
///
/// Each triangle that may come next is asked for before it is known which: they arrive while this one's corners
/// do, and where the walk ends they are what an insertion looks at first. (Not where others change the mesh: links
/// over edges between foreign vertices may be read only by those who own them.)
template <class Owner>
Stop walk(const mesh::Mesh& mesh, exact::Point goal, mesh::TriangleSlot start, const Owner& owner,
          std::uint32_t limit = kNoLimit) {
  constexpr bool kAsks = std::is_same_v<Owner, Everywhere>;
  if constexpr (kAsks) {
    for (const mesh::HalfEdge e : mesh.triangle(start).neighbours) mesh.prefetch_with_points(e.triangle());
  }
  Stop s;
  for (int edge = begin_walk(mesh, goal, start, s); edge >= 0; edge = arrive(mesh, goal, s)) {
    if (s.steps == limit || (!owner.owns(s.a.vertex) && !owner.owns(s.b.vertex))) {
      s.kind = Stop::Kind::kGaveUp;
      break;
    }
    go_over(mesh, edge, s);
    if constexpr (kAsks) {
      mesh.prefetch_with_points(mesh.twin(s.triangle, mesh::next3(s.apex)).triangle());
      mesh.prefetch_with_points(mesh.twin(s.triangle, mesh::prev3(s.apex)).triangle());
    }
  }
  return s;
}

/// A finite triangle to start from: `t` itself, or the one across its hull edge.
inline mesh::TriangleSlot finite_start(const mesh::Mesh& mesh, mesh::TriangleSlot t) {
  if (!mesh.is_infinite(t)) return t;
  return mesh.twin(t, mesh.index_of(t, mesh::kInfinite)).triangle();
}

}  // namespace tin::delaunay
