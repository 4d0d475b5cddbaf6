// Along a straight line over the mesh: every edge and vertex that it meets, decided exactly.
#pragma once

#include <optional>
#include <vector>

#include "tin/delaunay/triangulation.h"
#include "tin/query/elevation.h"
#include "tin/terrain/terrain.h"

namespace tin::query {

/// Where a line from p to q begins, crosses an edge, passes a vertex, leaves the hull, or ends.
struct Station {
  double along = 0;  // 0 at p, 1 at q; does not decrease
  frame::Place at;
  double z = 0;                             // on the surface, voids filled
  mesh::TriangleSlot to_next{mesh::kNone};  // the triangle up to the next station: on an edge its owner
};

/// Walks line after line, each from where the last ended. Borrows the terrain. One thread.
class SegmentWalk {
 public:
  explicit SegmentWalk(const terrain::Terrain& terrain)
      : terrain_(terrain), mesh_(terrain.mesh()), elevation_(terrain, Voids::kFill) {}

  /// The stations of the line from `p` to `q`, in order; none when it does not meet the hull, one when it
  /// only touches it (or p equals q). The first is p itself unless that is outside; the last is q, or where
  /// the line leaves the hull. Of a terrain without triangles: its vertices on the line, if that runs along
  /// them. Cost: O(stations), and the hull's size when p is outside.
  void stations(exact::Point p, exact::Point q, std::vector<Station>& out);

 private:
  struct Step;  // how to go on

  Step start(const delaunay::Location& where);
  Step enter_hull(mesh::TriangleSlot outside);
  Step from_vertex(mesh::VertexSlot v);
  Step from_edge(mesh::HalfEdge edge);
  Step from_inside(mesh::TriangleSlot t);
  Step along_edge(mesh::HalfEdge edge, mesh::VertexSlot to);
  Step into(mesh::HalfEdge edge);
  Step out_of(mesh::HalfEdge edge);
  Step end_in(mesh::TriangleSlot t);
  bool holds_goal(mesh::TriangleSlot t) const;
  bool ahead(exact::Point from, exact::Point v) const;
  bool reaches(exact::Point v) const;
  void add(double along, frame::Place at, double z);
  void add_point(exact::Point at, double z);
  void add_crossing(mesh::HalfEdge edge);
  void on_line();

  const terrain::Terrain& terrain_;
  const mesh::Mesh& mesh_;
  ElevationQuery elevation_;
  mesh::TriangleSlot last_{mesh::kNone};
  exact::Point p_, q_;
  std::vector<Station>* out_ = nullptr;
};

}  // namespace tin::query
