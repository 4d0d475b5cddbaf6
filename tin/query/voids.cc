#include "tin/query/voids.h"

#include <algorithm>
#include <cmath>

namespace tin::query {

using exact::Point;
using frame::Place;

VoidMask::VoidMask(const terrain::Terrain& terrain, Voids voids) : terrain_(terrain) {
  const terrain::SourceGrid* grid = terrain.source_grid();
  if (voids == Voids::kKeep && grid != nullptr && !grid->valid.empty()) grid_ = grid;
}

bool VoidMask::is_void_cell(double column, double row) const {
  if (!(column >= 0 && column < grid_->width && row >= 0 && row < grid_->height)) return false;
  return !grid_->is_valid(static_cast<std::int32_t>(column), static_cast<std::int32_t>(row));
}

/// Of the cells first..last of a row: whether one is void.
bool VoidMask::any_void(std::size_t row, std::size_t first, std::size_t last) const {
  const auto width = static_cast<std::size_t>(grid_->width);
  const std::size_t begin = row * width + first, end = row * width + last + 1;  // bits
  for (std::size_t at = begin; at < end;) {
    const std::size_t bit = at % 64, count = std::min<std::size_t>(64 - bit, end - at);
    const std::uint64_t ones = count == 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << count) - 1;
    if (((grid_->valid[at / 64] >> bit) & ones) != ones) return true;
    at += count;
  }
  return false;
}

bool VoidMask::in_void_cell(Point p) const {
  const auto cell = grid_->cell_at(p);
  return cell && !grid_->is_valid(cell->column, cell->row);
}

bool VoidMask::may_touch(std::span<const mesh::VertexSlot> corners) const {
  if (grid_ == nullptr) return false;
  const auto& mesh = terrain_.mesh();
  double low_c = grid_->width, high_c = -1, low_r = grid_->height, high_r = -1;
  for (const mesh::VertexSlot v : corners) {
    const Point p = mesh.point(v);
    if (in_void_cell(p)) return false;
    const double c = std::floor(column_at(p.x)), r = std::floor(row_at(p.y));
    low_c = std::min(low_c, c);
    high_c = std::max(high_c, c);
    low_r = std::min(low_r, r);
    high_r = std::max(high_r, r);
  }
  low_c = std::max(low_c, 0.0);
  low_r = std::max(low_r, 0.0);
  high_c = std::min(high_c, grid_->width - 1.0);
  high_r = std::min(high_r, grid_->height - 1.0);
  if (low_c > high_c) return false;
  for (double r = low_r; r <= high_r; ++r) {
    if (any_void(static_cast<std::size_t>(r), static_cast<std::size_t>(low_c),
                 static_cast<std::size_t>(high_c)))
      return true;
  }
  return false;
}

void VoidMask::solid_parts(Place a, Place b, std::vector<Interval>& out) const {
  out.clear();
  const double c0 = column_at(a.x), c1 = column_at(b.x), r0 = row_at(a.y), r1 = row_at(b.y);
  std::vector<double> cuts{0, 1};
  const auto cut_lines = [&cuts](double from, double to, double count) {
    if (from == to) return;
    const double low = std::max(std::ceil(std::min(from, to)), 0.0);
    const double high = std::min(std::floor(std::max(from, to)), count);
    for (double line = low; line <= high; ++line) {
      const double at = (line - from) / (to - from);
      if (at > 0 && at < 1) cuts.push_back(at);
    }
  };
  cut_lines(c0, c1, grid_->width);
  cut_lines(r0, r1, grid_->height);
  std::sort(cuts.begin(), cuts.end());
  for (std::size_t i = 1; i < cuts.size(); ++i) {
    if (cuts[i] == cuts[i - 1]) continue;
    const double middle = (cuts[i - 1] + cuts[i]) / 2;
    if (is_void_cell(std::floor(c0 + middle * (c1 - c0)), std::floor(r0 + middle * (r1 - r0)))) continue;
    if (!out.empty() && out.back().to == cuts[i - 1]) {
      out.back().to = cuts[i];
    } else {
      out.push_back({cuts[i - 1], cuts[i]});
    }
  }
}

namespace {

/// The part between two lines across an axis; both bounds in lattice steps, in either order.
template <class Ordinate>
Convex between(const Convex& polygon, double a, double b, const Ordinate& ordinate) {
  const double low = std::min(a, b), high = std::max(a, b);
  return clip(clip(polygon, [&](Place p) { return ordinate(p) - low; }),
              [&](Place p) { return high - ordinate(p); });
}

}  // namespace

void VoidMask::solid_parts(const Convex& polygon, std::vector<Convex>& out) const {
  out.clear();
  if (polygon.empty()) return;
  const auto y_of = [](Place p) { return p.y; };
  double low = grid_->height, high = 0;
  for (const Place& p : polygon) {
    low = std::min(low, row_at(p.y));
    high = std::max(high, row_at(p.y));
  }
  const double last = grid_->height;
  const auto add = [&out](const Convex& part) {
    if (!part.empty()) out.push_back(part);
  };
  if (low < 0) add(between(polygon, y_at(low - 1), y_at(0), y_of));
  for (double row = std::max(std::floor(low), 0.0); row < std::min(high, last); ++row) {
    const Convex band = between(polygon, y_at(row), y_at(row + 1), y_of);
    if (!band.empty()) solid_in_row(band, row, out);
  }
  if (high > last) add(between(polygon, y_at(last), y_at(high + 1), y_of));
}

void VoidMask::solid_in_row(const Convex& band, double row, std::vector<Convex>& out) const {
  const auto x_of = [](Place p) { return p.x; };
  double low = grid_->width, high = -1;
  for (const Place& p : band) {
    low = std::min(low, column_at(p.x));
    high = std::max(high, column_at(p.x));
  }
  // Runs of solid cells; what lies beside the raster is solid too, as if it were one wide cell.
  const double last = std::min(std::ceil(high), grid_->width + 1.0);
  const auto side = [&](double column) {
    return column < 0 ? low - 1 : column > grid_->width ? high + 1 : column;
  };
  double begin = std::max(std::floor(low), -1.0);
  for (double column = begin; column <= last; ++column) {
    if (column < last && !is_void_cell(column, row)) continue;
    if (column > begin) {
      const Convex part = between(band, x_at(side(begin)), x_at(side(column)), x_of);
      if (!part.empty()) out.push_back(part);
    }
    begin = column + 1;
  }
}

}  // namespace tin::query
