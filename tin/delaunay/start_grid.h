// Where a walk should start: a bucket grid that remembers one vertex per cell.
#pragma once

#include <cstdint>
#include <vector>

#include "tin/mesh/mesh.h"

namespace tin::delaunay {

/// A hint is never wrong, only far: the walk that starts from it decides. Reading is const and safe beside other readers.
class StartGrid {
 public:
  /// Remembers `v`; makes the grid anew, four vertices to a cell, when the mesh has outgrown it.
  void remember(const mesh::Mesh& mesh, mesh::VertexSlot v);

  /// An alive vertex that is likely near `p`. Requires: the mesh has a vertex.
  mesh::VertexSlot near(const mesh::Mesh& mesh, exact::Point p) const;

 private:
  void rebuild(const mesh::Mesh& mesh);
  std::size_t cell(exact::Point p) const;
  bool usable(const mesh::Mesh& mesh, std::uint32_t slot) const;

  exact::Point low_;
  int shift_x_ = 30, shift_y_ = 30;  // lattice units per cell, as powers of two
  std::uint32_t columns_ = 0, rows_ = 0;
  std::size_t outgrown_at_ = 0;
  std::vector<std::uint32_t> hints_;
};

}  // namespace tin::delaunay
