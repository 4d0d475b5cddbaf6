#include "server/api/export_coordinates.h"

#include <utility>

#include "proto/crs_uri.h"
#include "proto/formats/frame_note.h"

namespace server::api {

using proto::formats::Coordinates;
using proto::formats::MeshRequest;
using tin::base::Result;

namespace {

constexpr const char* kWhere = "query:crs";

Result<gdal::CrsInfo> known_crs(const std::string& name) {
  auto crs = gdal::read_crs(name);
  if (!crs) return tin::base::error(tin::base::Code::kInvalidValue, crs.error().message, kWhere);
  return crs;
}

}  // namespace

Result<MeshRequest> mesh_request(const tin::frame::Frame& frame, const std::string& crs) {
  MeshRequest request;
  request.crs = crs.empty() ? frame.crs : crs;
  if (!request.crs.empty()) {
    const auto known = known_crs(request.crs);
    if (!known) return known.error();
    request.geographic = known->scale.geographic;
    request.unit_m = known->scale.unit_m;
  }
  auto positions = Positions::between(frame.crs, request.crs, kWhere);
  if (!positions) return positions.error();
  if (positions->identity()) return request;
  request.convert = [shared = std::make_shared<Positions>(std::move(*positions))](
                        std::span<double> x, std::span<double> y, std::vector<std::uint8_t>& ok) {
    return shared->convert(x, y, ok);
  };
  return request;
}

Result<GeoJsonCoordinates> geojson_coordinates(const tin::frame::Frame& frame, const std::string& crs) {
  auto positions = Positions::to_geojson(frame);
  Coordinates rounding = geojson_in_degrees(frame) ? Coordinates::kDegrees : Coordinates::kProjected;
  proto::formats::CollectionHead head;
  if (!crs.empty()) {
    const auto known = known_crs(crs);
    if (!known) return known.error();
    positions = Positions::between(frame.crs, known->name, kWhere);
    rounding = known->scale.geographic ? Coordinates::kDegrees : Coordinates::kProjected;
    if (known->name != "EPSG:4326") head.crs_urn = proto::crs_urn(known->name);
  }
  if (!positions) return positions.error();
  if (positions->identity()) {
    rounding = Coordinates::kExact;
    head.frame_note = proto::formats::frame_note(frame);
  }
  return GeoJsonCoordinates{std::move(*positions), rounding, std::move(head)};
}

}  // namespace server::api
