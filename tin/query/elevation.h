// Elevations on the surface of a terrain: linear in each triangle, or by natural neighbours.
//
//   ElevationQuery query(terrain, Voids::kKeep);
//   if (auto found = query.at({120, 340})) use(found->z);
#pragma once

#include <array>
#include <optional>

#include "tin/delaunay/triangulation.h"
#include "tin/query/natural_neighbours.h"
#include "tin/query/voids.h"
#include "tin/terrain/terrain.h"

namespace tin::query {

/// kLinear: the plane of the triangle. kNaturalNeighbour: Sibson's weights, which round the surface off (its slope jumps at
/// the vertices only) and never leave the range of the neighbours' elevations.
enum class Interpolation { kLinear, kNaturalNeighbour };

struct Elevation {
  double z = 0;  // in the frame's vertical unit
  /// Counter-clockwise, the smallest id first; nothing in a terrain without triangles.
  std::optional<std::array<terrain::VertexId, 3>> triangle;
};

/// Answers queries one after another, each walk starting where the last ended. Borrows the terrain, which
/// must not change meanwhile. One thread; make one query object per thread.
class ElevationQuery {
 public:
  ElevationQuery(const terrain::Terrain& terrain, Voids voids, Interpolation by = Interpolation::kLinear)
      : terrain_(terrain), voids_(terrain, voids), by_(by), neighbours_(terrain.mesh()) {}

  /// The elevation at `p`: a vertex's own there, else interpolated, or, when all vertices are
  /// collinear, linear along their line; nothing elsewhere and in voids. Equal for every history of the same set. On
  /// an edge either of the two triangles is named, the same one for the same mesh. Cost: the walk, expected
  /// O(1) for coherent positions; by natural neighbours also their number, about six.
  std::optional<Elevation> at(exact::Point p);

  /// Begins the next walk at `t`, an alive triangle: where Triangulation::locate_many() found the position.
  void start_from(mesh::TriangleSlot t) { last_ = t; }

 private:
  std::optional<Elevation> on_line(exact::Point p) const;
  bool is_void(exact::Point p, std::span<const mesh::VertexSlot> corners) const;
  double by_neighbours(exact::Point p, mesh::TriangleSlot t);

  const terrain::Terrain& terrain_;
  VoidMask voids_;
  Interpolation by_;
  NaturalNeighbours neighbours_;
  mesh::TriangleSlot last_{mesh::kNone};
};

}  // namespace tin::query
