// Natural neighbours (Sibson 1981): the vertices whose Voronoi cells a new vertex would take area from,
// weighted by how much it takes from each.
#pragma once

#include <span>
#include <vector>

#include "tin/exact/point.h"
#include "tin/mesh/mesh.h"

namespace tin::query {

/// Works with buffers of its own. Borrows the mesh. One thread.
///
/// Which triangles make way for the point is decided exactly, as by an insertion, and every corner of the
/// Voronoi cells is an exact quotient of 128-bit integers before it is rounded; only the areas are
/// floating-point. So the weights hold near vertices and on grids, where circles coincide by the dozen.
class NaturalNeighbours {
 public:
  struct Weight {
    mesh::VertexSlot vertex;
    double weight;
  };

  explicit NaturalNeighbours(const mesh::Mesh& mesh) : mesh_(mesh) {}

  /// The neighbours of `p` in a fixed order, counter-clockwise from the smallest position on, and their
  /// weights, which are not negative (but for rounding) and sum up to 1. At a vertex it is alone, and on the
  /// hull the edge's two ends share, which is the limit from inside. Valid until the next call. Requires:
  /// dimension 2; `p` in the closed finite triangle `t`. Cost: O(k) for k neighbours.
  std::span<const Weight> at(exact::Point p, mesh::TriangleSlot t);

 private:
  bool at_corner_or_hull(exact::Point p, mesh::TriangleSlot t);
  void carve(exact::Point p, mesh::TriangleSlot t);
  void expand(exact::Point p, mesh::HalfEdge edge);
  double stolen(exact::Point p, mesh::HalfEdge before, mesh::HalfEdge after) const;

  const mesh::Mesh& mesh_;
  std::vector<mesh::HalfEdge> rim_;  // edges of the triangles that make way, counter-clockwise
  std::vector<mesh::HalfEdge> to_cross_;
  std::vector<Weight> weights_;
};

}  // namespace tin::query
