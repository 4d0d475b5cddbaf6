// /tins/{tin}/slope: how steep the surface is and where it faces, at one position by GET, at many by POST.
#include "server/api/answer.h"
#include "server/api/routes.h"
#include "server/api/surface_work.h"
#include "tin/query/gradient.h"

namespace server::api {

using tin::query::Gradient;
using tin::query::GradientQuery;
using tin::terrain::Terrain;

namespace {

Result<std::vector<std::optional<Gradient>>> gradients(const Terrain& terrain,
                                                       const proto::PositionsInputs& inputs,
                                                       const std::string& where) {
  const auto ground = ground_of(terrain);
  if (!ground) return ground.error();
  auto positions = SurfacePositions::make(terrain, inputs.manner.crs, where + "crs");
  if (!positions) return positions.error();
  GradientQuery query(terrain, engine_voids(inputs.manner.voids), *ground);
  std::vector<std::optional<Gradient>> out;
  for (const auto& at : positions->nearest(inputs.positions))
    out.push_back(at ? query.at(*at) : std::nullopt);
  return out;
}

Result<Response> one(Context& context, const Request& request) {
  const auto tin = context.catalogue.find(request.path_parameter("tin"));
  if (!tin) return tin.error();
  const auto x = required_number(request, "x"), y = required_number(request, "y");
  if (!x) return x.error();
  if (!y) return y.error();
  const auto manner = manner_of(request);
  if (!manner) return manner.error();
  std::uint64_t revision = 0;
  const auto found = (*tin)->read([&](const Terrain& terrain, std::uint64_t now) {
    revision = now;
    return gradients(terrain, {{{*x, *y}}, *manner}, "query:");
  });
  if (!found) return found.error();
  Response response = json_answer(proto::slope_json(found->front(), revision));
  response.headers.emplace_back("ETag", entity_tag(**tin, revision, request));
  return response;
}

Result<Response> many(Context& context, const Request& request) {
  const auto tin = context.catalogue.find(request.path_parameter("tin"));
  if (!tin) return tin.error();
  const auto inputs = positions_of_body(request, context.config.limits);
  if (!inputs) return inputs.error();
  const app::Version version = (*tin)->version();
  const auto found = gradients(*version.terrain, *inputs, "/");
  if (!found) return found.error();
  Response response = json_answer(proto::slopes_json(*found, version.revision));
  response.headers.emplace_back("ETag", entity_tag(**tin, version.revision, request));
  return response;
}

}  // namespace

void add_slope(http::Router& router, Context& context) {
  using http::Method;
  const std::string pattern = "/tins/{tin}/slope";
  router.add({.method = Method::kGet,
              .pattern = pattern,
              .query = {"x", "y", "crs", "voids"},
              .handler = guarded([&context](Request& request) { return one(context, request); })});
  router.add({.method = Method::kPost,
              .pattern = pattern,
              .body = http::BodyKind::kMemory,
              .need = http::Need::kRead,
              .handler = guarded([&context](Request& request) { return many(context, request); })});
}

}  // namespace server::api
