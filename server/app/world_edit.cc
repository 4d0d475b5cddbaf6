#include "server/app/world_edit.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "server/gdal/crs.h"

namespace server::app {

using tin::base::Code;
using tin::base::error;
using tin::base::Result;
using tin::terrain::Edit;
using tin::terrain::Terrain;

namespace {

std::string place(std::size_t index) {
  return "/" + std::to_string(index);
}

}  // namespace

bool inserts_any(std::span<const WorldEdit> edits) {
  return std::any_of(edits.begin(), edits.end(),
                     [](const WorldEdit& edit) { return std::holds_alternative<InsertAt>(edit); });
}

Result<std::vector<Edit>> to_lattice(std::span<const WorldEdit> edits, const tin::frame::Frame& frame) {
  std::vector<Edit> out;
  out.reserve(edits.size());
  for (std::size_t i = 0; i < edits.size(); ++i) {
    const auto snapped = [&](double x, double y) {
      auto at = frame.to_lattice(x, y);
      return at ? at : Result<tin::exact::Point>(error(at.error().code, at.error().message, place(i)));
    };
    if (const auto* insert = std::get_if<InsertAt>(&edits[i])) {
      const auto at = snapped(insert->x, insert->y);
      if (!at) return at.error();
      out.emplace_back(tin::terrain::Insert{*at, insert->z});
    } else if (const auto* move = std::get_if<MoveTo>(&edits[i])) {
      const auto to = snapped(move->x, move->y);
      if (!to) return to.error();
      out.emplace_back(tin::terrain::Move{move->id, *to});
    } else if (const auto* set = std::get_if<tin::terrain::SetZ>(&edits[i])) {
      out.emplace_back(*set);
    } else {
      out.emplace_back(std::get<tin::terrain::Remove>(edits[i]));
    }
  }
  return out;
}

Result<std::shared_ptr<Terrain>> fit_frame(const tin::frame::Frame& open,
                                           const std::array<double, 2>& resolution,
                                           std::span<const WorldEdit> edits) {
  std::optional<tin::frame::Extent> extent;
  for (std::size_t i = 0; i < edits.size(); ++i) {
    const auto* insert = std::get_if<InsertAt>(&edits[i]);
    if (insert == nullptr) continue;
    if (!std::isfinite(insert->x) || !std::isfinite(insert->y)) {
      return error(Code::kNotFinite, "A coordinate is not a finite number.", place(i));
    }
    if (!extent) extent = tin::frame::Extent{insert->x, insert->y, insert->x, insert->y};
    *extent = {std::min(extent->min_x, insert->x), std::min(extent->min_y, insert->y),
               std::max(extent->max_x, insert->x), std::max(extent->max_y, insert->y)};
  }
  tin::frame::GroundScale scale;
  if (!open.crs.empty()) {
    const auto crs = gdal::read_crs(open.crs);
    if (!crs) return crs.error();
    scale = crs->scale;
  }
  auto fitted = tin::frame::fit_points(*extent, scale, resolution[0], resolution[1]);
  if (!fitted) return fitted.error();
  tin::frame::Frame frame = open;
  frame.x = fitted->x;
  frame.y = fitted->y;
  return std::make_shared<Terrain>(frame);
}

}  // namespace server::app
