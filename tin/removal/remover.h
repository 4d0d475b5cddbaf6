// Removing a vertex, and only trying to, by the production method.
#pragma once

#include <span>
#include <vector>

#include "tin/removal/production.h"
#include "tin/removal/star.h"

namespace tin::removal {

/// Works with buffers of its own, so that repeated removals allocate nothing. One thread at a time.
class Remover {
 public:
  /// Triangulates the hole that removing `v` would leave, without touching the mesh: a trial deletion. The
  /// positions in the ears index link(). Empty when the other vertices are all collinear: no triangle would
  /// be left. Requires: dimension 2. Cost: expected O(k) for degree k. The result is valid until the next
  /// call.
  std::span<const Ear> fill(const mesh::Mesh& mesh, mesh::VertexSlot v);

  /// The link of the last fill(): half-edges opposite to v, counter-clockwise; position i is its origin.
  std::span<const mesh::HalfEdge> link() const { return star_.link(); }
  mesh::VertexSlot link_vertex(std::uint32_t i) const { return star_.vertex(i); }

  /// Removes `v` from the mesh; `fresh` becomes the list of triangles made. False, and the mesh untouched,
  /// when the other vertices are all collinear. Requires: dimension 2.
  bool remove(mesh::Mesh& mesh, mesh::VertexSlot v, std::vector<mesh::TriangleSlot>& fresh);

 private:
  Star star_;
  Production production_;
};

}  // namespace tin::removal
