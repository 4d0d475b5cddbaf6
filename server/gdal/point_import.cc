#include <algorithm>
#include <utility>

#include "proto/formats/frame_note.h"
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

/// The noted lattice, if the client asks for no other and it holds all that is in the file. What the note
/// says of CRS and unit is taken where nobody else says anything. Errors: as read_crs().
Result<std::optional<tin::frame::Frame>> usable_note(const ImportTask& task, RawPoints& raw,
                                                     const tin::frame::Extent& extent) {
  using Noted = std::optional<tin::frame::Frame>;
  if (!raw.noted) return Noted();
  const tin::frame::Frame& noted = *raw.noted;
  std::optional<CrsInfo> crs;
  if (!noted.crs.empty()) {
    auto read = read_crs(noted.crs);
    if (!read) return read.error();
    crs = *std::move(read);
  }
  const bool other_crs = task.asked_crs && (!crs || task.asked_crs->name != crs->name);
  if (!raw.crs) raw.crs = std::move(crs);
  if (!raw.vertical && !noted.vertical_unit.empty())
    raw.vertical = VerticalUnit{noted.vertical_unit, noted.vertical_unit_m};
  if (other_crs || task.options.resolution_x > 0 || !tin::frame::check_frame(noted, extent)) return Noted();
  return raw.noted;
}

Result<tin::frame::Frame> fitted_frame(const ImportTask& task, const RawPoints& raw,
                                       const tin::frame::Extent& extent) {
  const tin::frame::GroundScale scale = raw.crs ? raw.crs->scale : tin::frame::GroundScale{false, raw.unit_m};
  auto frame = tin::frame::fit_points(extent, scale, task.options.resolution_x, task.options.resolution_y);
  if (frame) describe_frame(*frame, raw.crs, raw.vertical);
  return frame;
}

}  // namespace

Result<void> take_note(RawPoints& raw, std::string_view note) {
  auto noted = proto::formats::read_frame_note(note);
  if (!noted) return error(Code::kMalformed, "The note on the lattice is damaged: " + noted.error().message);
  raw.noted = *std::move(noted);
  return {};
}

Result<Import> place_points(const ImportTask& task, RawPoints raw) {
  if (raw.points.empty()) return error(Code::kInvalidValue, "The file holds no points");
  const tin::frame::Extent extent = extent_of(raw.points);
  Import import;
  auto noted = usable_note(task, raw, extent);
  if (!noted) return noted.error();
  if (*noted) {
    import.frame = **std::move(noted);
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
