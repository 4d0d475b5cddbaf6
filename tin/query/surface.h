// The surface over a triangle, and which triangle answers where two or more meet. All of it depends on the
// set of vertices only, not on how they are stored.
#pragma once

#include <array>
#include <span>

#include "tin/delaunay/triangulation.h"
#include "tin/frame/ground.h"
#include "tin/terrain/terrain.h"

namespace tin::query {

using Slots = std::array<mesh::VertexSlot, 3>;

/// Corners with the smallest position first, counter-clockwise: rounding then does not depend on storage.
Slots canonical_corners(const mesh::Mesh& mesh, mesh::TriangleSlot t);

/// Whether positions on the edge opposite to vertex `index` of the finite triangle `t` belong to it: of the
/// two at an edge it is the one whose far corner is smaller.
bool owns_edge(const mesh::Mesh& mesh, mesh::TriangleSlot t, int index);

/// The finite triangle that answers for a place inside the hull: on an edge the one that owns it, at a vertex
/// the one that follows its smallest finite neighbour counter-clockwise. Requires: dimension 2, not outside.
mesh::TriangleSlot answering_triangle(const mesh::Mesh& mesh, const delaunay::Location& where);

/// An elevation that is linear in the place.
struct Plane {
  frame::Place origin;
  double z = 0, dz_dx = 0, dz_dy = 0;
  double operator()(frame::Place p) const { return z + dz_dx * (p.x - origin.x) + dz_dy * (p.y - origin.y); }
};

/// The plane through a triangle's corners.
class Facet {
 public:
  /// `corners` as canonical_corners() gives them.
  Facet(const terrain::Terrain& terrain, const Slots& corners);

  /// Elevation at a lattice point; equal for every history of the same set. Level triangles are level to the
  /// last bit.
  double z(exact::Point p) const;
  /// For places between lattice points; rounded differently.
  Plane plane() const { return {frame::place(a_), za_, dz_dx(), dz_dy()}; }
  /// z at the lattice points of ordinate `y` and abscissas `x`, as z() has them, bit for bit. Requires: room
  /// for them in `out`.
  void z_along(std::int32_t y, std::span<const double> x, double* out) const;
  /// Change of elevation per lattice step in x and in y.
  double dz_dx() const;
  double dz_dy() const;
  exact::Point a() const { return a_; }
  exact::Point b() const { return b_; }
  exact::Point c() const { return c_; }

 private:
  exact::Point a_, b_, c_;
  double za_, rise_b_, rise_c_, area_;
};

}  // namespace tin::query
