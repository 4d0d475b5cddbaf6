// Insertion into a mesh of dimension 2: the triangles whose perturbed circle holds the new point make way for
// its star (Bowyer, Watson).
//
// All arithmetic is done with differences to the new point, which are computed once per vertex, and each
// edge's cross product is kept for the triangle beyond it: an in-circle test then costs two cross products,
// one square and three wide products. It is exact as it stands; a floating-point filter in front of it would
// only cost.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "tin/delaunay/walk.h"
#include "tin/mesh/mesh.h"

namespace tin::delaunay {

struct Direction {
  std::int64_t x = 0, y = 0;
};

/// Works with buffers of its own, so that repeated insertions allocate nothing. One thread at a time.
class Cavity {
 public:
  /// Finds the triangles in conflict with `p`, from the stop of a walk to it on. Requires: no vertex stands
  /// at p. False when one of them is not the owner's; nothing is changed here in any case.
  template <class Owner>
  bool carve(const mesh::Mesh& mesh, exact::Point p, const Stop& stop, const Owner& owner);

  /// Stars the cavity from `v`, in the slots of the triangles in conflict and these two more. Returns the new
  /// triangle which a ray from v in the direction `toward` runs through, where the next walk should start;
  /// any if there is none.
  mesh::TriangleSlot fill(mesh::Mesh& mesh, mesh::VertexSlot v, mesh::TriangleSlot extra1,
                          mesh::TriangleSlot extra2, Direction toward = {});

  /// After carve(): calls visit(from, to) for each edge around the triangles in conflict, counter-clockwise, until
  /// it returns false. They make a triangle each with the new point. Returns whether all were visited.
  template <class Visit>
  bool visit_rim(const Visit& visit) const {
    std::uint32_t at = 0;
    do {
      const std::uint32_t to = rim_[at].to;
      if (!visit(corners_[at].vertex, corners_[to].vertex)) return false;
      at = to;
    } while (at != 0);
    return true;
  }
  /// A triangle in conflict, after carve().
  mesh::TriangleSlot some_triangle() const { return triangles_.front(); }
  /// The new star, after fill().
  std::span<const mesh::TriangleSlot> star() const { return {triangles_.data(), triangle_count_}; }

 private:
  /// A corner with the height of its lift. The infinite vertex is seen at the origin, one unit up: in a
  /// determinant that leaves the orientation of the other two with the new point, which is what decides.
  struct Seen {
    std::int64_t x, y, square;
    mesh::VertexSlot vertex;
  };
  /// An edge of the cavity as it was at some time, counter-clockwise around it, with what lies beyond.
  struct Edge {
    std::int64_t cross;
    mesh::HalfEdge beyond;
    std::uint32_t from, to;  // in corners_
  };
  /// By corner, the last edge that began there.
  struct Rim {
    mesh::HalfEdge beyond;
    std::uint32_t to;
  };

  static void see(std::int64_t x, std::int64_t y, mesh::VertexSlot v, Seen& out);
  static bool tie(const mesh::Mesh& mesh, exact::Point p, const Seen& from, const Seen& to, const Seen& apex);
  void start(const mesh::Mesh& mesh, const Stop& stop);
  void enlarge();

  // Plain arrays that enlarge() doubles before they could overflow: with t triangles in conflict so far,
  // there are t + 2 corners and 2 t + 1 edges.
  std::size_t room_ = 0;  // for triangles
  std::size_t triangle_count_ = 0;
  std::vector<Seen> corners_;
  std::vector<Edge> edges_;
  std::vector<Rim> rim_;
  std::vector<mesh::TriangleSlot> triangles_;
};

/// Whether the stop is at a vertex; `vertex` becomes it.
bool at_vertex(const Stop& stop, mesh::VertexSlot& vertex);

}  // namespace tin::delaunay
