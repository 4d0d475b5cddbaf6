// Choosing the axes of a frame: see fit_points() and fit_raster() in frame.h.
#include <algorithm>
#include <cmath>
#include <optional>

#include "tin/frame/frame.h"

namespace tin::frame {
namespace {

using base::Code;
using base::Error;
using base::error;

constexpr double kFinestStepM = 0.001;
constexpr std::int64_t kFinestStepsPerDegree = 100'000'000;
/// Data take at most half of the lattice, so that there is room to edit outside of it.
constexpr double kDataHalf = static_cast<double>(exact::kLatticeHalf) / 2;
constexpr std::int64_t kDataSpan = exact::kLatticeHalf;
/// Coordinates beyond this belong to no CRS of the Earth, in any unit.
constexpr double kLargestCoordinate = 1e13;

std::optional<Error> check_extent(const Extent& e, const GroundScale& scale) {
  for (const double v : {e.min_x, e.min_y, e.max_x, e.max_y}) {
    if (!std::isfinite(v)) return error(Code::kNotFinite, "A coordinate is not a finite number");
    if (std::abs(v) > kLargestCoordinate) {
      return error(Code::kInvalidValue, "The coordinates are too large for any coordinate reference system");
    }
  }
  if (scale.geographic && (e.min_y < -90 || e.max_y > 90)) {
    return error(Code::kInvalidValue,
                 "Latitudes must lie between -90 and 90 degrees: is the coordinate reference system right?");
  }
  return std::nullopt;
}

/// Doubles near the data must be able to tell neighbouring lattice points apart.
std::optional<Error> check_steps(const Frame& frame, const Extent& e) {
  const auto too_fine = [](const Axis& axis, double low, double high) {
    const double largest = std::max({std::abs(low), std::abs(high), std::abs(axis.origin)});
    return axis.step() < 2 * (std::nextafter(largest, INFINITY) - largest);
  };
  if (too_fine(frame.x, e.min_x, e.max_x) || too_fine(frame.y, e.min_y, e.max_y)) {
    return error(Code::kInvalidValue, "The coordinates are too large for so fine a resolution");
  }
  return std::nullopt;
}

std::optional<Error> check_resolution(double x, double y) {
  const bool chosen = x == 0 && y == 0;
  const bool given = std::isfinite(x) && std::isfinite(y) && x > 0 && y > 0;
  if (chosen || given) return std::nullopt;
  return error(Code::kInvalidValue, "The resolution must be positive in x and in y", "resolution");
}

bool fits(const Axis& axis, double low, double high) {
  return axis.lattice(low) >= -kDataHalf && axis.lattice(high) <= kDataHalf;
}

/// The k-th of 1, 2, 5, 10, 20, 50 ...
double coarsening(int k) {
  constexpr double kSteps[] = {1, 2, 5};
  return kSteps[k % 3] * std::pow(10.0, k / 3);
}

double rounded_to(double value, double unit) {
  return std::round(value / unit) * unit;
}

/// An axis with the given step; written as 1/n of a unit where it is that, so that positions print evenly.
Axis axis_of_resolution(double resolution, double centre) {
  const double parts = std::round(1 / resolution);
  Axis axis{0, resolution, 1};
  if (parts >= 1 && parts <= 1e12 && std::abs(parts * resolution - 1) < 1e-12) {
    axis = {0, 1, static_cast<std::int64_t>(parts)};
  }
  axis.origin = rounded_to(centre, axis.unit);
  return axis;
}

/// Steps of a power of ten per CRS unit that are at most 1 mm on the ground.
std::int64_t steps_per_unit(double unit_m) {
  std::int64_t parts = 1;
  while (parts < 1'000'000'000 && unit_m / static_cast<double>(parts) > kFinestStepM * (1 + 1e-9))
    parts *= 10;
  return parts;
}

Frame chosen_axes(const Extent& e, const GroundScale& scale) {
  const double centre_x = e.min_x + (e.max_x - e.min_x) / 2;
  const double centre_y = e.min_y + (e.max_y - e.min_y) / 2;
  Frame frame;
  double round_to = 1;
  if (scale.geographic) {
    const DegreeLengths degree = degree_lengths(centre_y);
    frame.y.parts = kFinestStepsPerDegree;
    frame.x.parts = std::llround(static_cast<double>(kFinestStepsPerDegree) * degree.lon_m / degree.lat_m);
    round_to = 0.001;
  } else {
    frame.x.parts = frame.y.parts = steps_per_unit(scale.unit_m);
  }
  for (int k = 0;; ++k) {
    frame.x.unit = frame.y.unit = coarsening(k);
    const double grain = round_to * frame.x.unit;
    frame.x.origin = rounded_to(centre_x, grain);
    frame.y.origin = rounded_to(centre_y, grain);
    if (fits(frame.x, e.min_x, e.max_x) && fits(frame.y, e.min_y, e.max_y)) return frame;
  }
}

/// Lattice steps per pixel, in x and in y; nothing when no lattice can hold the raster.
struct Parts {
  std::int64_t x = 0, y = 0;
};
std::optional<Parts> divide_pixels(const RasterShape& raster, double ground_x, double ground_y) {
  const double finest = std::min({kFinestStepM, ground_x, ground_y});
  const double span =
      std::max(static_cast<double>(raster.width) * ground_x, static_cast<double>(raster.height) * ground_y);
  double factor = std::max(1.0, std::ceil(span / finest / static_cast<double>(kDataSpan)));
  for (int attempt = 0; attempt < 64; ++attempt, factor = std::ceil(factor * 1.01)) {
    const Parts parts{std::llround(ground_x / (finest * factor)), std::llround(ground_y / (finest * factor))};
    if (parts.x < 1 || parts.y < 1) return std::nullopt;
    if (parts.x <= kDataSpan / raster.width && parts.y <= kDataSpan / raster.height) return parts;
  }
  return std::nullopt;
}

std::optional<Parts> divide_as_asked(const RasterShape& raster, double resolution_x, double resolution_y) {
  const auto parts_of = [](double pixel, double resolution, std::int64_t count) -> std::int64_t {
    const double parts = std::max(1.0, std::round(pixel / resolution));
    return parts * static_cast<double>(count) <= static_cast<double>(kDataSpan) ? std::llround(parts) : 0;
  };
  const Parts parts{parts_of(raster.pixel_x, resolution_x, raster.width),
                    parts_of(raster.pixel_y, resolution_y, raster.height)};
  if (parts.x == 0 || parts.y == 0) return std::nullopt;
  return parts;
}

}  // namespace

base::Result<Frame> fit_points(const Extent& extent, const GroundScale& scale, double resolution_x,
                               double resolution_y) {
  if (auto bad = check_extent(extent, scale)) return *std::move(bad);
  if (auto bad = check_resolution(resolution_x, resolution_y)) return *std::move(bad);
  Frame frame;
  if (resolution_x == 0) {
    frame = chosen_axes(extent, scale);
  } else {
    frame.x = axis_of_resolution(resolution_x, extent.min_x + (extent.max_x - extent.min_x) / 2);
    frame.y = axis_of_resolution(resolution_y, extent.min_y + (extent.max_y - extent.min_y) / 2);
    if (!fits(frame.x, extent.min_x, extent.max_x) || !fits(frame.y, extent.min_y, extent.max_y)) {
      return error(Code::kInvalidValue, "The resolution is too fine for the extent of the data",
                   "resolution");
    }
  }
  if (auto bad = check_steps(frame, extent)) return *std::move(bad);
  return frame;
}

base::Result<void> check_frame(const Frame& frame, const Extent& extent) {
  if (auto bad = check_extent(extent, GroundScale{})) return *std::move(bad);
  for (const Axis* axis : {&frame.x, &frame.y}) {
    if (!std::isfinite(axis->origin) || !std::isfinite(axis->unit) || !std::isfinite(axis->step()))
      return error(Code::kNotFinite, "An axis of the lattice is not finite");
    if (!(axis->unit > 0) || axis->parts < 1 || !(axis->step() > 0) ||
        std::abs(axis->origin) > kLargestCoordinate)
      return error(Code::kInvalidValue, "An axis of the lattice is of no use");
  }
  for (const double x : {extent.min_x, extent.max_x}) {
    for (const double y : {extent.min_y, extent.max_y}) {
      if (const auto at = frame.to_lattice(x, y); !at) return at.error();
    }
  }
  if (auto bad = check_steps(frame, extent)) return *std::move(bad);
  return {};
}

base::Result<Frame> fit_raster(const RasterShape& raster, const GroundScale& scale, double resolution_x,
                               double resolution_y) {
  if (raster.width < 1 || raster.height < 1 || !(raster.pixel_x > 0) || !(raster.pixel_y > 0)) {
    return error(Code::kInvalidValue, "A raster needs at least one pixel, and pixels of a positive size");
  }
  const Extent extent{raster.x0, raster.y0 - static_cast<double>(raster.height - 1) * raster.pixel_y,
                      raster.x0 + static_cast<double>(raster.width - 1) * raster.pixel_x, raster.y0};
  // A global raster's outer pixel centres may lie at the poles: allow for rounding in the last place.
  Extent checked = extent;
  if (scale.geographic) {
    if (std::abs(checked.min_y + 90) < raster.pixel_y * 1e-3) checked.min_y = -90;
    if (std::abs(checked.max_y - 90) < raster.pixel_y * 1e-3) checked.max_y = 90;
  }
  if (auto bad = check_extent(checked, scale)) return *std::move(bad);
  if (auto bad = check_resolution(resolution_x, resolution_y)) return *std::move(bad);

  const DegreeLengths unit = scale.geographic ? degree_lengths((extent.min_y + extent.max_y) / 2)
                                              : DegreeLengths{scale.unit_m, scale.unit_m};
  const std::optional<Parts> parts =
      resolution_x > 0 ? divide_as_asked(raster, resolution_x, resolution_y)
                       : divide_pixels(raster, raster.pixel_x * unit.lon_m, raster.pixel_y * unit.lat_m);
  if (!parts) {
    return error(Code::kInvalidValue, "The raster has more pixels, or longer ones, than a terrain can hold");
  }
  Frame frame;
  frame.x = {raster.x0 + static_cast<double>(raster.width / 2) * raster.pixel_x, raster.pixel_x, parts->x};
  frame.y = {raster.y0 - static_cast<double>(raster.height / 2) * raster.pixel_y, raster.pixel_y, parts->y};
  if (auto bad = check_steps(frame, extent)) return *std::move(bad);
  return frame;
}

}  // namespace tin::frame
