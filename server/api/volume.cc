// /tins/{tin}/volume and /tins/{tin}/surface-area: volumes against a level, and areas, of all or a part.
#include "server/api/answer.h"
#include "server/api/routes.h"
#include "server/api/surface_work.h"

namespace server::api {

namespace {

Result<Response> volume(Context& context, const Request& request) {
  const auto tin = context.catalogue.find(request.path_parameter("tin"));
  if (!tin) return tin.error();
  const auto level = required_number(request, "level");
  if (!level) return level.error();
  auto inputs = area_inputs_of(request, context.config.limits);
  if (!inputs) return inputs.error();
  const Slot slot(context.exports);
  if (!slot.taken()) return too_many_questions();
  const app::Version version = (*tin)->version();
  const proto::VolumeInputs all{*level, std::move(inputs->area), std::move(inputs->manner)};
  return tagged(volume_answer(version, all, "query:", nullptr), **tin, version.revision, request);
}

Result<Response> surface_area(Context& context, const Request& request) {
  const auto tin = context.catalogue.find(request.path_parameter("tin"));
  if (!tin) return tin.error();
  const auto inputs = area_inputs_of(request, context.config.limits);
  if (!inputs) return inputs.error();
  const Slot slot(context.exports);
  if (!slot.taken()) return too_many_questions();
  const app::Version version = (*tin)->version();
  return tagged(surface_area_answer(version, *inputs, "query:", nullptr), **tin, version.revision, request);
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
