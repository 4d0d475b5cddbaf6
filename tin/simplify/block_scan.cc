#include "tin/simplify/block_scan.h"

#include <algorithm>
#include <array>

namespace tin::simplify {

namespace {

/// Looks at a triangle strip by strip: the rows of one row of blocks.
class BlockScan {
 public:
  BlockScan(const WholeHeights& heights, const Blocks& blocks, const WholePlane& plane)
      : heights_(heights), blocks_(blocks), plane_(plane) {}

  /// The next row's cells; true once more of them make another strip's.
  bool begins_strip(std::int32_t row) const {
    return count_ > 0 && (row >> Blocks::kShift) != (first_row_ >> Blocks::kShift);
  }
  void add(std::int32_t row, std::int32_t first, std::int32_t last) {
    if (count_ == 0) {
      first_row_ = row;
      low_ = first;
      high_ = last;
    }
    low_ = std::min(low_, first);
    high_ = std::max(high_, last);
    rows_[count_++] = {row, first, last};
  }
  void finish_strip() {
    if (count_ == 0) return;
    for (std::int32_t block = low_ >> Blocks::kShift; block <= high_ >> Blocks::kShift; ++block)
      look_at(block);
    count_ = 0;
  }
  const WorstCell& worst() const { return worst_; }

 private:
  struct Row {
    std::int32_t row = 0, first = 0, last = 0;
  };

  void look_at(std::int32_t block) {
    const Blocks::Range range = blocks_.range(block, first_row_ >> Blocks::kShift);
    const std::int32_t from = std::max(low_, block << Blocks::kShift);
    const std::int32_t to = std::min(high_, (block << Blocks::kShift) + Blocks::kSide - 1);
    if (!range.any()) return;
    const std::int64_t most = bound(range, from, to);
    if (most == 0 || most < worst_.distance) return;
    for (std::size_t i = 0; i < count_; ++i) {
      scan(rows_[i].row, std::max(rows_[i].first, from), std::min(rows_[i].last, to));
    }
  }

  /// No cell of the strip's rows and these columns has a greater distance.
  std::int64_t bound(const Blocks::Range& range, std::int32_t from, std::int32_t to) const {
    const std::int32_t last_row = rows_[count_ - 1].row;
    const auto [low_x, high_x] =
        std::minmax({(from - plane_.a.x) * plane_.slope_x, (to - plane_.a.x) * plane_.slope_x});
    const auto [low_y, high_y] =
        std::minmax({(first_row_ - plane_.a.y) * plane_.slope_y, (last_row - plane_.a.y) * plane_.slope_y});
    const std::int64_t lowest = plane_.base + low_x + low_y, highest = plane_.base + high_x + high_y;
    return std::max(highest - plane_.area * range.low, plane_.area * range.high - lowest);
  }

  void scan(std::int32_t row, std::int32_t first, std::int32_t last) {
    const std::uint32_t start = static_cast<std::uint32_t>(row) * static_cast<std::uint32_t>(heights_.width) +
                                static_cast<std::uint32_t>(first);
    const std::int32_t* const z = heights_.z + start;
    std::int64_t over =
        plane_.base + (first - plane_.a.x) * plane_.slope_x + (row - plane_.a.y) * plane_.slope_y;
    for (std::int32_t i = 0; i <= last - first; ++i, over += plane_.slope_x) {
      const std::int64_t difference = over - plane_.area * z[i];
      const std::int64_t distance = difference < 0 ? -difference : difference;
      if (distance < worst_.distance || distance == 0 || z[i] == WholeHeights::kVoid) continue;
      const std::uint32_t at = start + static_cast<std::uint32_t>(i);
      if (distance > worst_.distance || at < worst_.at) worst_ = {distance, at};
    }
  }

  const WholeHeights& heights_;
  const Blocks& blocks_;
  const WholePlane& plane_;
  std::array<Row, Blocks::kSide> rows_;
  std::size_t count_ = 0;  // of rows
  std::int32_t first_row_ = 0, low_ = 0, high_ = 0;
  WorstCell worst_;
};

}  // namespace

WorstCell scan_by_blocks(const WholeHeights& heights, const Blocks& blocks, const WholePlane& plane,
                         std::int64_t stop, const base::Pace& pace) {
  BlockScan scan(heights, blocks, plane);
  visit_spans(plane.a, plane.b, plane.c, [&](std::int32_t row, std::int32_t first, std::int32_t last) {
    if (scan.begins_strip(row)) scan.finish_strip();
    if (scan.worst().distance > stop) return false;
    scan.add(row, first, last);
    pace.touched(1, static_cast<std::size_t>(last - first + 1) * sizeof(std::int32_t));
    return true;
  });
  scan.finish_strip();
  return scan.worst();
}

}  // namespace tin::simplify
