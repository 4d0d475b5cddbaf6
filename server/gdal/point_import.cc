#include <algorithm>
#include <utility>

#include "server/gdal/import_internal.h"

namespace server::gdal {

using tin::base::Code;
using tin::base::error;
using tin::base::Result;

namespace {

tin::frame::Extent extent_of(const std::vector<RawPoint>& points) {
  tin::frame::Extent extent{points[0].x, points[0].y, points[0].x, points[0].y};
  for (const RawPoint& point : points) {
    extent.min_x = std::min(extent.min_x, point.x);
    extent.max_x = std::max(extent.max_x, point.x);
    extent.min_y = std::min(extent.min_y, point.y);
    extent.max_y = std::max(extent.max_y, point.y);
  }
  return extent;
}

/// The frame that the file notes, if it holds all that is in the file.
std::optional<tin::frame::Frame> usable_note(const RawPoints& raw, const tin::frame::Extent& extent) {
  if (!raw.frame || !tin::frame::check_frame(*raw.frame, extent)) return std::nullopt;
  return raw.frame;
}

Result<tin::frame::Frame> fitted_frame(const ImportTask& task, const RawPoints& raw,
                                       const tin::frame::Extent& extent) {
  const tin::frame::GroundScale scale = raw.crs ? raw.crs->scale : tin::frame::GroundScale{false, raw.unit_m};
  auto frame =
      tin::frame::fit_points(extent, scale, task.options.resolution_x, task.options.resolution_y);
  if (frame) describe_frame(*frame, raw.crs, raw.vertical);
  return frame;
}

}  // namespace

Result<std::optional<tin::frame::Frame>> noted_frame(const ImportTask& task, tin::frame::Frame noted) {
  using Noted = std::optional<tin::frame::Frame>;
  if (task.options.resolution_x > 0) return Noted();
  if (!noted.crs.empty()) {
    const auto crs = read_crs(noted.crs);
    if (!crs) return crs.error();
    // The name stays as it is noted: the digest is over it.
    if (task.asked_crs && task.asked_crs->name != crs->name) return Noted();
  } else if (task.asked_crs) {
    return Noted();
  }
  return Noted(std::move(noted));
}

Result<Import> place_points(const ImportTask& task, RawPoints raw) {
  if (raw.points.empty()) return error(Code::kInvalidValue, "The file holds no points");
  const tin::frame::Extent extent = extent_of(raw.points);
  Import import;
  if (auto noted = usable_note(raw, extent)) {
    import.frame = *std::move(noted);
  } else {
    auto frame = fitted_frame(task, raw, extent);
    if (!frame) return frame.error();
    import.frame = *std::move(frame);
  }
  import.driver = std::move(raw.driver);
  import.placements.reserve(raw.points.size());
  for (const RawPoint& point : raw.points) {
    if (import.placements.size() % 10000 == 0 && task.cancelled()) return cancelled_error();
    const auto at = import.frame.to_lattice(point.x, point.y);
    if (!at) return at.error();
    import.placements.push_back({*at, point.z});
  }
  return import;
}

}  // namespace server::gdal
