// Ear-queue deletion: the paper's algorithm (Devillers, "On Deletion in Delaunay Triangulations", IJCGA 2002,
// section 2.4), on the lattice, exact and canonical.
//
// The star of the removed vertex p leaves a star-shaped hole. Ears of the hole are cut off in the order in which
// an observer who rises from the lifted p crosses their planes: the smallest |power| first. (The paper's algorithm
// takes the minimum of -power, its lemma speaks of the maximum: the algorithm is right.) A hull vertex has the infinite
// vertex in its link: all finite convex ears go in power order, and what is left is the new hull.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "tin/exact/power.h"
#include "tin/mesh/mesh.h"

namespace tin::removal {

/// A triangle that fills the hole: three positions in the link, in the link's order; `middle` is cut off. In the
/// last one all three corners are what is left.
struct Ear {
  std::uint32_t previous, middle, next;
};

/// Works with buffers of its own, so that repeated removals allocate nothing. One thread at a time.
class EarQueue {
 public:
  /// Triangulates the hole that removing `v` would leave, without touching the mesh: a trial deletion. The positions
  /// in the ears index link(). Empty when the other vertices are all collinear: no triangle would be left.
  /// Requires: dimension 2. Cost: O(k log k) for degree k. The result is valid until the next call.
  std::span<const Ear> fill(const mesh::Mesh& mesh, mesh::VertexSlot v);

  /// The link of the last fill(): half-edges opposite to v, counter-clockwise; position i is its origin.
  std::span<const mesh::HalfEdge> link() const { return link_; }
  mesh::VertexSlot link_vertex(std::uint32_t i) const { return ring_[i].vertex; }

  /// Removes `v` from the mesh; `fresh` becomes the list of triangles made. False, and the mesh untouched, when the other
  /// vertices are all collinear. Requires: dimension 2.
  bool remove(mesh::Mesh& mesh, mesh::VertexSlot v, std::vector<mesh::TriangleSlot>& fresh);

 private:
  struct Node {
    mesh::VertexSlot vertex;
    exact::Point point;
    std::uint32_t previous, next;
    std::uint32_t ear;  // this node's present ear in candidates_, kNoEar if it has none
  };
  /// A snapshot: never changed once made, so that the heap's order cannot break when neighbours change.
  struct Candidate {
    exact::EarPower power;
    std::uint32_t node;
  };
  static constexpr std::uint32_t kNoEar = 0xffffffffU;
  static constexpr std::size_t kLinearLimit = 12;  // up to this degree a scan beats the heap

  void make_ring(const mesh::Mesh& mesh, mesh::VertexSlot v);
  bool leaves_a_line(const mesh::Mesh& mesh) const;
  void renew_ear(std::uint32_t node);
  std::uint32_t take_smallest();
  std::uint32_t take_by_scan();
  std::uint32_t take_from_heap();
  void cut(std::uint32_t node);
  void close_hull();

  exact::Point removed_;
  bool use_heap_ = false;
  std::uint32_t infinite_ = kNoEar;  // position of the infinite vertex in the ring
  std::uint32_t some_node_ = 0;      // a node that is still there
  std::size_t left_ = 0;
  std::vector<mesh::HalfEdge> link_;
  std::vector<Node> ring_;
  std::vector<Candidate> candidates_;
  std::vector<std::uint32_t> heap_;
  std::vector<Ear> ears_;
  std::vector<mesh::HalfEdge> outside_;
};

}  // namespace tin::removal
