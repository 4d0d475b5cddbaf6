// Positions in square cells, to find those in a box.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "tin/exact/point.h"

namespace tin::terrain {

/// The indices 0 .. count - 1 by where they are; some may be dropped. Memory: 5 to 9 bytes each.
class PositionBuckets {
 public:
  /// Requires: count < 2^32. Cost: linear.
  template <class PositionOf>
  PositionBuckets(std::size_t count, const PositionOf& position_of) {
    if (count == 0) return;
    low_ = high_ = position_of(0);
    for (std::size_t i = 1; i < count; ++i) {
      const exact::Point p = position_of(i);
      low_ = {std::min(low_.x, p.x), std::min(low_.y, p.y)};
      high_ = {std::max(high_.x, p.x), std::max(high_.y, p.y)};
    }
    const double width = 1.0 + high_.x - low_.x, height = 1.0 + high_.y - low_.y;
    side_ = std::max(1.0, std::sqrt(width * height / (1.0 + static_cast<double>(count) / kInACell)));
    side_ = std::max(side_, std::max(width, height) / kMostInARow);
    columns_ = cell_of(high_.x, low_.x) + 1;
    const std::size_t cells = columns_ * (cell_of(high_.y, low_.y) + 1);
    begins_.assign(cells + 1, 0);
    const auto cell = [&](std::size_t i) {
      const exact::Point p = position_of(i);
      return cell_of(p.y, low_.y) * columns_ + cell_of(p.x, low_.x);
    };
    for (std::size_t i = 0; i < count; ++i) ++begins_[cell(i) + 1];
    for (std::size_t c = 0; c < cells; ++c) begins_[c + 1] += begins_[c];
    ends_.assign(begins_.begin(), begins_.end() - 1);
    items_.resize(count);
    for (std::size_t i = 0; i < count; ++i) items_[ends_[cell(i)]++] = static_cast<std::uint32_t>(i);
  }

  /// Calls drop(i) for those in the cells of the box, which may lie outside of it; those for which it says true are met no more.
  template <class Drop>
  void visit(exact::Point low, exact::Point high, const Drop& drop) {
    low = {std::max(low.x, low_.x), std::max(low.y, low_.y)};
    high = {std::min(high.x, high_.x), std::min(high.y, high_.y)};
    if (items_.empty() || low.x > high.x || low.y > high.y) return;
    for (std::size_t row = cell_of(low.y, low_.y); row <= cell_of(high.y, low_.y); ++row) {
      for (std::size_t column = cell_of(low.x, low_.x); column <= cell_of(high.x, low_.x); ++column) {
        const std::size_t c = row * columns_ + column;
        for (std::uint32_t at = begins_[c]; at < ends_[c];) {
          if (drop(std::size_t{items_[at]})) {
            std::swap(items_[at], items_[--ends_[c]]);
          } else {
            ++at;
          }
        }
      }
    }
  }

 private:
  static constexpr double kInACell = 4, kMostInARow = 1 << 14;

  std::size_t cell_of(std::int32_t value, std::int32_t low) const {
    return static_cast<std::size_t>((static_cast<double>(value) - low) / side_);
  }

  exact::Point low_, high_;
  double side_ = 1;
  std::size_t columns_ = 0;
  std::vector<std::uint32_t> begins_, ends_, items_;
};

}  // namespace tin::terrain
