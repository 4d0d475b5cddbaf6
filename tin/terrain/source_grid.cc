#include "tin/terrain/source_grid.h"

namespace tin::terrain {
namespace {

/// Floor of a / b for b > 0.
std::int64_t floor_div(std::int64_t a, std::int64_t b) { return a / b - (a % b < 0 ? 1 : 0); }

}  // namespace

std::optional<SourceGrid::Cell> SourceGrid::cell_at(exact::Point p) const {
  // The pixel's area reaches half a step to each side of its centre; doubled, everything stays whole.
  const std::int64_t step_y = dy < 0 ? -std::int64_t{dy} : dy;
  const std::int64_t down = dy < 0 ? std::int64_t{y0} - p.y : std::int64_t{p.y} - y0;
  const std::int64_t column = floor_div(2 * (std::int64_t{p.x} - x0) + dx, 2 * std::int64_t{dx});
  const std::int64_t row = floor_div(2 * down + step_y, 2 * step_y);
  if (column < 0 || row < 0 || column >= width || row >= height) return std::nullopt;
  return Cell{static_cast<std::int32_t>(column), static_cast<std::int32_t>(row)};
}

std::optional<SourceGrid::Cell> SourceGrid::cell_centred_at(exact::Point p) const {
  const auto cell = cell_at(p);
  if (!cell || centre(cell->column, cell->row) != p) return std::nullopt;
  return cell;
}

}  // namespace tin::terrain
