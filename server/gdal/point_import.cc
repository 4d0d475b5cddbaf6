#include <algorithm>

#include "server/gdal/import_internal.h"

namespace server::gdal {

using tin::base::Code;
using tin::base::error;
using tin::base::Result;

Result<Import> place_points(const ImportTask& task, RawPoints raw) {
  if (raw.points.empty()) return error(Code::kInvalidValue, "The file holds no points");
  tin::frame::Extent extent{raw.points[0].x, raw.points[0].y, raw.points[0].x, raw.points[0].y};
  for (const RawPoint& point : raw.points) {
    extent.min_x = std::min(extent.min_x, point.x);
    extent.max_x = std::max(extent.max_x, point.x);
    extent.min_y = std::min(extent.min_y, point.y);
    extent.max_y = std::max(extent.max_y, point.y);
  }
  auto frame = tin::frame::fit_points(extent, raw.crs ? raw.crs->scale : tin::frame::GroundScale{},
                                      task.options.resolution_x, task.options.resolution_y);
  if (!frame) return frame.error();

  Import import;
  import.frame = *std::move(frame);
  import.driver = std::move(raw.driver);
  describe_frame(import.frame, raw.crs, std::nullopt);
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
