#include "tin/query/raster.h"

#include <algorithm>
#include <cmath>

#include "tin/exact/predicates.h"
#include "tin/query/elevation.h"
#include "tin/query/surface.h"

namespace tin::query {

using exact::orientation;
using exact::Point;
using mesh::TriangleSlot;
using mesh::VertexSlot;

namespace {

constexpr std::size_t kStripValues = std::size_t{2} << 20;  // 16 MiB
constexpr std::size_t kStripRows = 64;

std::size_t rows_per_strip(std::size_t columns) {
  return std::clamp<std::size_t>(kStripValues / std::max<std::size_t>(columns, 1), 1, kStripRows);
}

}  // namespace

Rasteriser::Ordinates::Ordinates(const std::vector<std::int32_t>& values) : values_(values) {
  if (values_.size() > 1 && values_.front() > values_.back()) {
    reversed_ = true;
    std::reverse(values_.begin(), values_.end());
  }
  doubles_.assign(values_.begin(), values_.end());
  if (values_.empty()) return;
  const double length = static_cast<double>(values_.back()) - values_.front();
  if (length > 0) per_step_ = static_cast<double>(values_.size() - 1) / length;
}

std::size_t Rasteriser::Ordinates::first_from(double bound) const {
  if (values_.empty() || bound <= doubles_.front()) return 0;
  if (bound > doubles_.back()) return values_.size();
  auto i = static_cast<std::size_t>((bound - doubles_.front()) * per_step_);
  i = std::min(i, values_.size() - 1);
  while (i > 0 && doubles_[i - 1] >= bound) --i;
  while (doubles_[i] < bound) ++i;
  return i;
}

/// A triangle on its way through the rows.
struct Rasteriser::Scan {
  Scan(const terrain::Terrain& terrain, TriangleSlot t)
      : triangle(t),
        corners(canonical_corners(terrain.mesh(), t)),
        facet(terrain, corners),
        at{facet.a(), facet.b(), facet.c()} {
    low = std::min({at[0].y, at[1].y, at[2].y});
    high = std::max({at[0].y, at[1].y, at[2].y});
  }
  /// Whether pixels on the edge that starts at corner i belong to this triangle.
  bool owns(const mesh::Mesh& mesh, std::size_t i) {
    if (known[i] == 0) {
      const int apex = mesh.index_of(triangle, corners[(i + 2) % 3]);
      known[i] = owns_edge(mesh, triangle, apex) ? 1 : -1;
    }
    return known[i] > 0;
  }

  TriangleSlot triangle;
  Slots corners;
  Facet facet;
  std::array<Point, 3> at;
  std::int32_t low, high;
  std::array<int, 3> known{};
  bool may_be_void = false;
  double dz_dx = 0, dz_dy = 0;  // for gradients
};

Rasteriser::Rasteriser(const terrain::Terrain& terrain, PixelCentres centres, const RasterOptions& options,
                       double nodata)
    : terrain_(terrain),
      mesh_(terrain.mesh()),
      x_(centres.x),
      y_(centres.y),
      layer_(options.layer),
      voids_mode_(options.voids),
      nodata_(nodata),
      voids_(terrain, options.voids),
      ground_(options.ground),
      shade_(options.sun),
      strip_rows_(rows_per_strip(x_.size())),
      strips_((y_.size() + strip_rows_ - 1) / strip_rows_) {
  if (layer_ != RasterLayer::kElevation) {
    TIN_CHECK(options.ground != nullptr);
    gradient_.emplace(terrain, options.voids, *options.ground);
  }
  if (mesh_.dimension() < 2) return;
  sort_into_strips();
  sort_vertices_into_strips();
}

namespace {

/// Calls visit(item, strip) by way of `each` twice: to count, and to write each item in its place.
template <class Each>
void counting_sort(std::size_t strips, const Each& each, std::vector<std::size_t>& begins,
                   std::vector<std::uint32_t>& items) {
  begins.assign(strips + 1, 0);
  each([&](std::uint32_t, std::size_t strip) { ++begins[strip + 1]; });
  for (std::size_t i = 0; i < strips; ++i) begins[i + 1] += begins[i];
  items.resize(begins[strips]);
  std::vector<std::size_t> next(begins.begin(), begins.end() - 1);
  each([&](std::uint32_t item, std::size_t strip) { items[next[strip]++] = item; });
}

}  // namespace

void Rasteriser::sort_into_strips() {
  const auto each = [this](const auto& visit) {
    for (std::uint32_t i = 0; i < mesh_.triangle_slots(); ++i) {
      const TriangleSlot t(i);
      if (!mesh_.is_alive(t) || mesh_.is_infinite(t)) continue;
      const auto& v = mesh_.triangle(t).vertices;
      const auto [low, high] = std::minmax({mesh_.point(v[0]).y, mesh_.point(v[1]).y, mesh_.point(v[2]).y});
      const std::size_t first = y_.first_from(low);
      if (first == y_.size() || y_[first] > high) continue;
      visit(i, y_.reversed() ? strip_of(y_.first_from(high + 1.0) - 1) : strip_of(first));
    }
  };
  counting_sort(strips_, each, triangle_begins_, triangles_);
}

void Rasteriser::sort_vertices_into_strips() {
  const auto each = [this](const auto& visit) {
    for (std::uint32_t i = 1; i < mesh_.vertex_slots(); ++i) {
      if (!mesh_.is_alive(VertexSlot(i))) continue;
      const Point p = mesh_.point(VertexSlot(i));
      const std::size_t column = x_.first_from(p.x);
      if (column == x_.size() || x_[column] != p.x) continue;
      // Rows that coincide may lie in several strips.
      std::size_t last = strips_;
      for (std::size_t r = y_.first_from(p.y); r < y_.size() && y_[r] == p.y; ++r) {
        if (strip_of(r) != last) visit(i, last = strip_of(r));
      }
    }
  };
  counting_sort(strips_, each, vertex_begins_, vertices_);
}

std::size_t Rasteriser::strip_of(std::size_t r) const {
  return (y_.reversed() ? y_.size() - 1 - r : r) / strip_rows_;
}

void Rasteriser::row(std::size_t row, std::span<double> values) {
  const std::size_t strip = row / strip_rows_;
  if (strip + 1 < next_strip_) {
    next_strip_ = 0;
    active_.clear();
  }
  while (next_strip_ <= strip) make_strip(next_strip_++);
  const double* begin = at(y_.reversed() ? y_.size() - 1 - row : row, 0);
  std::copy_n(begin, x_.size(), values.begin());
}

void Rasteriser::make_strip(std::size_t strip) {
  const std::size_t begin = strip * strip_rows_, end = std::min(begin + strip_rows_, y_.size());
  strip_begin_ = y_.reversed() ? y_.size() - end : begin;
  strip_end_ = y_.reversed() ? y_.size() - begin : end;
  strip_.assign((end - begin) * x_.size(), nodata_);
  steps_.clear();
  for (std::size_t r = strip_begin_; gradient_ && r < strip_end_; ++r)
    steps_.push_back(ground_->steps_at(y_[r]));
  if (mesh_.dimension() < 2) return paint_line();
  const auto bucket = [strip](const std::vector<std::size_t>& begins,
                              const std::vector<std::uint32_t>& items) {
    return std::span(items).subspan(begins[strip], begins[strip + 1] - begins[strip]);
  };
  const auto fresh = bucket(triangle_begins_, triangles_);
  active_.insert(active_.end(), fresh.begin(), fresh.end());
  std::erase_if(active_, [this](std::uint32_t t) { return !paint(TriangleSlot(t)); });
  for (const std::uint32_t v : bucket(vertex_begins_, vertices_)) paint_vertex(VertexSlot(v));
}

/// Returns whether the triangle goes on into the next strip.
bool Rasteriser::paint(TriangleSlot t) {
  Scan scan(terrain_, t);
  scan.may_be_void = voids_.may_touch(scan.corners);
  if (gradient_) {
    scan.dz_dx = scan.facet.dz_dx();
    scan.dz_dy = scan.facet.dz_dy();
  }
  std::size_t row = std::max(y_.first_from(scan.low), strip_begin_);
  for (; row < strip_end_ && y_[row] <= scan.high; ++row) {
    std::size_t first = 0, end = x_.size();
    for (std::size_t i = 0; i < 3 && first < end; ++i) cut(scan, i, y_[row], first, end);
    if (first >= end) continue;
    paint_span(scan, row, first, end);
    if (scan.may_be_void) clear_voids(row, first, end);
  }
  if (y_.reversed()) return strip_begin_ > 0 && y_[strip_begin_ - 1] >= scan.low;
  return strip_end_ < y_.size() && y_[strip_end_] <= scan.high;
}

/// Narrows the columns down to those inside edge i of the triangle, by estimate and exact test.
void Rasteriser::cut(Scan& scan, std::size_t i, std::int32_t y, std::size_t& first, std::size_t& end) const {
  const Point u = scan.at[i], v = scan.at[(i + 1) % 3];
  const std::int64_t dx = std::int64_t{v.x} - u.x, dy = std::int64_t{v.y} - u.y, up = std::int64_t{y} - u.y;
  if (dy == 0) {
    if (up == 0 && !scan.owns(mesh_, i)) end = first;
    return;
  }
  // Beyond its own ends an edge does not bound the triangle.
  if (dy > 0 ? (up < 0 || up > dy) : (up > 0 || up < dy)) return;
  const std::int64_t across = dx * up;
  const auto side = [&](std::size_t c) { return across - dy * (std::int64_t{x_[c]} - u.x); };
  const double bound = u.x + static_cast<double>(across) / static_cast<double>(dy);
  std::size_t c = x_.first_from(bound);
  if (dy < 0) {  // the edge is on the left
    while (c > 0 && side(c - 1) >= 0) --c;
    while (c < x_.size() && side(c) < 0) ++c;
    while (c < end && side(c) == 0 && !scan.owns(mesh_, i)) ++c;
    first = std::max(first, c);
  } else {
    while (c < x_.size() && side(c) >= 0) ++c;
    while (c > 0 && side(c - 1) < 0) --c;
    while (c > first && side(c - 1) == 0 && !scan.owns(mesh_, i)) --c;
    end = std::min(end, c);
  }
}

void Rasteriser::paint_span(const Scan& scan, std::size_t row, std::size_t first, std::size_t end) {
  double* out = at(row, first);
  if (layer_ == RasterLayer::kElevation) {
    scan.facet.z_along(y_[row], {x_.doubles() + first, end - first}, out);
  } else {
    const Gradient g =
        gradient_on_ground(scan.dz_dx, scan.dz_dy, steps_[row - strip_begin_], ground_->vertical_m());
    std::fill_n(out, end - first, layer_value(layer_, g, shade_));
  }
}

void Rasteriser::clear_voids(std::size_t row, std::size_t first, std::size_t end) {
  for (std::size_t c = first; c < end; ++c) {
    if (voids_.in_void_cell({x_[c], y_[row]})) *at(row, c) = nodata_;
  }
}

void Rasteriser::paint_vertex(VertexSlot v) {
  const Point p = mesh_.point(v);
  const double value = layer_ == RasterLayer::kElevation
                           ? terrain_.z(v)
                           : layer_value(layer_, gradient_->at_vertex(v), shade_);
  for (std::size_t r = std::max(y_.first_from(p.y), strip_begin_); r < strip_end_ && y_[r] == p.y; ++r) {
    for (std::size_t c = x_.first_from(p.x); c < x_.size() && x_[c] == p.x; ++c) *at(r, c) = value;
  }
}

/// Without triangles there are elevations along a line at most.
void Rasteriser::paint_line() {
  if (layer_ != RasterLayer::kElevation || mesh_.dimension() < 0) return;
  ElevationQuery query(terrain_, voids_mode_);
  for (std::size_t r = strip_begin_; r < strip_end_; ++r) {
    for (std::size_t c = 0; c < x_.size(); ++c) {
      if (const auto found = query.at({x_[c], y_[r]})) *at(r, c) = found->z;
    }
  }
}

double layer_value(RasterLayer layer, Gradient g, const Shade& shade) {
  if (layer == RasterLayer::kSlope) return slope_degrees(g);
  if (layer == RasterLayer::kAspect) return aspect_degrees(g).value_or(-1);
  return 1 + 254 * shade(g);
}

}  // namespace tin::query
