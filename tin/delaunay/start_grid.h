// Where a walk should start, the quick way: a bucket grid that remembers one triangle per cell.
#pragma once

#include <cstdint>
#include <vector>

#include "tin/mesh/mesh.h"

namespace tin::delaunay {

/// How many triangles a walk from a hint may cross before the hierarchy is asked.
inline constexpr std::uint32_t kPatience = 64;

/// A hint is never wrong, only far: the walk that starts from it decides. Hints are not kept up to date when
/// triangles go: a slot used again mostly serves nearby, and one that does not is seen to be far. Cells that
/// hold many vertices have no hint, nor have empty regions; there the hierarchy is asked. Reading is const
/// and safe beside other readers.
class StartGrid {
 public:
  /// Remembers `t` for the place `p`. Makes the grid anew when the mesh has outgrown it or left it too large.
  void remember(const mesh::Mesh& mesh, exact::Point p, mesh::TriangleSlot t);
  /// Makes the grid anew, one or two vertices to a cell.
  void rebuild(const mesh::Mesh& mesh) {
    lay_out(mesh, mesh.vertex_count());
    fill(mesh);
  }
  /// The two halves of that. The first sees only points, so it may run while a mesh is built: then `count` is
  /// that of all slots, which the mesh does not yet know to be alive. The second needs the triangles.
  void lay_out(const mesh::Mesh& mesh, std::size_t count);
  void fill(const mesh::Mesh& mesh);
  /// A walk from the hint for `p` was long: the cell has become crowded, and gives none until the grid is
  /// made anew.
  void give_up(exact::Point p);
  /// Whether remember() or a removal has left the grid of the wrong size.
  bool outdated(const mesh::Mesh& mesh) const {
    return mesh.vertex_count() > outgrown_at_ || mesh.vertex_count() < too_large_at_;
  }

  /// An alive triangle (infinite ones too) that is likely near `p`; kNone when there is no good hint.
  mesh::TriangleSlot near(const mesh::Mesh& mesh, exact::Point p) const;

  // For batches that fetch ahead: the cell of `p`, then its triangle.
  void prefetch_cell(exact::Point p) const {
    if (!hints_.empty()) __builtin_prefetch(&hints_[cell(p)]);
  }
  /// The remembered triangle's slot, unchecked; kNone without one.
  mesh::TriangleSlot hint(exact::Point p) const {
    return mesh::TriangleSlot(hints_.empty() ? mesh::kNone : hints_[cell(p)]);
  }

  std::size_t bytes() const { return hints_.capacity() * sizeof(std::uint32_t); }

 private:
  void fit(const mesh::Mesh& mesh, std::size_t count);
  std::size_t cell(exact::Point p) const { return y_.cell(p.y) * x_.count + x_.cell(p.x); }

  /// One axis: `count` cells over [low, low + last].
  struct Axis {
    std::int64_t low = 0, last = 0;
    std::uint32_t count = 1;
    std::uint64_t scale = 0;  // cells per lattice unit, in units of 2^-32
    std::size_t cell(std::int32_t at) const {
      const std::int64_t offset = at - low;
      const auto inside = static_cast<std::uint64_t>(offset < 0 ? 0 : offset > last ? last : offset);
      return static_cast<std::size_t>(inside * scale >> 32);
    }
  };
  static Axis make_axis(std::int64_t low, std::int64_t high, double side);

  Axis x_, y_;
  std::int64_t reach_ = 0;  // how far a hint that is worth following may be
  std::size_t outgrown_at_ = 16;
  std::size_t too_large_at_ = 0;
  std::vector<std::uint32_t> hints_;
};

}  // namespace tin::delaunay
