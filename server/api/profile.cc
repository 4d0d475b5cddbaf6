// /tins/{tin}/profile and /tins/{tin}/line-of-sight: the surface along a line.
#include "server/api/answer.h"
#include "server/api/routes.h"
#include "server/api/surface_work.h"

namespace server::api {

using tin::base::Code;
using tin::base::error;

namespace {

Result<Response> profile(Context& context, const Request& request) {
  const auto tin = context.catalogue.find(request.path_parameter("tin"));
  if (!tin) return tin.error();
  const auto& limits = context.config.limits;
  const auto coords = request.query_value("coords");
  if (!coords) return error(Code::kMalformed, "The parameter coords is missing.", "query:coords");
  proto::PositionsInputs inputs;
  auto positions =
      proto::parse_positions(*coords, static_cast<std::size_t>(limits.positions_per_request), "query:coords");
  if (!positions) return positions.error();
  inputs.positions = std::move(*positions);
  const auto manner = manner_of(request);
  if (!manner) return manner.error();
  inputs.manner = *manner;
  const app::Version version = (*tin)->version();
  auto answer = profile_answer(version, inputs, limits, "query:");
  // In the query string the positions have no places of their own.
  if (!answer && answer.error().where.starts_with("query:positions")) {
    return error(answer.error().code, answer.error().message, "query:coords");
  }
  return tagged(answer, **tin, version.revision, request);
}

Result<Response> profile_of_many(Context& context, const Request& request) {
  const auto tin = context.catalogue.find(request.path_parameter("tin"));
  if (!tin) return tin.error();
  const auto& limits = context.config.limits;
  const auto inputs = positions_of_body(request, limits);
  if (!inputs) return inputs.error();
  const app::Version version = (*tin)->version();
  return tagged(profile_answer(version, *inputs, limits, "/"), **tin, version.revision, request);
}

Result<proto::Position2> required_position(const Request& request, const std::string& name) {
  const auto text = request.query_value(name);
  if (!text) return error(Code::kMalformed, "The parameter " + name + " is missing.", "query:" + name);
  const auto positions = proto::parse_positions(*text, 1, "query:" + name);
  if (!positions) return positions.error();
  return positions->front();
}

Result<bool> flag(const Request& request, const std::string& name) {
  const std::string text = request.query_value(name).value_or("false");
  if (text == "true") return true;
  if (text == "false") return false;
  return error(Code::kInvalidValue, "The parameter " + name + " is true or false.", "query:" + name);
}

Result<proto::SightInputs> sight_inputs(const Request& request) {
  const auto observer = required_position(request, "observer"), target = required_position(request, "target");
  if (!observer) return observer.error();
  if (!target) return target.error();
  proto::SightInputs inputs;
  const auto observer_height = number_or(request, "observer-height", 0),
             target_height = number_or(request, "target-height", 0);
  if (!observer_height) return observer_height.error();
  if (!target_height) return target_height.error();
  const auto refraction = number_or(request, "refraction", inputs.refraction);
  if (!refraction) return refraction.error();
  const auto curvature = flag(request, "curvature");
  if (!curvature) return curvature.error();
  const auto manner = manner_of(request);
  if (!manner) return manner.error();
  inputs = {*observer, *target, *observer_height, *target_height, *curvature, *refraction, *manner};
  if (auto fine = proto::check_sight_inputs(inputs, "query:"); !fine) return fine.error();
  return inputs;
}

Result<Response> line_of_sight(Context& context, const Request& request) {
  const auto tin = context.catalogue.find(request.path_parameter("tin"));
  if (!tin) return tin.error();
  const auto inputs = sight_inputs(request);
  if (!inputs) return inputs.error();
  const app::Version version = (*tin)->version();
  return tagged(sight_answer(version, *inputs, context.config.limits, "query:"), **tin, version.revision,
                request);
}

}  // namespace

void add_profile(http::Router& router, Context& context) {
  using http::Method;
  const std::string pattern = "/tins/{tin}/profile";
  router.add({.method = Method::kGet,
              .pattern = pattern,
              .query = {"coords", "crs", "voids"},
              .handler = guarded([&context](Request& request) { return profile(context, request); })});
  router.add(
      {.method = Method::kPost,
       .pattern = pattern,
       .body = http::BodyKind::kMemory,
       .need = http::Need::kRead,
       .handler = guarded([&context](Request& request) { return profile_of_many(context, request); })});
  router.add({.method = Method::kGet,
              .pattern = "/tins/{tin}/line-of-sight",
              .query = {"observer", "target", "observer-height", "target-height", "curvature", "refraction",
                        "crs", "voids"},
              .handler = guarded([&context](Request& request) { return line_of_sight(context, request); })});
}

}  // namespace server::api
