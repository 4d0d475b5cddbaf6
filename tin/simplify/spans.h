// The cells of a raster in a triangle, row by row.
#pragma once

#include <cstdint>
#include <utility>

namespace tin::simplify {

struct GridPoint {
  std::int32_t x = 0, y = 0;
};

/// Coordinates of cells must be smaller than this in absolute value.
inline constexpr std::int32_t kMostCells = std::int32_t{1} << 18;

/// A side of a triangle: where it crosses a row, rounded to whole cells without a division, and right all the same. A crossing is a
/// multiple of one over the number of rows, so it is whole or more than 2^-19 away from what is whole; the rounding errors stay
/// below 2^-29, and kEpsilon lies between.
class Side {
 public:
  /// What is added to a crossing before it is converted, which rounds towards zero, so towards the left; kBias is then taken off.
  static constexpr std::int32_t kBias = 2 * kMostCells;
  static constexpr double kEpsilon = 0x1p-21, kToFloor = kBias + kEpsilon, kToCeil = kBias + 1 - kEpsilon;

  /// From `top` to `bottom`; a level side stays at `top`.
  Side(GridPoint top, GridPoint bottom)
      : x_(top.x), slope_(top.y == bottom.y ? 0 : static_cast<double>(bottom.x - top.x) / (bottom.y - top.y)), y_(top.y) {}
  std::int32_t floor(std::int32_t row) const { return static_cast<std::int32_t>(at(row) + kToFloor) - kBias; }
  std::int32_t ceil(std::int32_t row) const { return static_cast<std::int32_t>(at(row) + kToCeil) - kBias; }

 private:
  double at(std::int32_t row) const { return x_ + (row - y_) * slope_; }

  double x_, slope_;
  std::int32_t y_;
};

/// Sorts the corners of a triangle by row; whether the one in the middle lies on the side of greater x.
inline bool sort_by_row(GridPoint& a, GridPoint& b, GridPoint& c) {
  if (b.y < a.y) std::swap(a, b);
  if (c.y < b.y) std::swap(b, c);
  if (b.y < a.y) std::swap(a, b);
  return (std::int64_t{b.x} - a.x) * (std::int64_t{c.y} - a.y) > (std::int64_t{b.y} - a.y) * (std::int64_t{c.x} - a.x);
}

/// Calls visit(row, first, last) for each row of cells in the closed triangle, from the least row on, columns
/// first..last (not empty); stops when it returns false. Requires: not collinear; coordinates below kMostCells.
template <class Visit>
void visit_spans(GridPoint a, GridPoint b, GridPoint c, const Visit& visit) {
  const bool bend_is_right = sort_by_row(a, b, c);
  const Side through(a, c);
  const auto rows = [&](const Side& side, std::int32_t from, std::int32_t to) {
    const Side& left = bend_is_right ? through : side;
    const Side& right = bend_is_right ? side : through;
    for (std::int32_t row = from; row < to; ++row) {
      const std::int32_t first = left.ceil(row), last = right.floor(row);
      if (first <= last && !visit(row, first, last)) return false;
    }
    return true;
  };
  if (a.y < b.y && !rows(Side(a, b), a.y, b.y)) return;
  rows(Side(b, c), b.y, c.y + 1);
}

}  // namespace tin::simplify
