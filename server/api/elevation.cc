// /tins/{tin}/elevation: one position by GET, many by POST.
#include "tin/query/elevation.h"

#include <algorithm>

#include "proto/crs_uri.h"
#include "server/api/answer.h"
#include "server/api/positions.h"
#include "server/api/routes.h"
#include "server/api/surface_work.h"

namespace server::api {

using tin::base::Code;
using tin::base::error;
using tin::query::ElevationQuery;
using tin::terrain::Terrain;

namespace {

/// The elevation at a position of the TIN's CRS, snapped to the lattice; nothing beyond the lattice either.
std::optional<tin::query::Elevation> elevation_at(const Terrain& terrain, ElevationQuery& query, double x,
                                                  double y) {
  const auto at = terrain.frame().to_lattice(x, y);
  return at ? query.at(*at) : std::nullopt;
}

Result<Response> one(Context& context, const Request& request) {
  const auto tin = context.catalogue.find(request.path_parameter("tin"));
  if (!tin) return tin.error();
  const auto x = required_number(request, "x"), y = required_number(request, "y");
  if (!x) return x.error();
  if (!y) return y.error();
  const auto voids = proto::parse_voids(request.query_value("voids").value_or("keep"), "query:voids");
  if (!voids) return voids.error();
  const auto by = proto::parse_interpolation(request.query_value("interpolation").value_or("linear"), "query:interpolation");
  if (!by) return by.error();
  const std::string own_crs =
      (*tin)->read([](const Terrain& terrain, std::uint64_t) { return terrain.frame().crs; });
  std::string asked_crs = own_crs;
  if (const auto text = request.query_value("crs")) {
    const auto name = proto::parse_crs(*text, "query:crs");
    if (!name) return name.error();
    asked_crs = *name;
  }
  auto positions = Positions::between(asked_crs, own_crs, "query:crs");
  if (!positions) return positions.error();
  const auto own = positions->convert(proto::Position2{*x, *y});
  const auto answer = (*tin)->read([&](const Terrain& terrain, std::uint64_t revision) {
    ElevationQuery query(terrain, engine_voids(*voids), *by);
    const auto found = own ? elevation_at(terrain, query, own->x, own->y) : std::nullopt;
    proto::ElevationAnswer out;
    out.revision = revision;
    if (found) {
      out.z = found->z;
      out.triangle = found->triangle;
    }
    return out;
  });
  Response response = json_answer(proto::elevation_json(answer));
  response.headers.emplace_back("ETag", entity_tag(**tin, answer.revision, request));
  return response;
}

Result<Response> many(Context& context, const Request& request) {
  const auto tin = context.catalogue.find(request.path_parameter("tin"));
  if (!tin) return tin.error();
  if (auto json = require_json(request); !json) return json.error();
  const auto message = proto::read_elevation_request(
      request.body, static_cast<std::size_t>(context.config.limits.positions_per_request));
  if (!message) return message.error();
  const app::Version version = (*tin)->version();
  const std::string& own_crs = version.terrain->frame().crs;
  auto positions = Positions::between(message->crs.value_or(own_crs), own_crs, "/crs");
  if (!positions) return positions.error();
  std::vector<double> x, y;
  for (const proto::Position2& position : message->positions) {
    x.push_back(position.x);
    y.push_back(position.y);
  }
  std::vector<std::uint8_t> ok;
  positions->convert(x, y, ok);
  ElevationQuery query(*version.terrain, engine_voids(message->voids), message->interpolation);
  std::vector<std::optional<double>> z(x.size());
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (ok[i] == 0) continue;
    if (const auto found = elevation_at(*version.terrain, query, x[i], y[i])) z[i] = found->z;
  }
  Response response = json_answer(proto::elevations_json(z, version.revision));
  response.headers.emplace_back("ETag", entity_tag(**tin, version.revision, request));
  return response;
}

}  // namespace

void add_elevation(http::Router& router, Context& context) {
  using http::Method;
  const std::string pattern = "/tins/{tin}/elevation";
  router.add({.method = Method::kGet,
              .pattern = pattern,
              .query = {"x", "y", "crs", "voids", "interpolation"},
              .handler = guarded([&context](Request& request) { return one(context, request); })});
  router.add({.method = Method::kPost,
              .pattern = pattern,
              .body = http::BodyKind::kMemory,
              .handler = guarded([&context](Request& request) { return many(context, request); })});
}

}  // namespace server::api
