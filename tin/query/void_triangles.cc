#include "tin/query/void_triangles.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "tin/exact/predicates.h"

namespace tin::query {

using exact::Point;
using terrain::SourceGrid;
using Corners = std::array<Point, 3>;

namespace {

bool in_void(const SourceGrid& grid, Point p) {
  const auto cell = grid.cell_at(p);
  return cell && !grid.is_valid(cell->column, cell->row);
}

/// First and last of `count` lines at `start + i * step` within [low, high]; the last may lie before the
/// first.
struct Span {
  std::int32_t first, last;
};
Span lines_within(double low, double high, std::int32_t start, std::int32_t step, std::int32_t count) {
  double a = (low - start) / step, b = (high - start) / step;
  if (a > b) std::swap(a, b);
  a = std::clamp(std::ceil(a), 0.0, static_cast<double>(count));
  b = std::clamp(std::floor(b), -1.0, static_cast<double>(count) - 1);
  return {static_cast<std::int32_t>(a), static_cast<std::int32_t>(b)};
}

/// Where the line y cuts the triangle, widened a little: the exact test comes after.
std::array<double, 2> cut(const Corners& c, double y) {
  double low = 1e300, high = -1e300;
  for (std::size_t i = 0; i < 3; ++i) {
    const Point a = c[i], b = c[(i + 1) % 3];
    if (std::min(a.y, b.y) > y || std::max(a.y, b.y) < y) continue;
    const double t = a.y == b.y ? 0 : (y - a.y) / (double(b.y) - a.y);
    const double x = a.x + t * (double(b.x) - a.x);
    low = std::min({low, x, a.y == b.y ? double(b.x) : x});
    high = std::max({high, x, a.y == b.y ? double(b.x) : x});
  }
  return {low - 1, high + 1};
}

bool holds(const Corners& c, Point p) {
  for (std::size_t i = 0; i < 3; ++i) {
    if (exact::orientation(c[i], c[(i + 1) % 3], p) < 0) return false;
  }
  return true;
}

bool holds_valid_sample(const SourceGrid& grid, const Corners& c) {
  const auto [low, high] = std::minmax({c[0].y, c[1].y, c[2].y});
  const Span rows = lines_within(low, high, grid.y0, grid.dy, grid.height);
  for (std::int32_t row = rows.first; row <= rows.last; ++row) {
    const auto [left, right] = cut(c, grid.y0 + double(row) * grid.dy);
    const Span columns = lines_within(left, right, grid.x0, grid.dx, grid.width);
    for (std::int32_t column = columns.first; column <= columns.last; ++column) {
      if (!grid.is_valid(column, row)) continue;
      const Point p = grid.centre(column, row);
      if (holds(c, p) && std::find(c.begin(), c.end(), p) == c.end()) return true;
    }
  }
  return false;
}

}  // namespace

bool has_voids(const terrain::Terrain& terrain) {
  const SourceGrid* grid = terrain.source_grid();
  return grid != nullptr && !grid->valid.empty();
}

bool over_void(const terrain::Terrain& terrain, const std::array<mesh::VertexSlot, 3>& corners) {
  if (!has_voids(terrain)) return false;
  const SourceGrid& grid = *terrain.source_grid();
  Corners points{};
  std::transform(corners.begin(), corners.end(), points.begin(),
                 [&terrain](mesh::VertexSlot corner) { return terrain.mesh().point(corner); });
  const auto third = [](std::int64_t a, std::int64_t b, std::int64_t c) {
    return static_cast<std::int32_t>((a + b + c) / 3);
  };
  const Point centroid{third(points[0].x, points[1].x, points[2].x),
                       third(points[0].y, points[1].y, points[2].y)};
  return in_void(grid, centroid) &&
         std::none_of(points.begin(), points.end(), [&grid](Point p) { return in_void(grid, p); }) &&
         !holds_valid_sample(grid, points);
}

}  // namespace tin::query
