// /tins/{tin}/elevation: one position by GET, many by POST.
#include "server/api/elevation.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <span>

#include "proto/crs_uri.h"
#include "server/api/answer.h"
#include "server/api/positions.h"
#include "server/api/routes.h"
#include "server/api/surface_work.h"
#include "tin/delaunay/hilbert_sort.h"

namespace server::api {

using tin::base::Code;
using tin::base::error;
using tin::query::ElevationQuery;
using tin::terrain::Terrain;

namespace {

constexpr std::string_view kDoubles = "application/octet-stream";

/// The elevation at a position of the TIN's CRS, snapped to the lattice; nothing beyond the lattice either.
std::optional<tin::query::Elevation> elevation_at(const Terrain& terrain, ElevationQuery& query, double x,
                                                  double y) {
  const auto at = terrain.frame().to_lattice(x, y);
  return at ? query.at(*at) : std::nullopt;
}

/// The parameters of a GET.
struct Asked {
  double x = 0, y = 0;
  proto::Voids voids = proto::Voids::kKeep;
  tin::query::Interpolation by = tin::query::Interpolation::kLinear;
};

Result<Asked> read_asked(const Request& request) {
  const auto x = required_number(request, "x"), y = required_number(request, "y");
  if (!x) return x.error();
  if (!y) return y.error();
  const auto voids = proto::parse_voids(request.query_value("voids").value_or("keep"), "query:voids");
  if (!voids) return voids.error();
  const auto by = proto::parse_interpolation(request.query_value("interpolation").value_or("linear"),
                                             "query:interpolation");
  if (!by) return by.error();
  return Asked{*x, *y, *voids, *by};
}

proto::ElevationAnswer look_up(const Terrain& terrain, std::uint64_t revision, const Asked& asked,
                               const std::optional<proto::Position2>& own) {
  ElevationQuery query(terrain, engine_voids(asked.voids), asked.by);
  const auto found = own ? elevation_at(terrain, query, own->x, own->y) : std::nullopt;
  proto::ElevationAnswer out;
  out.revision = revision;
  if (found) {
    out.z = found->z;
    out.triangle = found->triangle;
  }
  return out;
}

Response one_answer(const app::Tin& tin, const Request& request, const proto::ElevationAnswer& answer) {
  Response response = json_answer(proto::elevation_json(answer));
  response.headers.emplace_back("ETag", entity_tag(tin, answer.revision, request));
  return response;
}

Result<Response> one(Context& context, const Request& request) {
  const auto tin = context.catalogue.find(request.path_parameter("tin"));
  if (!tin) return tin.error();
  const auto asked = read_asked(request);
  if (!asked) return asked.error();
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
  const auto own = positions->convert(proto::Position2{asked->x, asked->y});
  const auto answer = (*tin)->read([&](const Terrain& terrain, std::uint64_t revision) {
    return look_up(terrain, revision, *asked, own);
  });
  return one_answer(**tin, request, answer);
}

/// The same on the I/O thread: in the TIN's own CRS, and when no writer is at work. Errors are left to one().
std::optional<Response> one_at_once(const Context& context, const Request& request) {
  if (request.query_value("crs")) return std::nullopt;
  const auto tin = context.catalogue.find(request.path_parameter("tin"));
  if (!tin) return std::nullopt;
  const auto asked = read_asked(request);
  if (!asked) return std::nullopt;
  if (asked->by != tin::query::Interpolation::kLinear) return std::nullopt;
  const auto answer = (*tin)->try_read([&](const Terrain& terrain, std::uint64_t revision) {
    return look_up(terrain, revision, *asked, proto::Position2{asked->x, asked->y});
  });
  if (!answer) return std::nullopt;
  return one_answer(**tin, request, *answer);
}

constexpr std::size_t kAtOnce = 4000;  // positions that are located together

/// Fills z[indices[k]] with the elevation at points[k]. Many walks at a time hide the time that memory takes.
void look_up_block(const Terrain& terrain, ElevationQuery& query, std::span<const tin::exact::Point> points,
                   std::span<const std::uint32_t> indices, std::vector<tin::delaunay::Location>& locations,
                   std::vector<std::optional<double>>& z) {
  const bool has_triangles = terrain.mesh().dimension() == 2;
  if (has_triangles) terrain.triangulation().locate_many(points, locations);
  for (std::size_t k = 0; k < points.size(); ++k) {
    if (has_triangles) query.start_from(locations[k].triangle);
    if (const auto found = query.at(points[k])) z[indices[k]] = found->z;
  }
}

/// Elevations at positions in the TIN's CRS, those with `ok`. Many are taken along the Hilbert curve, as the
/// terrain is stored: each block of them stays in the caches.
std::vector<std::optional<double>> look_up_all(const Terrain& terrain, const ElevationManner& manner,
                                               std::span<const double> x, std::span<const double> y,
                                               std::span<const std::uint8_t> ok) {
  std::vector<tin::exact::Point> points;
  std::vector<std::uint32_t> indices;
  points.reserve(x.size());
  indices.reserve(x.size());
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (ok[i] == 0) continue;
    const auto at = terrain.frame().to_lattice(x[i], y[i]);
    if (!at) continue;  // beyond the lattice: no elevation
    points.push_back(*at);
    indices.push_back(static_cast<std::uint32_t>(i));
  }
  if (points.size() > kAtOnce) {
    std::vector<tin::exact::Point> sorted_points;
    std::vector<std::uint32_t> sorted_indices;
    sorted_points.reserve(points.size());
    sorted_indices.reserve(points.size());
    for (const auto& one : tin::delaunay::hilbert_sorted(points)) {
      sorted_points.push_back(points[one.index]);
      sorted_indices.push_back(indices[one.index]);
    }
    points.swap(sorted_points);
    indices.swap(sorted_indices);
  }
  std::vector<std::optional<double>> z(x.size());
  ElevationQuery query(terrain, engine_voids(manner.voids), manner.by);
  std::vector<tin::delaunay::Location> locations;
  for (std::size_t begin = 0; begin < points.size(); begin += kAtOnce) {
    const std::size_t size = std::min(kAtOnce, points.size() - begin);
    look_up_block(terrain, query, std::span(points).subspan(begin, size),
                  std::span(indices).subspan(begin, size), locations, z);
  }
  return z;
}

}  // namespace

Result<std::vector<std::optional<double>>> elevations_at(const Terrain& terrain, std::string_view crs,
                                                         std::string where, const ElevationManner& manner,
                                                         std::vector<double> x, std::vector<double> y) {
  auto positions = Positions::between(crs, terrain.frame().crs, std::move(where));
  if (!positions) return positions.error();
  std::vector<std::uint8_t> ok;
  positions->convert(x, y, ok);
  return look_up_all(terrain, manner, x, y, ok);
}

namespace {

// Doubles travel as they lie in memory.
static_assert(std::endian::native == std::endian::little && std::numeric_limits<double>::is_iec559);

/// Positions as pairs of doubles, x and y; the answer is a double each, NaN where there is no elevation.
Result<Response> many_doubles(const Context& context, const app::Tin& tin, const Request& request) {
  constexpr std::size_t kPair = 2 * sizeof(double);
  const std::size_t count = request.body.size() / kPair;
  if (request.body.size() % kPair != 0)
    return error(Code::kMalformed,
                 "The body must be pairs of 64-bit floating-point numbers, x and y of each position.");
  if (count > static_cast<std::size_t>(context.config.limits.positions_per_request)) {
    return error(Code::kTooLarge, "A request may have at most " +
                                      std::to_string(context.config.limits.positions_per_request) +
                                      " positions.");
  }
  const auto voids = proto::parse_voids(request.query_value("voids").value_or("keep"), "query:voids");
  if (!voids) return voids.error();
  const auto by = proto::parse_interpolation(request.query_value("interpolation").value_or("linear"),
                                             "query:interpolation");
  if (!by) return by.error();
  std::vector<double> x(count), y(count);
  for (std::size_t i = 0; i < count; ++i) {
    std::memcpy(&x[i], request.body.data() + i * kPair, sizeof(double));
    std::memcpy(&y[i], request.body.data() + i * kPair + sizeof(double), sizeof(double));
    if (!std::isfinite(x[i]) || !std::isfinite(y[i]))
      return error(Code::kNotFinite, "A coordinate is not a finite number.", "/" + std::to_string(i));
  }
  const app::Version version = tin.version();
  std::string crs = version.terrain->frame().crs;
  if (const auto text = request.query_value("crs")) {
    const auto name = proto::parse_crs(*text, "query:crs");
    if (!name) return name.error();
    crs = *name;
  }
  const auto z = elevations_at(*version.terrain, crs, "query:crs", {*voids, *by}, std::move(x), std::move(y));
  if (!z) return z.error();
  std::string bytes(z->size() * sizeof(double), '\0');
  for (std::size_t i = 0; i < z->size(); ++i) {
    const double value = (*z)[i].value_or(std::numeric_limits<double>::quiet_NaN());
    std::memcpy(bytes.data() + i * sizeof value, &value, sizeof value);
  }
  return Response{
      200,
      {{"Content-Type", std::string(kDoubles)}, {"ETag", entity_tag(tin, version.revision, request)}},
      std::move(bytes)};
}

Result<Response> many(Context& context, const Request& request) {
  const auto tin = context.catalogue.find(request.path_parameter("tin"));
  if (!tin) return tin.error();
  if (media_type(request) == kDoubles) return many_doubles(context, **tin, request);
  if (!request.query.empty()) {
    return error(Code::kUnknownParameter, "With a body of JSON, its parameters are members of it.",
                 "query:" + request.query.front().first);
  }
  if (auto json = require_json(request); !json) return json.error();
  const auto message = proto::read_elevation_request(
      request.body, static_cast<std::size_t>(context.config.limits.positions_per_request));
  if (!message) return message.error();
  const app::Version version = (*tin)->version();
  std::vector<double> x, y;
  x.reserve(message->positions.size());
  y.reserve(message->positions.size());
  for (const proto::Position2& position : message->positions) {
    x.push_back(position.x);
    y.push_back(position.y);
  }
  const auto z = elevations_at(*version.terrain, message->crs.value_or(version.terrain->frame().crs), "/crs",
                            {message->voids, message->interpolation}, std::move(x), std::move(y));
  if (!z) return z.error();
  Response response = json_answer(proto::elevations_json(*z, version.revision));
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
              .handler = guarded([&context](Request& request) { return one(context, request); }),
              .quick = [&context](Request& request) { return one_at_once(context, request); }});
  router.add({.method = Method::kPost,
              .pattern = pattern,
              .query = {"crs", "voids", "interpolation"},
              .body = http::BodyKind::kMemory,
              .need = http::Need::kRead,
              .handler = guarded([&context](Request& request) { return many(context, request); })});
}

}  // namespace server::api
