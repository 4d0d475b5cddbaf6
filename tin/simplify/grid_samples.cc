#include "tin/simplify/grid_samples.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "tin/simplify/narrowing.h"
#include "tin/simplify/ranking.h"
#include "tin/simplify/spans.h"
#include "tin/simplify/whole_scan.h"

namespace tin::simplify {

using exact::Point;

namespace {

constexpr std::int32_t kTallRows = 64;  // of a triangle: then whole squares of its cells may be passed over

GridPoint cell_of(const Site& site) {
  return {site.column, site.row};
}

/// Where the line at height `y` cuts the triangle, roughly: within one lattice step.
std::pair<double, double> cut(const std::array<Point, 3>& corners, std::int32_t y) {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (std::size_t i = 0; i < 3; ++i) {
    const Point a = corners[i], b = corners[i == 2 ? 0 : i + 1];
    if (std::min(a.y, b.y) > y || std::max(a.y, b.y) < y) continue;
    const double rise = static_cast<double>(b.y) - a.y, run = static_cast<double>(b.x) - a.x;
    const double x = rise == 0 ? a.x : a.x + (static_cast<double>(y) - a.y) * run / rise;
    low = std::min(low, rise == 0 ? std::min<double>(a.x, b.x) : x);
    high = std::max(high, rise == 0 ? std::max<double>(a.x, b.x) : x);
  }
  return {low, high};
}

/// Whole numbers from below `from` to above `to` (in either order), within 0..count-1.
std::pair<std::int32_t, std::int32_t> widened(double from, double to, std::int32_t count) {
  const double low = std::floor(std::min(from, to)) - 1, high = std::ceil(std::max(from, to)) + 1;
  return {static_cast<std::int32_t>(std::clamp(low, 0.0, static_cast<double>(count))),
          static_cast<std::int32_t>(std::clamp(high, -1.0, static_cast<double>(count) - 1))};
}

/// The cells whose centres `origin + i * step` lie in low..high: the first and the last.
std::pair<std::int32_t, std::int32_t> inside(std::int64_t low, std::int64_t high, std::int64_t origin, std::int64_t step,
                                             std::int32_t count) {
  if (step < 0) return inside(-high, -low, -origin, -step, count);
  const auto floor_div = [step](std::int64_t a) { return a / step - (a % step < 0 ? 1 : 0); };
  return {static_cast<std::int32_t>(std::clamp<std::int64_t>(-floor_div(origin - low), 0, count)),
          static_cast<std::int32_t>(std::clamp<std::int64_t>(floor_div(high - origin), -1, count - 1))};
}

/// narrow() on a raster: over each row the weight of `a` and what the others make up are affine functions of the column. Heights
/// are those of the cells (`z_at`, NaN where there is none), `scale` times the corners'.
template <class ZAt>
void narrow_on_cells(const Site& a, const Site& b, const Site& c, double tolerance, double scale, const ZAt& z_at,
                     Heights& heights) {
  const double bx = b.column - a.column, by = b.row - a.row, cx = c.column - a.column, cy = c.row - a.row;
  const double turn = bx * cy - by * cx, area = std::abs(turn), sign = turn < 0 ? -1 : 1;
  const double base = a.z * scale, rise_b = sign * (b.z * scale - base), rise_c = sign * (c.z * scale - base);
  // As if `a` were at height 0 and all others that much lower.
  const double weight_x = sign * (by - cy), weight_y = sign * (cx - bx);
  const double rest_x = rise_b * cy - rise_c * by, rest_y = rise_c * bx - rise_b * cx;
  Narrowing narrowing(area, tolerance * scale);
  visit_spans(cell_of(a), cell_of(b), cell_of(c), [&](std::int32_t row, std::int32_t first, std::int32_t last) {
    const double y = row - a.row, x = first - a.column;
    double own = area + x * weight_x + y * weight_y, rest = x * rest_x + y * rest_y + base * (area - own);
    const double rest_step = rest_x - base * weight_x;
    for (std::int32_t column = first; column <= last; ++column, own += weight_x, rest += rest_step) {
      const double z = z_at(column, row);
      if (z == z) narrowing.take(own, rest, z);
    }
    return narrowing.any();
  });
  narrowing.narrow(heights, scale);
}

/// `count` cells without a sample; fewer when cancelled.
template <class T>
base::Array<T> void_cells(std::size_t count, T none, const GridKeeping& keeping) {
  constexpr std::size_t kAtOnce = base::kPaceBytes / sizeof(T);
  const base::Pace pace(keeping.memory);
  base::Array<T> out(keeping.memory);
  out.reserve(count);
  while (out.size() < count && !(keeping.progress != nullptr && keeping.progress->cancelled())) {
    out.resize(std::min(count, out.size() + kAtOnce), none);
    pace.touched(1, base::kPaceBytes);
  }
  return out;
}

}  // namespace

GridSamples::GridSamples(const terrain::SourceGrid& grid, std::vector<Facet::Corner> others,
                         const GridKeeping& keeping)
    : grid_(grid),
      others_(std::move(others), static_cast<SampleIndex>(cell_count()), keeping.progress),
      progress_(keeping.progress),
      footprint_(keeping.footprint),
      pace_(keeping.memory) {}

void GridSamples::note_scan(const Site& a, const Site& b, const Site& c) const {
  if (!pace_.is_asked_for()) return;
  const auto [low_row, high_row] = std::minmax({a.row, b.row, c.row});
  const auto [low_column, high_column] = std::minmax({a.column, b.column, c.column});
  pace_.touched(static_cast<std::size_t>(high_row - low_row) + 1,
                (static_cast<std::size_t>(high_column - low_column) + 1) * bytes_per_cell());
}

Scan GridSamples::scan(const Site& a, const Site& b, const Site& c, double tolerance, Depth depth) const {
  const bool on_cells = a.column >= 0 && b.column >= 0 && c.column >= 0;
  Scan found =
      on_cells ? scan_cells(a, b, c, tolerance, depth) : scan_between_cells(a, b, c, tolerance, depth);
  if (on_cells) note_scan(a, b, c);
  if (!others_.empty()) keep_worse(found, others_.scan(a, b, c, tolerance, depth));
  return found;
}

void GridSamples::narrow(const Site& a, const Site& b, const Site& c, double tolerance, Heights& heights) const {
  if (a.column >= 0 && b.column >= 0 && c.column >= 0) {
    narrow_cells(a, b, c, tolerance, heights);
    note_scan(a, b, c);
  } else {
    narrow_between_cells(a, b, c, tolerance, heights);
  }
  if (!others_.empty()) others_.narrow(a, b, c, tolerance, heights);
}

/// A corner is no cell centre (someone moved or added it): each cell near is asked on the lattice. Calls visit(cell, position, height)
/// until it returns false.
template <class Visit>
void GridSamples::visit_between_cells(const Site& a, const Site& b, const Site& c, const Visit& visit) const {
  const std::array<Point, 3> corners{a.at, b.at, c.at};
  const auto [low_y, high_y] = std::minmax({a.at.y, b.at.y, c.at.y});
  const auto rows = widened((static_cast<double>(low_y) - grid_.y0) / grid_.dy,
                            (static_cast<double>(high_y) - grid_.y0) / grid_.dy, grid_.height);
  for (std::int32_t row = rows.first; row <= rows.second && !cancelled(); ++row) {
    const auto [low_x, high_x] = cut(corners, grid_.centre(0, row).y);
    if (low_x > high_x) continue;
    const auto columns = widened((low_x - grid_.x0) / grid_.dx, (high_x - grid_.x0) / grid_.dx, grid_.width);
    pace_.touched(
        1, static_cast<std::size_t>(std::max(0, columns.second - columns.first + 1)) * bytes_per_cell());
    for (std::int32_t column = columns.first; column <= columns.second; ++column) {
      const SampleIndex cell = index(column, row);
      const auto z = height(cell);
      if (z && !visit(cell, grid_.centre(column, row), *z)) return;
    }
  }
}

Scan GridSamples::scan_between_cells(const Site& a, const Site& b, const Site& c, double tolerance,
                                     Depth depth) const {
  const Facet facet({a.at, a.z}, {b.at, b.z}, {c.at, c.z});
  Scan found;
  visit_between_cells(a, b, c, [&](SampleIndex cell, Point at, double z) {
    const auto weights = facet.weights(at);
    if (!weights) return true;
    const auto verdict = facet.judge(*weights, z, tolerance);
    keep_worse(found, {verdict.error, cell, !verdict.within});
    return !(found.over && depth == Depth::kFirstOver);
  });
  return found;
}

void GridSamples::narrow_between_cells(const Site& a, const Site& b, const Site& c, double tolerance,
                                       Heights& heights) const {
  LatticeNarrowing narrowing(a, b, c, tolerance);
  visit_between_cells(a, b, c, [&](SampleIndex, Point at, double z) {
    narrowing.take(at, z);
    return true;
  });
  narrowing.narrow(heights);
}

Site GridSamples::site(SampleIndex sample) const {
  if (sample >= cell_count()) return others_.site(sample);
  const auto width = static_cast<SampleIndex>(grid_.width);
  const auto column = static_cast<std::int32_t>(sample % width),
             row = static_cast<std::int32_t>(sample / width);
  pace_.touched(1, bytes_per_cell());
  return {grid_.centre(column, row), column, row, height(sample).value(), sample};
}

void GridSamples::sites(SampleIndex begin, SampleIndex end, std::vector<Site>& out) const {
  const auto width = static_cast<SampleIndex>(grid_.width);
  const SampleIndex cells = std::min(end, static_cast<SampleIndex>(cell_count()));
  auto column = static_cast<std::int32_t>(begin % width), row = static_cast<std::int32_t>(begin / width);
  for (SampleIndex sample = begin; sample < cells; ++sample) {
    const double z = height_or_nan(sample);
    if (!std::isnan(z)) out.push_back({grid_.centre(column, row), column, row, z, sample});
    if (++column < grid_.width) continue;
    column = 0;
    ++row;
  }
  if (begin < cells) pace_.touched(1, (cells - begin) * bytes_per_cell());
  for (SampleIndex sample = std::max(begin, cells); sample < end; ++sample) out.push_back(others_.site(sample));
}

Point GridSamples::position(SampleIndex sample) const {
  if (sample >= cell_count()) return others_.position(sample);
  const auto width = static_cast<SampleIndex>(grid_.width);
  return grid_.centre(static_cast<std::int32_t>(sample % width), static_cast<std::int32_t>(sample / width));
}

std::optional<SampleIndex> GridSamples::find(Point p) const {
  const auto cell = grid_.cell_centred_at(p);
  if (!cell) return others_.find(p);
  const SampleIndex found = index(cell->column, cell->row);
  return exists(found) ? std::optional(found) : std::nullopt;
}

std::optional<Site> GridSamples::beside(const Site& sample, std::int32_t columns, std::int32_t rows) const {
  if (sample.column < 0) return std::nullopt;
  const std::int32_t column = sample.column + columns, row = sample.row + rows;
  if (column < 0 || row < 0 || column >= grid_.width || row >= grid_.height) return std::nullopt;
  const SampleIndex found = index(column, row);
  const auto z = height(found);
  return z ? std::optional(Site{grid_.centre(column, row), column, row, *z, found}) : std::nullopt;
}

Extent GridSamples::extent() const {
  const Point first = grid_.centre(0, 0), last = grid_.centre(grid_.width - 1, grid_.height - 1);
  Extent out{{{std::min(first.x, last.x), std::min(first.y, last.y)}, {std::max(first.x, last.x), std::max(first.y, last.y)}},
             std::abs(grid_.dx), std::abs(grid_.dy), cell_count()};
  if (others_.empty()) return out;
  const terrain::Box box = others_.extent().box;
  out.box.min = {std::min(out.box.min.x, box.min.x), std::min(out.box.min.y, box.min.y)};
  out.box.max = {std::max(out.box.max.x, box.max.x), std::max(out.box.max.y, box.max.y)};
  return out;
}

/// The first and the last sample of each row.
void GridSamples::outermost(const terrain::Box& box, std::vector<SampleIndex>& out) const {
  const auto [first_column, last_column] = inside(box.min.x, box.max.x, grid_.x0, grid_.dx, grid_.width);
  const auto [first_row, last_row] = inside(box.min.y, box.max.y, grid_.y0, grid_.dy, grid_.height);
  for (std::int32_t row = first_row; row <= last_row; ++row) {
    std::int32_t first = first_column, last = last_column;
    while (first <= last && !height(index(first, row))) ++first;
    while (first < last && !height(index(last, row))) --last;
    if (first <= last) out.push_back(index(first, row));
    if (first < last) out.push_back(index(last, row));
    pace_.touched(2,
                  static_cast<std::size_t>(first - first_column + last_column - last + 1) * bytes_per_cell());
  }
  others_.outermost(box, out);
}

// Whole heights
// ------------------------------------------------------------------------------------------------

bool WholeGridSamples::can_hold(const terrain::SourceGrid& grid, int shift, double largest) {
  // A scan's largest numbers are below 4 * height * (twice the area) of the raster, or void * area.
  const double cells = (grid.width + 1.0) * (grid.height + 1.0), height = std::ldexp(largest, shift);
  return shift <= kMostShift && height < kMostHeight && cells < 0x1p+29 && 8 * height * cells < 0x1p+61;
}

WholeGridSamples::WholeGridSamples(const terrain::SourceGrid& grid, int shift, double largest,
                                   bool any_height, std::vector<Facet::Corner> others,
                                   const GridKeeping& keeping)
    : GridSamples(grid, std::move(others), keeping),
      shift_(shift),
      scale_(std::ldexp(1.0, shift)),
      largest_(std::ldexp(largest, shift)),
      any_height_(any_height),
      heights_(void_cells(cell_count() + WholeHeights::kRoom, WholeHeights::kVoid, keeping)),
      blocks_(grid.width, grid.height) {}

Scan WholeGridSamples::scan_cells(const Site& a, const Site& b, const Site& c, double tolerance,
                                  Depth depth) const {
  const std::int64_t bx = b.column - a.column, by = b.row - a.row, cx = c.column - a.column,
                     cy = c.row - a.row;
  const std::int64_t turn = bx * cy - by * cx;
  const std::int64_t sign = turn < 0 ? -1 : 1, area = sign * turn;
  if (area == 1 && !any_height_) return {};  // no other sample lies in it
  const std::int64_t base = whole(a.z), rise_b = sign * (whole(b.z) - base),
                     rise_c = sign * (whole(c.z) - base);
  // Over cell (x, y), counted from a: area * (interpolated - z) = area * (base - z) + x * slope_x + y *
  // slope_y.
  const std::int64_t slope_x = rise_b * cy - rise_c * by, slope_y = rise_c * bx - rise_b * cx;
  const double limit = tolerance * scale_ * static_cast<double>(area), surely_over = limit * (1 + 0x1p-40) + 1;
  const bool to_end = depth == Depth::kWorst || surely_over >= 0x1p+62;
  const WholePlane plane{cell_of(a), cell_of(b), cell_of(c), area, area * base, slope_x, slope_y};
  const std::int64_t stop = to_end ? INT64_MAX : static_cast<std::int64_t>(surely_over);
  const WholeHeights heights{heights_.data(), grid().width};
  const auto scan_all = [&] {
    if (area <= kSmallArea && !any_height_) return scan_beside_corners(heights, plane);
    const auto [low, high] = std::minmax({a.row, b.row, c.row});
    if (high - low >= kTallRows) return scan_by_blocks(heights, blocks_, plane, stop, pace());
    return doubles_suffice(plane, largest_) ? scan_by_doubles(heights, plane, stop) : scan_by_integers(heights, plane, stop);
  };
  const WorstCell worst = scan_all();
  const auto distance = static_cast<double>(worst.distance);
  // Rounding is far from the limit for nearly all; else the whole numbers decide.
  const bool doubtful = std::abs(distance - limit) <= 0x1p-48 * limit;
  const bool over = doubtful ? worst.distance > floor_product(tolerance, shift_, area) : distance > limit;
  return {distance / (static_cast<double>(area) * scale_), worst.at, over};
}

void WholeGridSamples::narrow_cells(const Site& a, const Site& b, const Site& c, double tolerance, Heights& heights) const {
  const auto z_at = [this](std::int32_t column, std::int32_t row) {
    const std::int32_t z = heights_[index(column, row)];
    return z == WholeHeights::kVoid ? std::numeric_limits<double>::quiet_NaN() : z;
  };
  narrow_on_cells(a, b, c, tolerance, scale_, z_at, heights);
}

double WholeGridSamples::height_or_nan(SampleIndex cell) const {
  if (heights_[cell] == WholeHeights::kVoid) return std::numeric_limits<double>::quiet_NaN();
  return heights_[cell] / scale_;
}

// Real heights
// -------------------------------------------------------------------------------------------------

RealGridSamples::RealGridSamples(const terrain::SourceGrid& grid, std::vector<Facet::Corner> others,
                                 const GridKeeping& keeping)
    : GridSamples(grid, std::move(others), keeping),
      heights_(void_cells(cell_count(), std::numeric_limits<double>::quiet_NaN(), keeping)) {}

Scan RealGridSamples::scan_cells(const Site& a, const Site& b, const Site& c, double tolerance,
                                 Depth depth) const {
  const double bx = b.column - a.column, by = b.row - a.row, cx = c.column - a.column, cy = c.row - a.row;
  const double turn = bx * cy - by * cx, area = std::abs(turn), sign = turn < 0 ? -1 : 1;
  const double rise_b = sign * (b.z - a.z), rise_c = sign * (c.z - a.z);
  const double slope_x = rise_b * cy - rise_c * by, slope_y = rise_c * bx - rise_b * cx;
  const double limit = std::min(tolerance, 4 * kMostHeight) * area;
  // With u = 2^-53 a distance is wrong by less than 10 u (|slope_x| x + |slope_y| y) + 4 u distance, the
  // slopes taken without cancellation; 2^-48 is 32 u.
  const double reach =
      (std::abs(rise_b * cy) + std::abs(rise_c * by)) * std::max(std::abs(bx), std::abs(cx)) +
      (std::abs(rise_c * bx) + std::abs(rise_b * cx)) * std::max(std::abs(by), std::abs(cy));
  const double slack = 0x1p-48 * (reach + limit);
  double worst = 0;
  SampleIndex at = 0;
  visit_spans(cell_of(a), cell_of(b), cell_of(c),
              [&](std::int32_t row, std::int32_t first, std::int32_t last) {
                const SampleIndex start = index(first, row);
                const double* const z = heights_.data() + start;
                const double from_y = (row - a.row) * slope_y;
                const std::int32_t from_a = first - a.column, count = last - first + 1;
                if (row % kTallRows == 0)
                  pace().touched(kTallRows, static_cast<std::size_t>(count) * sizeof(double));
                for (std::int32_t i = 0; i < count; ++i) {
                  const double distance = std::abs(from_y + (from_a + i) * slope_x - area * (z[i] - a.z));
                  if (!(distance > worst)) continue;  // also where there is no sample
                  worst = distance;
                  at = start + static_cast<SampleIndex>(i);
                }
                return !(depth == Depth::kFirstOver && worst - limit > slack) && !cancelled(row);
              });
  if (worst - limit > slack) return {worst / area, at, true};
  if (worst - limit > -slack) return judge_all(a, b, c, tolerance);
  return {worst / area, at, false};
}

void RealGridSamples::narrow_cells(const Site& a, const Site& b, const Site& c, double tolerance, Heights& heights) const {
  const auto z_at = [this](std::int32_t column, std::int32_t row) { return heights_[index(column, row)]; };
  narrow_on_cells(a, b, c, tolerance, 1, z_at, heights);
}

/// The same, each cell judged exactly.
Scan RealGridSamples::judge_all(const Site& a, const Site& b, const Site& c, double tolerance) const {
  const Facet facet({a.at, a.z}, {b.at, b.z}, {c.at, c.z});
  Scan found;
  visit_spans(cell_of(a), cell_of(b), cell_of(c),
              [&](std::int32_t row, std::int32_t first, std::int32_t last) {
                for (std::int32_t column = first; column <= last; ++column) {
                  const double z = heights_[index(column, row)];
                  const auto weights = facet.weights(grid().centre(column, row));
                  if (std::isnan(z) || !weights) continue;
                  const auto verdict = facet.judge(*weights, z, tolerance);
                  keep_worse(found, {verdict.error, index(column, row), !verdict.within});
                }
                return !cancelled(row);
              });
  return found;
}

double RealGridSamples::height_or_nan(SampleIndex cell) const {
  return heights_[cell];
}

}  // namespace tin::simplify
