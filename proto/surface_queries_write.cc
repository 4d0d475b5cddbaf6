#include "proto/surface_queries.h"

namespace proto {

namespace {

void write_or_null(JsonWriter& json, std::optional<double> value) {
  value ? json.number(*value) : json.null();
}

void write_position(JsonWriter& json, Position2 p) {
  json.begin_array().number(p.x).number(p.y).end_array();
}

void write_vertical(JsonWriter& json, const Units& units) {
  json.key("verticalUnit");
  units.vertical.empty() ? json.null() : json.string(units.vertical);
}

std::string_view length(const Units& units) {
  return units.metres ? "m" : "unit";
}
std::string_view area(const Units& units) {
  return units.metres ? "m2" : "unit2";
}
std::string_view volume(const Units& units) {
  return units.metres ? "m3" : "unit3";
}

std::optional<double> slope_of(const std::optional<tin::query::Gradient>& g) {
  return g ? std::optional(tin::query::slope_degrees(*g)) : std::nullopt;
}
std::optional<double> aspect_of(const std::optional<tin::query::Gradient>& g) {
  return g ? tin::query::aspect_degrees(*g) : std::nullopt;
}

}  // namespace

std::string slope_json(const std::optional<tin::query::Gradient>& gradient, std::uint64_t revision) {
  JsonWriter json;
  json.begin_object();
  json.key("slope");
  write_or_null(json, slope_of(gradient));
  json.key("aspect");
  write_or_null(json, aspect_of(gradient));
  json.key("gradient");
  if (gradient) {
    json.begin_array().number(gradient->east).number(gradient->north).end_array();
  } else {
    json.null();
  }
  json.key("unit").string("degree");
  json.key("revision").integer(revision);
  json.end_object();
  return json.take();
}

std::string slopes_json(std::span<const std::optional<tin::query::Gradient>> gradients,
                        std::uint64_t revision) {
  JsonWriter json;
  json.begin_object();
  json.key("slope").begin_array();
  for (const auto& g : gradients) write_or_null(json, slope_of(g));
  json.end_array();
  json.key("aspect").begin_array();
  for (const auto& g : gradients) write_or_null(json, aspect_of(g));
  json.end_array();
  json.key("unit").string("degree");
  json.key("revision").integer(revision);
  json.end_object();
  return json.take();
}

std::string profile_json(std::span<const tin::query::ProfilePoint> points, std::span<const Position2> at,
                         const Units& units, std::uint64_t revision) {
  JsonWriter json;
  json.begin_object();
  json.key("distance").begin_array();
  for (const auto& p : points) json.number(p.distance);
  json.end_array();
  json.key("positions").begin_array();
  for (const Position2& p : at) write_position(json, p);
  json.end_array();
  json.key("z").begin_array();
  for (const auto& p : points) write_or_null(json, p.z);
  json.end_array();
  json.key("length").number(points.empty() ? 0 : points.back().distance);
  json.key("lengthUnit").string(length(units));
  write_vertical(json, units);
  json.key("revision").integer(revision);
  json.end_object();
  return json.take();
}

std::string sight_json(const tin::query::Sight& sight, Position2 closest, std::optional<Position2> blocked,
                       const Units& units, std::uint64_t revision) {
  JsonWriter json;
  const auto point = [&json](const tin::query::SightPoint& p, Position2 at) {
    json.begin_object();
    json.key("position");
    write_position(json, at);
    json.key("distance").number(p.distance);
    json.key("z").number(p.z);
    json.key("clearance").number(p.clearance);
    json.end_object();
  };
  json.begin_object();
  json.key("visible").boolean(sight.visible);
  json.key("distance").number(sight.distance);
  json.key("observerZ").number(sight.observer_z);
  json.key("targetZ").number(sight.target_z);
  json.key("closest");
  point(sight.closest, closest);
  json.key("blockedAt");
  blocked ? point(*sight.blocked_at, *blocked) : void(json.null());
  json.key("crossesGap").boolean(sight.crosses_gap);
  json.key("lengthUnit").string(length(units));
  write_vertical(json, units);
  json.key("revision").integer(revision);
  json.end_object();
  return json.take();
}

std::string volume_json(const tin::query::LevelVolumes& volumes, double level, const Units& units,
                        std::uint64_t revision) {
  JsonWriter json;
  json.begin_object();
  json.key("level").number(level);
  json.key("volumeAbove").number(volumes.volume_above);
  json.key("volumeBelow").number(volumes.volume_below);
  json.key("areaAbove").number(volumes.area_above);
  json.key("areaBelow").number(volumes.area_below);
  json.key("areaUnit").string(area(units));
  json.key("volumeUnit").string(volume(units));
  write_vertical(json, units);
  json.key("revision").integer(revision);
  json.end_object();
  return json.take();
}

std::string surface_area_json(const tin::query::SurfaceArea& found, const Units& units,
                              std::uint64_t revision) {
  JsonWriter json;
  json.begin_object();
  json.key("planarArea").number(found.planar);
  json.key("surfaceArea").number(found.surface);
  json.key("areaUnit").string(area(units));
  json.key("revision").integer(revision);
  json.end_object();
  return json.take();
}

std::string cut_fill_json(const tin::query::CutFill& volumes, const Units& units, std::uint64_t revision,
                          std::string_view after, std::uint64_t after_revision) {
  JsonWriter json;
  json.begin_object();
  json.key("cutVolume").number(volumes.cut_volume);
  json.key("fillVolume").number(volumes.fill_volume);
  json.key("cutArea").number(volumes.cut_area);
  json.key("fillArea").number(volumes.fill_area);
  json.key("equalArea").number(volumes.equal_area);
  json.key("areaUnit").string(area(units));
  json.key("volumeUnit").string(volume(units));
  json.key("revision").integer(revision);
  json.key("after").string(after);
  json.key("afterRevision").integer(after_revision);
  json.end_object();
  return json.take();
}

}  // namespace proto
