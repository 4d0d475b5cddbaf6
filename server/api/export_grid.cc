#include "server/api/export_grid.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "server/api/surface_work.h"

namespace server::api {

using tin::base::Code;
using tin::base::error;
using tin::base::Result;
using tin::frame::Extent;
using tin::query::RasterLayer;
using tin::terrain::SourceGrid;
using tin::terrain::Terrain;

namespace {

/// The largest of 1, 2 or 5 times a power of ten that is not above `value`.
double round_size_down(double value) {
  const double decade = std::pow(10.0, std::floor(std::log10(value)));
  for (const double step : {5.0, 2.0}) {
    if (step * decade <= value) return step * decade;
  }
  return decade;
}

/// About as many cells as the TIN has samples, or had in its source.
double default_cell_size(const Terrain& terrain, const Extent& extent) {
  const double width = extent.max_x - extent.min_x, height = extent.max_y - extent.min_y;
  const double longer = std::max(width, height);
  if (!(longer > 0)) return 1;
  const auto* grid = terrain.source_grid();
  if (grid != nullptr) return longer / std::max(grid->width, grid->height);
  return round_size_down(std::sqrt(std::max(width * height, longer * longer * 1e-6) /
                                   static_cast<double>(terrain.vertex_count())));
}

bool fits_float(double value) {
  return std::isnan(value) || (std::abs(value) <= std::numeric_limits<float>::max() &&
                               static_cast<double>(static_cast<float>(value)) == value);
}

tin::base::Error too_many_pixels(std::int64_t limit) {
  return error(Code::kTooLarge,
               "The raster would have more than " + std::to_string(limit) + " pixels, the limit here.",
               "query:cell-size");
}

}  // namespace

Result<Extent> extent_in(const Terrain& terrain, Positions& positions) {
  constexpr int kParts = 32;
  const auto bounds = terrain.bounds();
  if (!bounds) return error(Code::kInvalidValue, "The TIN is empty.");
  const auto& frame = terrain.frame();
  const double x0 = frame.x.world(bounds->min.x), x1 = frame.x.world(bounds->max.x);
  const double y0 = frame.y.world(bounds->min.y), y1 = frame.y.world(bounds->max.y);
  if (positions.identity()) return Extent{x0, y0, x1, y1};
  std::vector<double> x, y;
  for (int i = 0; i <= kParts; ++i) {
    const double u = static_cast<double>(i) / kParts;
    x.insert(x.end(), {x0 + u * (x1 - x0), x0 + u * (x1 - x0), x0, x1});
    y.insert(y.end(), {y0, y1, y0 + u * (y1 - y0), y0 + u * (y1 - y0)});
  }
  std::vector<std::uint8_t> ok;
  if (!positions.convert(x, y, ok)) {
    return error(Code::kInvalidValue, "The TIN's extent cannot be converted to that CRS.", "query:crs");
  }
  const auto [min_x, max_x] = std::minmax_element(x.begin(), x.end());
  const auto [min_y, max_y] = std::minmax_element(y.begin(), y.end());
  return Extent{*min_x, *min_y, *max_x, *max_y};
}

Result<ExportGrid> ExportGrid::plan(const Terrain& terrain, const ExportRequest& request) {
  const std::string& own = terrain.frame().crs;
  const std::string crs = request.crs.empty() ? own : request.crs;
  auto ground = ground_of(terrain);
  if (!ground) return ground.error();
  ExportGrid grid(terrain, request, std::make_unique<tin::frame::Ground>(*ground));
  grid.spec_.crs = crs;
  grid.spec_.vertical_unit = terrain.frame().vertical_unit;
  if (terrain.vertex_count() == 0) return error(Code::kInvalidValue, "The TIN is empty.");
  if (request.cell_size && !(*request.cell_size > 0)) {
    return error(Code::kInvalidValue, "The cell size must be greater than 0.", "query:cell-size");
  }
  const auto* source = terrain.source_grid();
  const bool same = source != nullptr && crs == own && !request.cell_size;
  auto laid = same ? grid.take_source_grid(*source, request) : grid.lay_new_grid(request, crs);
  if (!laid) return laid.error();
  grid.choose_values();
  const bool along_lattice = grid.source_ != nullptr || grid.to_own_->identity();
  if (along_lattice && request.interpolation == tin::query::Interpolation::kLinear) grid.scan();
  return grid;
}

/// The source's grid, or the pixels of it whose centres lie in the box.
Result<void> ExportGrid::take_source_grid(const SourceGrid& grid, const ExportRequest& request) {
  if (std::int64_t{grid.width} * grid.height > request.max_pixels && !request.box)
    return too_many_pixels(request.max_pixels);
  if (!request.box) {
    take_source_window(grid, 0, 0, grid.width, grid.height);
    return {};
  }
  // Centres lie at gt[0] + (column + 1/2) * gt[1]; rows alike.
  const auto window = [](double low, double high, double origin, double step, std::int64_t count) {
    double first = (low - origin) / step - 0.5, last = (high - origin) / step - 0.5;
    if (first > last) std::swap(first, last);
    first = std::clamp(std::ceil(first - 1e-9), 0.0, static_cast<double>(count));
    last = std::clamp(std::floor(last + 1e-9), -1.0, static_cast<double>(count) - 1);
    return std::pair<std::int64_t, std::int64_t>(static_cast<std::int64_t>(first),
                                                 static_cast<std::int64_t>(last - first) + 1);
  };
  const auto& gt = grid.geotransform;
  const auto [column, width] = window(request.box->min_x, request.box->max_x, gt[0], gt[1], grid.width);
  const auto [row, height] = window(request.box->min_y, request.box->max_y, gt[3], gt[5], grid.height);
  if (width <= 0 || height <= 0) {
    return error(Code::kInvalidValue, "The box holds no pixel centre of the source raster.", "query:bbox");
  }
  if (width * height > request.max_pixels) return too_many_pixels(request.max_pixels);
  take_source_window(grid, column, row, width, height);
  return {};
}

void ExportGrid::take_source_window(const SourceGrid& grid, std::int64_t column, std::int64_t row,
                                    std::int64_t width, std::int64_t height) {
  source_ = &grid;
  first_column_ = column;
  first_row_ = row;
  spec_.width = width;
  spec_.height = height;
  spec_.geotransform = grid.geotransform;
  if (column != 0) spec_.geotransform[0] += static_cast<double>(column) * grid.geotransform[1];
  if (row != 0) spec_.geotransform[3] += static_cast<double>(row) * grid.geotransform[5];
}

/// A north-up grid of square cells over the box or the terrain's extent.
Result<void> ExportGrid::lay_new_grid(const ExportRequest& request, const std::string& crs) {
  const std::string& own = terrain_->frame().crs;
  auto from_own = Positions::between(own, crs, "query:crs");
  if (!from_own) return from_own.error();
  auto to_own = Positions::between(crs, own, "query:crs");
  if (!to_own) return to_own.error();
  to_own_ = std::move(*to_own);
  const auto whole = extent_in(*terrain_, *from_own);
  if (!whole) return whole.error();
  Extent extent = *whole;
  if (const auto* source = terrain_->source_grid(); source != nullptr && from_own->identity()) {
    // The source's whole area, so that its own cell size gives its own grid.
    const auto& gt = source->geotransform;
    const double x1 = gt[0] + source->width * gt[1], y1 = gt[3] + source->height * gt[5];
    extent = {std::min({gt[0], x1, whole->min_x}), std::min({gt[3], y1, whole->min_y}),
              std::max({gt[0], x1, whole->max_x}), std::max({gt[3], y1, whole->max_y})};
  }
  if (request.box) extent = {request.box->min_x, request.box->min_y, request.box->max_x, request.box->max_y};
  const double cell = request.cell_size.value_or(default_cell_size(*terrain_, *whole));
  const auto count = [cell](double length) { return std::max(1.0, std::ceil(length / cell - 1e-9)); };
  const double width = count(extent.max_x - extent.min_x), height = count(extent.max_y - extent.min_y);
  if (!(width * height <= static_cast<double>(request.max_pixels)))
    return too_many_pixels(request.max_pixels);
  spec_.width = static_cast<std::int64_t>(width);
  spec_.height = static_cast<std::int64_t>(height);
  spec_.geotransform = {extent.min_x, cell, 0, extent.max_y, 0, -cell};
  return {};
}

void ExportGrid::choose_values() {
  if (request_.layer == RasterLayer::kElevation) return choose_elevation_values();
  spec_.data_type = "Float32";
  spec_.nodata = -9999;
  spec_.vertical_unit = request_.layer == RasterLayer::kHillshade ? "" : "degree";
}

/// Data type and nodata: the source's own where they can be, so that a round trip changes neither.
void ExportGrid::choose_elevation_values() {
  const auto* source = terrain_->source_grid();
  const bool wide = source != nullptr && (source->data_type == "Float64" || source->data_type == "Int32" ||
                                          source->data_type == "UInt32");
  spec_.data_type = wide ? "Float64" : "Float32";
  const auto range = terrain_->z_range();
  const auto free = [&](double value) {
    return std::isnan(value) || ((wide || fits_float(value)) && (value < range->min || value > range->max));
  };
  spec_.nodata = -static_cast<double>(std::numeric_limits<float>::max());
  if (free(-9999)) spec_.nodata = -9999;
  if (source != nullptr && source->nodata && free(*source->nodata)) spec_.nodata = *source->nodata;
}

/// Pixels whose rows and columns run along the lattice's axes: each at the nearest lattice point, as a query there.
void ExportGrid::scan() {
  constexpr std::int32_t kBeyond = std::int32_t{1} << 30;
  const auto on_lattice = [](double at) {
    return static_cast<std::int32_t>(std::llround(std::clamp(at, -double(kBeyond), double(kBeyond))));
  };
  const auto& gt = spec_.geotransform;
  const auto& frame = terrain_->frame();
  tin::query::PixelCentres centres;
  for (std::int64_t c = 0; c < spec_.width; ++c) {
    const auto column = static_cast<std::int32_t>(first_column_ + c);
    centres.x.push_back(source_ != nullptr ? source_->centre(column, 0).x
                                           : on_lattice(frame.x.lattice(gt[0] + (static_cast<double>(c) + 0.5) * gt[1])));
  }
  for (std::int64_t r = 0; r < spec_.height; ++r) {
    const auto row = static_cast<std::int32_t>(first_row_ + r);
    centres.y.push_back(source_ != nullptr ? source_->centre(0, row).y
                                           : on_lattice(frame.y.lattice(gt[3] + (static_cast<double>(r) + 0.5) * gt[5])));
  }
  const tin::query::RasterOptions options{request_.layer, request_.voids, request_.sun, ground_.get()};
  raster_ = std::make_unique<tin::query::Rasteriser>(*terrain_, std::move(centres), options, spec_.nodata);
}

std::optional<double> ExportGrid::value_at(tin::exact::Point p) {
  if (request_.layer == RasterLayer::kElevation) {
    const auto found = query_.at(p);
    return found ? std::optional(found->z) : std::nullopt;
  }
  const auto found = gradient_.at(p);
  if (!found) return std::nullopt;
  return tin::query::layer_value(request_.layer, *found, shade_);
}

void ExportGrid::sample_row(std::int64_t row, std::span<double> values) {
  if (raster_) return raster_->row(static_cast<std::size_t>(row), values);
  if (source_ != nullptr) {
    for (std::size_t i = 0; i < values.size(); ++i) {
      const auto column = static_cast<std::int32_t>(first_column_ + static_cast<std::int64_t>(i));
      values[i] = value_at(source_->centre(column, static_cast<std::int32_t>(first_row_ + row))).value_or(spec_.nodata);
    }
    return;
  }
  const auto& gt = spec_.geotransform;
  x_.resize(values.size());
  y_.assign(values.size(), gt[3] + (static_cast<double>(row) + 0.5) * gt[5]);
  for (std::size_t i = 0; i < values.size(); ++i) x_[i] = gt[0] + (static_cast<double>(i) + 0.5) * gt[1];
  to_own_->convert(x_, y_, ok_);
  for (std::size_t i = 0; i < values.size(); ++i) {
    values[i] = spec_.nodata;
    if (ok_[i] == 0) continue;
    const auto at = terrain_->frame().to_lattice(x_[i], y_[i]);
    if (at) values[i] = value_at(*at).value_or(spec_.nodata);
  }
}

}  // namespace server::api
