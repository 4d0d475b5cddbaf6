// /tins/{tin}/volume and /tins/{tin}/surface-area: volumes against a level, and areas, of all or a part.
#include "server/api/answer.h"
#include "server/api/routes.h"
#include "server/api/surface_work.h"

namespace server::api {

using tin::base::Code;
using tin::base::error;

namespace {

/// These take all triangles into account: a bounded number at a time, beside the rasters.
tin::base::Error busy() {
  return error(Code::kTooMany, "Too many long questions are being answered; try again.");
}

Result<Response> volume(Context& context, const Request& request) {
  const auto tin = context.catalogue.find(request.path_parameter("tin"));
  if (!tin) return tin.error();
  const auto level = required_number(request, "level");
  if (!level) return level.error();
  auto area = area_of(request, context.config.limits);
  if (!area) return area.error();
  const auto manner = manner_of(request);
  if (!manner) return manner.error();
  const Slot slot(context.exports);
  if (!slot.taken()) return busy();
  const app::Version version = (*tin)->version();
  return tagged(volume_answer(version, {*level, std::move(*area), *manner}, "query:", nullptr), **tin,
                version.revision, request);
}

Result<Response> surface_area(Context& context, const Request& request) {
  const auto tin = context.catalogue.find(request.path_parameter("tin"));
  if (!tin) return tin.error();
  auto area = area_of(request, context.config.limits);
  if (!area) return area.error();
  const auto manner = manner_of(request);
  if (!manner) return manner.error();
  const Slot slot(context.exports);
  if (!slot.taken()) return busy();
  const app::Version version = (*tin)->version();
  return tagged(surface_area_answer(version, {std::move(*area), *manner}, "query:", nullptr), **tin,
                version.revision, request);
}

}  // namespace

void add_volume(http::Router& router, Context& context) {
  using http::Method;
  router.add({.method = Method::kGet,
              .pattern = "/tins/{tin}/volume",
              .query = {"level", "bbox", "polygon", "crs", "voids"},
              .handler = guarded([&context](Request& request) { return volume(context, request); })});
  router.add({.method = Method::kGet,
              .pattern = "/tins/{tin}/surface-area",
              .query = {"bbox", "polygon", "crs", "voids"},
              .handler = guarded([&context](Request& request) { return surface_area(context, request); })});
}

}  // namespace server::api
