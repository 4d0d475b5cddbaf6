// Insertion into a mesh of dimension 2: the triangles whose perturbed circle holds the new point make way for its star
// (Bowyer, Watson).
//
// All arithmetic is done with differences to the new point, which are computed once per vertex, and each edge's
// cross product is kept for the triangle beyond it: an in-circle test then costs two cross products, one square and three wide
// products. It is exact as it stands; a floating-point filter in front of it would only cost.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "tin/delaunay/walk.h"
#include "tin/mesh/mesh.h"

namespace tin::delaunay {

/// Works with buffers of its own, so that repeated insertions allocate nothing. One thread at a time.
class Cavity {
 public:
  /// Finds the triangles in conflict with `p`, from the stop of a walk to it on. Requires: no vertex stands at p.
  /// False when one of them is not the owner's; nothing is changed here in any case.
  template <class Owner>
  bool carve(const mesh::Mesh& mesh, exact::Point p, const Stop& stop, const Owner& owner);

  /// Stars the cavity from `v`, in the slots of the triangles in conflict and these two more.
  void fill(mesh::Mesh& mesh, mesh::VertexSlot v, mesh::TriangleSlot extra1, mesh::TriangleSlot extra2);

  /// A triangle in conflict, after carve().
  mesh::TriangleSlot some_triangle() const { return triangles_.front(); }
  /// The new star, after fill().
  std::span<const mesh::TriangleSlot> star() const { return {triangles_.data(), triangle_count_}; }

 private:
  struct Seen {
    Corner at;
    std::int64_t square;
  };
  struct ToCross {
    mesh::HalfEdge edge;
    std::uint32_t from, to;  // in corners_
    std::int64_t cross;
  };
  struct Rim {
    mesh::HalfEdge outer;
    std::uint32_t from;
  };

  void start(const Stop& stop);
  void enlarge();
  static bool in_conflict(const mesh::Mesh& mesh, exact::Point p, const Seen& from, const Seen& to, const Seen& apex,
                          const ToCross& edge, std::int64_t from_apex, std::int64_t apex_to);

  // Plain arrays, all of one size that enlarge() doubles before they could overflow: with t triangles in conflict so far,
  // there are t + 2 corners, and at most as many edges to cross and as many on the rim.
  std::size_t room_ = 0;
  std::size_t corner_count_ = 0, to_cross_count_ = 0, rim_count_ = 0, triangle_count_ = 0;
  std::vector<Seen> corners_;
  std::vector<ToCross> to_cross_;
  std::vector<Rim> rim_;                         // counter-clockwise
  std::vector<mesh::TriangleSlot> triangles_;
};

/// Whether the stop is at a vertex; `vertex` becomes it.
bool at_vertex(const Stop& stop, mesh::VertexSlot& vertex);

}  // namespace tin::delaunay
