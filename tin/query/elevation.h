// Elevations on the surface of a terrain: linear in each triangle.
//
//   ElevationQuery query(terrain, Voids::kKeep);
//   if (auto found = query.at({120, 340})) use(found->z);
#pragma once

#include <array>
#include <optional>
#include <span>

#include "tin/delaunay/triangulation.h"
#include "tin/terrain/terrain.h"

namespace tin::query {

/// What stands where the source raster had nodata: nothing (kKeep), or the surface across (kFill).
///
/// A position is void when the source cell that holds it was void and no vertex of its triangle stands in a
/// void cell: whoever puts a vertex into a void says that there is terrain around it.
enum class Voids { kKeep, kFill };

struct Elevation {
  double z = 0;  // in the frame's vertical unit
  /// Counter-clockwise, the smallest id first; nothing in a terrain without triangles.
  std::optional<std::array<terrain::VertexId, 3>> triangle;
};

/// Answers queries one after another, each walk starting where the last ended. Borrows the terrain, which
/// must not change meanwhile. One thread; make one query object per thread.
class ElevationQuery {
 public:
  ElevationQuery(const terrain::Terrain& terrain, Voids voids) : terrain_(terrain), voids_(voids) {}

  /// The elevation at `p`: a vertex's own there, else linear in the triangle, or, when all vertices are
  /// collinear, along their line; nothing elsewhere and in voids. Equal for every history of the same set. On
  /// an edge either of the two triangles is named, the same one for the same mesh. Cost: the walk, expected
  /// O(1) for coherent positions.
  std::optional<Elevation> at(exact::Point p);

  /// Begins the next walk at `t`, an alive triangle: where Triangulation::locate_many() found the position.
  void start_from(mesh::TriangleSlot t) { last_ = t; }

 private:
  std::optional<Elevation> on_line(exact::Point p) const;
  bool is_void(exact::Point p, std::span<const mesh::VertexSlot> corners) const;

  const terrain::Terrain& terrain_;
  Voids voids_;
  mesh::TriangleSlot last_{mesh::kNone};
};

}  // namespace tin::query
