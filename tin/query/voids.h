// Where a terrain has no surface: cells of its source raster that had no data.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "tin/frame/ground.h"
#include "tin/query/convex.h"
#include "tin/terrain/terrain.h"

namespace tin::query {

/// What stands where the source raster had nodata: nothing (kKeep), or the surface across (kFill).
///
/// A position is void when the source cell that holds it was void and no vertex of its triangle stands in a
/// void cell: whoever puts a vertex into a void says that there is terrain around it.
enum class Voids { kKeep, kFill };

/// A part of a segment, as fractions of it.
struct Interval {
  double from = 0, to = 1;
};

/// Borrows the terrain. Const and safe beside other readers.
class VoidMask {
 public:
  VoidMask(const terrain::Terrain& terrain, Voids voids);

  /// Whether there are voids at all.
  bool any() const { return grid_ != nullptr; }
  /// Whether the triangle (or edge) of these corners may hold positions that are void. Cost: the cells of its
  /// bounding box at worst, 64 at a time.
  bool may_touch(std::span<const mesh::VertexSlot> corners) const;
  /// Whether the cell that holds `p` is void. Requires: any().
  bool in_void_cell(exact::Point p) const;
  /// The parts of the segment outside void cells, in order, as long as they can be. Requires: any().
  /// Cost: the cells that it crosses.
  void solid_parts(frame::Place a, frame::Place b, std::vector<Interval>& out) const;
  /// The parts of a convex polygon outside void cells. Requires: any(). Cost: the cells that it meets.
  void solid_parts(const Convex& polygon, std::vector<Convex>& out) const;

 private:
  // Cells by their place in the raster, in doubles: cell i reaches from i to i + 1, columns to the right,
  // rows as stored.
  double column_at(double x) const { return (x - grid_->x0) / grid_->dx + 0.5; }
  double row_at(double y) const { return (y - grid_->y0) / grid_->dy + 0.5; }
  double x_at(double column) const { return grid_->x0 + (column - 0.5) * grid_->dx; }
  double y_at(double row) const { return grid_->y0 + (row - 0.5) * grid_->dy; }
  bool is_void_cell(double column, double row) const;
  bool any_void(std::size_t row, std::size_t first, std::size_t last) const;
  void solid_in_row(const Convex& band, double row, std::vector<Convex>& out) const;

  const terrain::Terrain& terrain_;
  const terrain::SourceGrid* grid_ = nullptr;  // null: nothing is void
};

}  // namespace tin::query
