#include "server/api/positions.h"

namespace server::api {

using tin::base::Code;
using tin::base::error;
using tin::base::Result;

namespace {
constexpr std::string_view kLonLat = "EPSG:4326";  // in GIS order: what GeoJSON calls CRS84
}

Result<Positions> Positions::between(std::string_view from, std::string_view to, std::string where) {
  Positions positions;
  if (from == to) return positions;
  if (from.empty() || to.empty()) {
    return error(Code::kInvalidValue, "The TIN has no CRS, so positions cannot be converted.",
                 std::move(where));
  }
  for (std::string_view* name : {&from, &to}) {
    if (*name == "OGC:CRS84") *name = kLonLat;
  }
  if (from == to) return positions;
  auto transform = gdal::CrsTransform::create(from, to);
  if (!transform) return error(Code::kInvalidValue, transform.error().message, std::move(where));
  positions.transform_ = std::make_unique<gdal::CrsTransform>(std::move(*transform));
  return positions;
}

Result<Positions> Positions::to_geojson(const tin::frame::Frame& frame) {
  return frame.crs.empty() ? Positions() : between(frame.crs, kLonLat, "");
}

Result<Positions> Positions::from_geojson(const tin::frame::Frame& frame) {
  return frame.crs.empty() ? Positions() : between(kLonLat, frame.crs, "");
}

bool Positions::convert(std::span<double> x, std::span<double> y, std::vector<std::uint8_t>& ok) {
  ok.assign(x.size(), 1);
  return !transform_ || transform_->transform(x, y, ok);
}

std::optional<proto::Position2> Positions::convert(proto::Position2 position) {
  if (!transform_) return position;
  std::uint8_t ok = 1;
  transform_->transform({&position.x, 1}, {&position.y, 1}, {&ok, 1});
  if (ok == 0) return std::nullopt;
  return position;
}

bool geojson_in_degrees(const tin::frame::Frame& frame) {
  return !frame.crs.empty();
}

}  // namespace server::api
