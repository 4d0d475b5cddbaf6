// The scan of whole heights over a large triangle: squares of cells that cannot hold the worst one are passed
// over, so that over water and other even ground it costs a small part of the triangle's area.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "tin/base/array.h"
#include "tin/simplify/whole_scan.h"

namespace tin::simplify {

/// The least and the greatest height of each square of 16 x 16 cells: 8 bytes for 256 cells.
class Blocks {
 public:
  static constexpr int kShift = 4;
  static constexpr std::int32_t kSide = 1 << kShift;
  struct Range {
    std::int32_t low = std::numeric_limits<std::int32_t>::max(),
                 high = std::numeric_limits<std::int32_t>::min();
    bool any() const { return low <= high; }
  };

  Blocks(std::int32_t width, std::int32_t height)
      : columns_(((width - 1) >> kShift) + 1),
        ranges_(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(((height - 1) >> kShift) + 1)) {
  }

  void put(std::int32_t column, std::int32_t row, std::int32_t z) {
    Range& range = ranges_[at(column >> kShift, row >> kShift)];
    if (z < range.low) range.low = z;
    if (z > range.high) range.high = z;
  }
  const Range& range(std::int32_t block_column, std::int32_t block_row) const {
    return ranges_[at(block_column, block_row)];
  }

 private:
  std::size_t at(std::int32_t block_column, std::int32_t block_row) const {
    return static_cast<std::size_t>(block_row) * static_cast<std::size_t>(columns_) +
           static_cast<std::size_t>(block_column);
  }

  std::int32_t columns_;
  std::vector<Range> ranges_;
};

/// The answer of scan_by_integers(), sooner where most heights are near the triangle. Requires: `blocks` of
/// these heights, `pace` of their memory.
WorstCell scan_by_blocks(const WholeHeights& heights, const Blocks& blocks, const WholePlane& plane,
                         std::int64_t stop, const base::Pace& pace = {});

}  // namespace tin::simplify
