// The scan of whole heights over one triangle: the innermost loop of simplification, where most of its time goes.
//
// The distance of a cell's height from the triangle, times twice the triangle's area, is whole: an affine function of the cell
// minus area times height. So a scan is exact, in 64-bit integers, and in doubles too while nothing exceeds 2^53; then four cells
// go at a time where the processor can.
#pragma once

#include <cstddef>
#include <cstdint>

#include "tin/simplify/spans.h"

namespace tin::simplify {

/// A raster of fewer than 2^29 whole heights. There is room for three more behind the last.
struct WholeHeights {
  static constexpr std::int32_t kVoid = INT32_MIN;
  static constexpr std::size_t kRoom = 3;
  const std::int32_t* z = nullptr;
  std::int32_t width = 0;
};

/// A triangle over cells, of whole heights: distance(x, y) = |base + (x - a.x) * slope_x + (y - a.y) * slope_y - area * z|.
struct WholePlane {
  GridPoint a, b, c;
  std::int64_t area, base, slope_x, slope_y;  // area > 0: twice the triangle's, in cells
};

struct WorstCell {
  std::int64_t distance = 0;
  std::uint32_t at = 0;  // row * width + column; of equals the first
};

/// Such small triangles hold two cells at most beside their corners (Pick's theorem: interior points + half of those on the border
/// - 1 are the area).
inline constexpr std::int64_t kSmallArea = 3;
/// Looks at these cells, found without rows. Requires: plane.area <= kSmallArea; the corners are at distance 0.
WorstCell scan_beside_corners(const WholeHeights& heights, const WholePlane& plane);

/// Looks at the cells of the closed triangle; may end once a distance is above `stop`.
WorstCell scan_by_integers(const WholeHeights& heights, const WholePlane& plane, std::int64_t stop);

/// Whether scan_by_doubles() may be asked, for heights up to `largest` in absolute value.
bool doubles_suffice(const WholePlane& plane, double largest);
/// The same answer, sooner. Requires: doubles_suffice().
WorstCell scan_by_doubles(const WholeHeights& heights, const WholePlane& plane, std::int64_t stop);

}  // namespace tin::simplify
