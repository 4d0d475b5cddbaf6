#include "server/api/surface_work.h"

#include <algorithm>
#include <cmath>

#include "proto/crs_uri.h"
#include "server/gdal/crs.h"
#include "tin/query/profile.h"
#include "tin/query/volume.h"

namespace server::api {

using tin::base::Code;
using tin::base::error;
using tin::exact::Point;
using tin::frame::Ground;
using tin::frame::Place;
using tin::query::Region;
using tin::terrain::Terrain;

tin::query::Voids engine_voids(proto::Voids voids) {
  return voids == proto::Voids::kFill ? tin::query::Voids::kFill : tin::query::Voids::kKeep;
}

proto::Units units_of(const Terrain& terrain) {
  return {!terrain.frame().crs.empty(), terrain.frame().vertical_unit};
}

Result<Ground> ground_of(const Terrain& terrain) {
  const auto& frame = terrain.frame();
  if (frame.crs.empty()) return Ground(frame, {});
  const auto crs = gdal::read_crs(frame.crs);
  if (!crs) return crs.error();
  return Ground(frame, crs->scale);
}

Result<SurfacePositions> SurfacePositions::make(const Terrain& terrain, const std::optional<std::string>& crs,
                                                std::string where) {
  const std::string& own = terrain.frame().crs;
  const std::string& asked = crs ? *crs : own;
  auto to_own = Positions::between(asked, own, where);
  if (!to_own) return to_own.error();
  auto from_own = Positions::between(own, asked, std::move(where));
  if (!from_own) return from_own.error();
  return SurfacePositions(terrain.frame(), std::move(*to_own), std::move(*from_own));
}

std::vector<std::optional<Point>> SurfacePositions::nearest(std::span<const proto::Position2> positions) {
  std::vector<double> x, y;
  for (const auto& p : positions) {
    x.push_back(p.x);
    y.push_back(p.y);
  }
  std::vector<std::uint8_t> ok;
  to_own_.convert(x, y, ok);
  std::vector<std::optional<Point>> out(positions.size());
  for (std::size_t i = 0; i < out.size(); ++i) {
    if (ok[i] == 0) continue;
    if (const auto at = frame_->to_lattice(x[i], y[i])) out[i] = *at;
  }
  return out;
}

Result<std::vector<Point>> SurfacePositions::to_lattice(std::span<const proto::Position2> positions,
                                                        const std::string& where) {
  std::vector<Point> out;
  for (const auto& at : nearest(positions)) {
    if (!at) {
      return error(Code::kOutsideLattice, "The position lies outside the area that this TIN can cover.",
                   where + "/" + std::to_string(out.size()));
    }
    out.push_back(*at);
  }
  return out;
}

Result<Point> SurfacePositions::to_lattice(proto::Position2 position, const std::string& where) {
  const auto at = nearest({&position, 1})[0];
  if (!at)
    return error(Code::kOutsideLattice, "The position lies outside the area that this TIN can cover.", where);
  return *at;
}

std::vector<proto::Position2> SurfacePositions::from_lattice(std::span<const Place> places) {
  std::vector<double> x, y;
  for (const Place& p : places) {
    x.push_back(frame_->x.world(p.x));
    y.push_back(frame_->y.world(p.y));
  }
  std::vector<std::uint8_t> ok;
  from_own_.convert(x, y, ok);
  std::vector<proto::Position2> out(places.size());
  for (std::size_t i = 0; i < out.size(); ++i) out[i] = {x[i], y[i]};
  return out;
}

/// The sides of a box, counter-clockwise, in as many parts as its CRS asks for.
std::vector<proto::Position2> SurfacePositions::outline(const proto::Bbox& box) const {
  const int parts = identity() ? 1 : 32;
  const proto::Position2 corners[] = {
      {box.min_x, box.min_y}, {box.max_x, box.min_y}, {box.max_x, box.max_y}, {box.min_x, box.max_y}};
  std::vector<proto::Position2> out;
  for (int side = 0; side < 4; ++side) {
    const auto a = corners[side], b = corners[(side + 1) % 4];
    for (int i = 0; i < parts; ++i) {
      const double u = static_cast<double>(i) / parts;
      out.push_back({a.x + u * (b.x - a.x), a.y + u * (b.y - a.y)});
    }
  }
  return out;
}

Result<std::optional<Region>> SurfacePositions::region(const proto::AreaOfInterest& area,
                                                       const std::string& where) {
  if (area.polygon.empty() && !area.box) return std::optional<Region>();
  std::vector<tin::query::Ring> rings;
  const std::string place = where + (area.box ? "bbox" : "polygon");
  std::vector<proto::Ring2> polygon = area.polygon;
  if (area.box) polygon = {outline(*area.box)};
  for (const auto& ring : polygon) {
    auto points = to_lattice(ring, place);
    if (!points) return points.error();
    rings.push_back(std::move(*points));
  }
  auto region = Region::make(rings);
  if (!region) return error(region.error().code, region.error().message, place);
  return std::optional(std::move(*region));
}

Result<tin::query::PlaceBox> SurfacePositions::box(const proto::Bbox& box, const std::string& where) {
  std::vector<double> x, y;
  for (const auto& p : outline(box)) {
    x.push_back(p.x);
    y.push_back(p.y);
  }
  std::vector<std::uint8_t> ok;
  if (!to_own_.convert(x, y, ok))
    return error(Code::kInvalidValue, "The box cannot be converted to the TIN's CRS.", where + "bbox");
  const auto [min_x, max_x] = std::minmax_element(x.begin(), x.end());
  const auto [min_y, max_y] = std::minmax_element(y.begin(), y.end());
  return tin::query::PlaceBox{{frame_->x.lattice(*min_x), frame_->y.lattice(*min_y)},
                              {frame_->x.lattice(*max_x), frame_->y.lattice(*max_y)}};
}

Result<proto::Manner> manner_of(const Request& request) {
  proto::Manner manner;
  if (const auto text = request.query_value("crs")) {
    auto name = proto::parse_crs(*text, "query:crs");
    if (!name) return name.error();
    manner.crs = std::move(*name);
  }
  const auto voids = proto::parse_voids(request.query_value("voids").value_or("keep"), "query:voids");
  if (!voids) return voids.error();
  manner.voids = *voids;
  return manner;
}

Result<double> required_number(const Request& request, const std::string& name) {
  const auto text = request.query_value(name);
  if (!text) return error(Code::kMalformed, "The parameter " + name + " is missing.", "query:" + name);
  return proto::parse_number(*text, "query:" + name);
}

Result<double> number_or(const Request& request, const std::string& name, double otherwise) {
  const auto text = request.query_value(name);
  if (!text) return otherwise;
  return proto::parse_number(*text, "query:" + name);
}

Result<std::optional<proto::Bbox>> flat_box(const Request& request) {
  const auto text = request.query_value("bbox");
  if (!text) return std::optional<proto::Bbox>();
  const auto box = proto::parse_bbox(*text, "query:bbox");
  if (!box) return box.error();
  if (box->min_z)
    return error(Code::kInvalidValue, "The box is one of positions: four numbers.", "query:bbox");
  return std::optional(*box);
}

Result<proto::AreaInputs> area_inputs_of(const Request& request, const LimitConfig& limits) {
  proto::AreaInputs inputs;
  const auto box = flat_box(request);
  if (!box) return box.error();
  inputs.area.box = *box;
  if (const auto text = request.query_value("polygon")) {
    if (*box) return error(Code::kInvalidValue, "Either a polygon or a bbox, not both.", "query:polygon");
    auto ring =
        proto::parse_positions(*text, static_cast<std::size_t>(limits.polygon_positions), "query:polygon");
    if (!ring) return ring.error();
    inputs.area.polygon.push_back(std::move(*ring));
  }
  auto manner = manner_of(request);
  if (!manner) return manner.error();
  inputs.manner = std::move(*manner);
  return inputs;
}

Result<proto::PositionsInputs> positions_of_body(const Request& request, const LimitConfig& limits) {
  if (auto json = require_json(request); !json) return json.error();
  const auto document = proto::Document::parse(request.body);
  if (!document) return document.error();
  const auto object = document->root().object({"positions", "crs", "voids"});
  if (!object) return object.error();
  return proto::read_positions_inputs(*object, static_cast<std::size_t>(limits.positions_per_request));
}

tin::base::Error too_many_questions() {
  return error(Code::kTooMany, "Too many long questions are being answered; try again.");
}

Result<Response> tagged(Result<std::string> body, const app::Tin& tin, std::uint64_t revision,
                        const Request& request) {
  if (!body) return body.error();
  Response response = json_answer(*std::move(body));
  response.headers.emplace_back("ETag", entity_tag(tin, revision, request));
  return response;
}

Result<std::string> profile_answer(const app::Version& version, const proto::PositionsInputs& inputs,
                                   const LimitConfig& limits, const std::string& where) {
  const Terrain& terrain = *version.terrain;
  const auto ground = ground_of(terrain);
  if (!ground) return ground.error();
  auto positions = SurfacePositions::make(terrain, inputs.manner.crs, where + "crs");
  if (!positions) return positions.error();
  const auto line = positions->to_lattice(inputs.positions, where + "positions");
  if (!line) return line.error();
  if (line->empty()) return error(Code::kInvalidValue, "A profile needs a position.", where + "positions");
  const auto points = tin::query::profile(terrain, *ground, *line, engine_voids(inputs.manner.voids),
                                          static_cast<std::size_t>(limits.answer_positions));
  if (!points) return points.error();
  std::vector<Place> places;
  for (const auto& p : *points) places.push_back(p.at);
  return proto::profile_json(*points, positions->from_lattice(places), units_of(terrain), version.revision);
}

Result<std::string> sight_answer(const app::Version& version, const proto::SightInputs& inputs,
                                 const LimitConfig& limits, const std::string& where) {
  const Terrain& terrain = *version.terrain;
  const auto ground = ground_of(terrain);
  if (!ground) return ground.error();
  auto positions = SurfacePositions::make(terrain, inputs.manner.crs, where + "crs");
  if (!positions) return positions.error();
  const auto observer = positions->to_lattice(inputs.observer, where + "observer");
  if (!observer) return observer.error();
  const auto target = positions->to_lattice(inputs.target, where + "target");
  if (!target) return target.error();
  const auto sight =
      tin::query::line_of_sight(terrain, *ground,
                                {*observer, *target, inputs.observer_height, inputs.target_height,
                                 inputs.curvature, inputs.refraction, engine_voids(inputs.manner.voids)},
                                static_cast<std::size_t>(limits.answer_positions));
  if (!sight) return within(where, sight.error());
  std::vector<Place> places{sight->closest.at};
  if (sight->blocked_at) places.push_back(sight->blocked_at->at);
  const auto at = positions->from_lattice(places);
  return proto::sight_json(*sight, at[0], sight->blocked_at ? std::optional(at[1]) : std::nullopt,
                           units_of(terrain), version.revision);
}

namespace {

/// The ground and the region of a question about areas.
struct Plan {
  Ground ground;
  std::optional<Region> region;
  tin::query::Where where(proto::Voids voids) const {
    return {region ? &*region : nullptr, engine_voids(voids)};
  }
};

Result<Plan> plan_of(const Terrain& terrain, const proto::AreaOfInterest& area, const proto::Manner& manner,
                     const std::string& where) {
  auto ground = ground_of(terrain);
  if (!ground) return ground.error();
  auto positions = SurfacePositions::make(terrain, manner.crs, where + "crs");
  if (!positions) return positions.error();
  auto region = positions->region(area, where);
  if (!region) return region.error();
  return Plan{*ground, std::move(*region)};
}

}  // namespace

Result<std::string> volume_answer(const app::Version& version, const proto::VolumeInputs& inputs,
                                  const std::string& where, tin::base::Progress* progress) {
  const Terrain& terrain = *version.terrain;
  const auto plan = plan_of(terrain, inputs.area, inputs.manner, where);
  if (!plan) return plan.error();
  const auto found =
      tin::query::volumes_at(terrain, plan->ground, inputs.level, plan->where(inputs.manner.voids), progress);
  if (!found) return found.error();
  return proto::volume_json(*found, inputs.level, units_of(terrain), version.revision);
}

Result<std::string> surface_area_answer(const app::Version& version, const proto::AreaInputs& inputs,
                                        const std::string& where, tin::base::Progress* progress) {
  const Terrain& terrain = *version.terrain;
  const auto plan = plan_of(terrain, inputs.area, inputs.manner, where);
  if (!plan) return plan.error();
  const auto found =
      tin::query::surface_area(terrain, plan->ground, plan->where(inputs.manner.voids), progress);
  if (!found) return found.error();
  return proto::surface_area_json(*found, units_of(terrain), version.revision);
}

Result<std::string> cut_fill_answer(const app::Version& before, const app::Version& after,
                                    std::string_view after_id, const proto::AreaInputs& inputs,
                                    const std::string& where, tin::base::Progress* progress) {
  const Terrain& terrain = *before.terrain;
  if (terrain.frame().crs != after.terrain->frame().crs) {
    return error(Code::kInvalidValue, "The two TINs are in different CRSs.", where + "after");
  }
  const auto plan = plan_of(terrain, inputs.area, inputs.manner, where);
  if (!plan) return plan.error();
  const auto found =
      tin::query::cut_fill(terrain, *after.terrain, plan->ground, plan->where(inputs.manner.voids), progress);
  if (!found) return found.error();
  return proto::cut_fill_json(*found, units_of(terrain), before.revision, after_id, after.revision);
}

}  // namespace server::api
