// The star of a vertex that is to go: its link as all deletion methods see it, and the sewing of what they
// answer.
//
//   Star star;
//   star.gather(mesh, v);
//   if (!star.leaves_a_line()) star.refill(mesh, method.fill(star), fresh);
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "tin/exact/lifted.h"
#include "tin/mesh/mesh.h"
#include "tin/removal/counters.h"

namespace tin::removal {

/// A triangle that fills the hole: three positions in the link, in the link's order. Ears come in an order in
/// which each cuts its `middle` off the polygon that is left; in the last one all three corners are what is
/// left.
struct Ear {
  std::uint32_t previous, middle, next;
};

/// No position in a link.
inline constexpr std::uint32_t kNowhere = 0xffffffffU;

/// Keeps its buffers, so that repeated use allocates nothing.
class Star {
 public:
  /// Takes the link of `v`. Requires: dimension 2.
  void gather(const mesh::Mesh& mesh, mesh::VertexSlot v);

  std::uint32_t degree() const { return degree_; }
  /// The half-edges opposite to the vertex, counter-clockwise; position i is the origin of the i-th.
  std::span<const mesh::HalfEdge> link() const { return std::span(link_).first(degree_); }
  mesh::VertexSlot vertex(std::uint32_t i) const { return vertices_[i]; }
  /// The link vertex relative to the one to be removed. Requires: i != infinite().
  const exact::Lifted& at(std::uint32_t i) const { return at_[i]; }
  /// Position of the infinite vertex; kNowhere unless the vertex lies on the hull.
  std::uint32_t infinite() const { return infinite_; }
  bool is_on_hull() const { return infinite_ != kNowhere; }

  /// Whether all other vertices of the mesh are collinear, so that no triangle would be left.
  bool leaves_a_line() const;

  /// Whether the perturbed circle of i, j, k holds l. Positions i, j, k in cyclic order, any turn: what is
  /// decided is the side of l's lift, so triangulations of the link that are not planar do no harm. Requires:
  /// distinct positions.
  template <class Tally>
  bool in_conflict(std::uint32_t i, std::uint32_t j, std::uint32_t k, std::uint32_t l, Tally& tally) const {
    tally.in_circle_test();
    if (is_on_hull()) [[unlikely]] return in_conflict_on_hull(i, j, k, l);
    return exact::lifted_sign(at_[i], at_[j], at_[k], at_[l]) > 0;
  }

  /// Replaces the star by the ears; `fresh` becomes the list of new triangles, and the vertex is released.
  /// The ears are k - 2 in number and fill the hole. Requires: the mesh is as it was in gather().
  void refill(mesh::Mesh& mesh, std::span<const Ear> ears, std::vector<mesh::TriangleSlot>& fresh);

 private:
  void walk_around(const mesh::Mesh& mesh, mesh::VertexSlot v);
  void enlarge();
  bool in_conflict_on_hull(std::uint32_t i, std::uint32_t j, std::uint32_t k, std::uint32_t l) const;
  int hull_sign(std::uint32_t a, std::uint32_t b, std::uint32_t c) const;

  mesh::VertexSlot removed_{mesh::kNone};
  std::size_t vertices_in_mesh_ = 0;
  std::uint32_t infinite_ = kNowhere;
  std::uint32_t degree_ = 0;

  // Of these the first degree_ are in use: they are larger than any link so far, since resizing them each
  // time costs.
  std::vector<mesh::HalfEdge> link_;
  std::vector<mesh::HalfEdge> clockwise_;  // while walking: the part found in the other direction
  std::vector<mesh::HalfEdge> outside_;  // the other sides of the link's edges
  std::vector<mesh::VertexSlot> vertices_;
  std::vector<exact::Lifted> at_;
};

}  // namespace tin::removal
