// The triangle mesh: flat arrays of triangles and vertices, 32-bit links, one infinite vertex for the hull.
//
// A mesh of dimension 2 tiles the whole sphere: each hull edge bears an infinite triangle, so every triangle
// has three neighbours. Meshes of fewer dimensions (no, one, two or only collinear vertices) have no
// triangles; their vertices stand in a line, ordered by x, then y. The mesh knows links, not geometry: what
// is Delaunay is decided in delaunay/ and removal/.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "tin/base/check.h"
#include "tin/base/strong_id.h"
#include "tin/exact/point.h"
#include "tin/mesh/page_allocator.h"
#include "tin/mesh/slot_set.h"

namespace tin::mesh {

/// Where a vertex is stored. Slots are used again after removals; terrain::VertexId is the name that lasts.
using VertexSlot = base::StrongId<struct VertexSlotTag, std::uint32_t>;
using TriangleSlot = base::StrongId<struct TriangleSlotTag, std::uint32_t>;

/// The infinite vertex; finite vertices have slots from 1.
inline constexpr VertexSlot kInfinite{0};
inline constexpr std::uint32_t kNone = 0xffffffffU;

// Out of small tables in a word: which corner comes next is as good as random, and a branch on it would often
// be mispredicted.
constexpr int next3(int i) { return 0b00'10'01 >> 2 * i & 3; }
constexpr int prev3(int i) { return 0b01'00'10 >> 2 * i & 3; }

/// An edge as seen from one of its triangles: the edge opposite to that triangle's vertex `index`, running
/// counter-clockwise, from vertex next3(index) to vertex prev3(index).
class HalfEdge {
 public:
  constexpr HalfEdge() = default;
  constexpr HalfEdge(TriangleSlot triangle, int index)
      : bits_(triangle.value() << 2 | static_cast<std::uint32_t>(index)) {}
  constexpr TriangleSlot triangle() const { return TriangleSlot(bits_ >> 2); }
  constexpr int index() const { return static_cast<int>(bits_ & 3U); }
  friend constexpr bool operator==(HalfEdge, HalfEdge) = default;

 private:
  std::uint32_t bits_ = kNone;
};

/// Vertices counter-clockwise; neighbours[i] is the other side of the edge opposite to vertex i.
struct Triangle {
  std::array<VertexSlot, 3> vertices;
  std::array<HalfEdge, 3> neighbours;
};

/// Where each slot went when the mesh was renumbered; kNone for slots that were free.
struct Renumbering {
  std::vector<VertexSlot> vertices;
  std::vector<TriangleSlot> triangles;
};

class Mesh {
 public:
  Mesh();

  // Reading
  // ---------------------------------------------------------------------------------------------------

  /// -1 without vertices, 0 with one, 1 when all are collinear, else 2.
  int dimension() const;
  std::size_t vertex_count() const { return vertex_count_; }
  std::size_t triangle_count() const { return triangle_count_; }  // with the infinite ones
  std::size_t finite_triangle_count() const;
  /// One past the largest slots in use: the arrays to iterate over, asking is_alive() of each.
  std::uint32_t vertex_slots() const { return static_cast<std::uint32_t>(points_.size()); }
  std::uint32_t triangle_slots() const { return static_cast<std::uint32_t>(triangles_.size()); }

  bool is_alive(VertexSlot v) const { return v.value() < star_.size() && star_[v.value()] != kDead; }
  bool is_alive(TriangleSlot t) const { return triangles_[t.value()].vertices[0].value() != kNone; }
  bool is_infinite(TriangleSlot t) const;

  exact::Point point(VertexSlot v) const { return points_[v.value()]; }
  const Triangle& triangle(TriangleSlot t) const { return triangles_[t.value()]; }
  VertexSlot vertex(TriangleSlot t, int i) const { return triangle(t).vertices[static_cast<std::size_t>(i)]; }
  HalfEdge twin(HalfEdge e) const { return twin(e.triangle(), e.index()); }
  HalfEdge twin(TriangleSlot t, int i) const { return triangle(t).neighbours[static_cast<std::size_t>(i)]; }
  VertexSlot origin(HalfEdge e) const { return vertex(e.triangle(), next3(e.index())); }
  VertexSlot destination(HalfEdge e) const { return vertex(e.triangle(), prev3(e.index())); }
  VertexSlot apex(HalfEdge e) const { return vertex(e.triangle(), e.index()); }
  /// A triangle at `v`. Requires: dimension() == 2; v alive or kInfinite.
  TriangleSlot triangle_at(VertexSlot v) const { return TriangleSlot(star_[v.value()]); }
  /// Index of `v` in `t`. Requires: it is there.
  int index_of(TriangleSlot t, VertexSlot v) const;

  /// The link of `v`, counter-clockwise: for each triangle of its star the edge opposite to `v`. Requires
  /// dimension() == 2.
  void link(VertexSlot v, std::vector<HalfEdge>& out) const;

  /// The vertices in order when dimension() < 2.
  std::span<const VertexSlot> line() const { return line_; }

  // Writing: building blocks for delaunay/ and removal/, which keep the invariants
  // --------------------------------

  /// Uses a free slot again, the one nearest to `near`; without free slots the arrays grow.
  VertexSlot add_vertex(exact::Point p, VertexSlot near = kInfinite);
  void release_vertex(VertexSlot v);
  TriangleSlot add_triangle(VertexSlot a, VertexSlot b, VertexSlot c);
  void set_triangle(TriangleSlot t, VertexSlot a, VertexSlot b, VertexSlot c);
  /// A slot for a triangle that the caller writes at once.
  TriangleSlot claim_triangle(TriangleSlot near);
  /// Writes the triangle alone: neither its neighbours' links nor triangle_at() of its vertices.
  void write_triangle(TriangleSlot t, const Triangle& content) { triangles_[t.value()] = content; }
  void release_triangle(TriangleSlot t);
  void join(HalfEdge a, HalfEdge b);
  /// One direction of join().
  void set_twin(HalfEdge e, HalfEdge twin) {
    triangles_[e.triangle().value()].neighbours[static_cast<std::size_t>(e.index())] = twin;
  }
  void set_triangle_at(VertexSlot v, TriangleSlot t) { star_[v.value()] = t.value(); }
  std::vector<VertexSlot>& mutable_line() { return line_; }
  void clear_triangles();
  void reserve(std::size_t vertices);

  /// Bulk building of an empty mesh: makes vertices 1..count, whose points the caller then sets, and room for
  /// twice as many triangles, which the caller writes with write_triangle(). Again with a smaller count, the
  /// first points stay.
  void begin_bulk(std::size_t count);
  void set_point(VertexSlot v, exact::Point p) { points_[v.value()] = p; }
  /// All of the 2 * count triangles are written but those in `unused` (all of them when the vertices are
  /// collinear).
  void end_bulk(std::span<const TriangleSlot> unused);

  /// Stores the vertices in the given order, without gaps, and the triangles after them.
  /// Requires: `order` holds each alive finite vertex once.
  Renumbering renumber(std::span<const VertexSlot> order);

  // Memory
  // -------------------------------------------------------------------------------------------------------

  /// What the arrays occupy.
  std::size_t bytes() const;
  void prefetch(VertexSlot v) const {
    __builtin_prefetch(&points_[v.value()]);
    __builtin_prefetch(&star_[v.value()]);
  }
  void prefetch_point(VertexSlot v) const { __builtin_prefetch(&points_[v.value()]); }
  void prefetch(TriangleSlot t) const { __builtin_prefetch(&triangles_[t.value()]); }
  // Without a look at `t`: in a mesh stored along a curve, triangles are twice as far in their array as their
  // vertices are in theirs. They touch nothing, so that addresses beyond the arrays do no harm.
  /// The triangle, and where its vertices may be.
  void prefetch_with_points(TriangleSlot t) const { prefetch_lines(t, 0); }
  /// What a walk from `t` likely touches.
  void prefetch_around(TriangleSlot t) const {
    prefetch_lines(t, std::uintptr_t{0} - kCacheLine);
    prefetch_lines(t, 0);
    prefetch_lines(t, kCacheLine);
  }

 private:
  static constexpr std::uintptr_t kCacheLine = 64;
  static constexpr std::uint32_t kDead = kNone;
  static constexpr std::uint32_t kNoTriangle = kNone - 1;

  void prefetch_lines(TriangleSlot t, std::uintptr_t offset) const {
    const auto triangle = reinterpret_cast<std::uintptr_t>(triangles_.data()) + t.value() * sizeof(Triangle);
    const auto point =
        reinterpret_cast<std::uintptr_t>(points_.data()) + t.value() / 2 * sizeof(exact::Point);
    __builtin_prefetch(reinterpret_cast<const void*>(triangle + offset));
    __builtin_prefetch(reinterpret_cast<const void*>(point + offset));
  }
  std::vector<TriangleSlot> renumber_triangles(const std::vector<VertexSlot>& new_of_old);

  PageVector<exact::Point> points_;
  PageVector<std::uint32_t> star_;  // a triangle at each vertex; kDead in free slots
  PageVector<Triangle> triangles_;
  SlotSet free_vertices_;
  SlotSet free_triangles_;
  std::vector<VertexSlot> line_;
  std::size_t vertex_count_ = 0;
  std::size_t triangle_count_ = 0;
};

// Here, since every step around a vertex needs them.

inline bool Mesh::is_infinite(TriangleSlot t) const {
  const auto& v = triangle(t).vertices;
  return v[0] == kInfinite || v[1] == kInfinite || v[2] == kInfinite;
}

inline int Mesh::index_of(TriangleSlot t, VertexSlot v) const {
  const auto& vertices = triangle(t).vertices;
  TIN_DCHECK(vertices[0] == v || vertices[1] == v || vertices[2] == v);
  return static_cast<int>(vertices[1] == v) +
         2 * static_cast<int>(vertices[2] == v);  // as next3(): no branches
}

inline void Mesh::set_triangle(TriangleSlot t, VertexSlot a, VertexSlot b, VertexSlot c) {
  triangles_[t.value()].vertices = {a, b, c};
  star_[a.value()] = star_[b.value()] = star_[c.value()] = t.value();
}

inline void Mesh::release_vertex(VertexSlot v) {
  TIN_DCHECK(v != kInfinite && is_alive(v));
  --vertex_count_;
  star_[v.value()] = kDead;
  free_vertices_.add(v.value());
}

inline void Mesh::release_triangle(TriangleSlot t) {
  triangles_[t.value()].vertices[0] = VertexSlot(kNone);
  free_triangles_.add(t.value());
  --triangle_count_;
}

inline void Mesh::join(HalfEdge a, HalfEdge b) {
  triangles_[a.triangle().value()].neighbours[static_cast<std::size_t>(a.index())] = b;
  triangles_[b.triangle().value()].neighbours[static_cast<std::size_t>(b.index())] = a;
}

}  // namespace tin::mesh
