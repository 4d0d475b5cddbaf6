// The cells of a raster in a triangle, row by row.
#pragma once

#include <cstdint>
#include <utility>

namespace tin::simplify {

struct GridPoint {
  std::int32_t x = 0, y = 0;
};

/// Walks down one side of a triangle, a row at a time, and knows where it is: floor and fraction. One
/// division per side.
class SideWalk {
 public:
  /// From `top` to `bottom`; a level side stays at `top`.
  SideWalk(GridPoint top, GridPoint bottom) : x_(top.x), rows_(bottom.y - top.y) {
    if (rows_ == 0) return;
    const std::int64_t across = std::int64_t{bottom.x} - top.x;
    whole_ = across / rows_;
    part_ = across % rows_;
    if (part_ < 0) {
      --whole_;
      part_ += rows_;
    }
  }
  std::int64_t floor() const { return x_; }
  std::int64_t ceil() const { return x_ + (fraction_ > 0 ? 1 : 0); }
  void step() {
    x_ += whole_;
    fraction_ += part_;
    if (fraction_ >= rows_) {
      fraction_ -= rows_;
      ++x_;
    }
  }

 private:
  std::int64_t x_, rows_;
  std::int64_t whole_ = 0, part_ = 0;
  std::int64_t fraction_ = 0;  // of rows_
};

/// Calls visit(row, first, last) for each row of cells in the closed triangle, from the least row on, columns
/// first..last (not empty); stops when it returns false. Requires: not collinear.
template <class Visit>
void visit_spans(GridPoint a, GridPoint b, GridPoint c, const Visit& visit) {
  if (b.y < a.y) std::swap(a, b);
  if (c.y < b.y) std::swap(b, c);
  if (b.y < a.y) std::swap(a, b);
  const std::int64_t turn = (std::int64_t{b.x} - a.x) * (std::int64_t{c.y} - a.y) -
                            (std::int64_t{b.y} - a.y) * (std::int64_t{c.x} - a.x);
  const bool bend_is_right = turn > 0;  // b lies on the side of greater x
  SideWalk through(a, c);
  const auto rows = [&](SideWalk side, std::int32_t from, std::int32_t to) {
    for (std::int32_t row = from; row < to; ++row) {
      const SideWalk& left = bend_is_right ? through : side;
      const SideWalk& right = bend_is_right ? side : through;
      const auto first = static_cast<std::int32_t>(left.ceil()),
                 last = static_cast<std::int32_t>(right.floor());
      if (first <= last && !visit(row, first, last)) return false;
      through.step();
      side.step();
    }
    return true;
  };
  if (!rows(SideWalk(a, b), a.y, b.y)) return;
  rows(SideWalk(b, c), b.y, c.y + 1);
}

}  // namespace tin::simplify
