#include "proto/processes/surface.h"

namespace proto {

using tin::base::Result;

namespace {

// One line for each input and member, however long.
constexpr std::string_view kContoursInputs = R"({
"tin":{"title":"TIN","description":"Id of the TIN.","minOccurs":1,"maxOccurs":1,
"schema":{"type":"string","pattern":"^[A-Za-z0-9][A-Za-z0-9_-]{0,63}$"}},
"interval":{"title":"Interval","description":"Distance of levels in the TIN's vertical unit. Either this or levels.","minOccurs":0,"maxOccurs":1,
"schema":{"type":"number","minimum":0}},
"base":{"title":"Base","description":"A level from which the interval counts.","minOccurs":0,"maxOccurs":1,
"schema":{"type":"number","default":0}},
"levels":{"title":"Levels","description":"Levels in the TIN's vertical unit, ascending.","minOccurs":0,"maxOccurs":1,
"schema":{"type":"array","items":{"type":"number"},"minItems":1}},
"bbox":{"title":"Box","description":"minx, miny, maxx, maxy in the CRS of the answer: lines end at its sides.","minOccurs":0,"maxOccurs":1,
"schema":{"type":"array","items":{"type":"number"},"minItems":4,"maxItems":4}},
"crs":{"title":"CRS","description":"CRS of box and answer; without it longitude and latitude (CRS84), or the TIN's coordinates where it has no CRS.","minOccurs":0,"maxOccurs":1,
"schema":{"type":"string"}},
"voids":{"title":"Voids","description":"Whether cells that were nodata in the source raster have no surface (keep) or one across (fill).","minOccurs":0,"maxOccurs":1,
"schema":{"type":"string","enum":["keep","fill"],"default":"keep"}}
})";

constexpr std::string_view kContoursResult = R"({"type":"object",
"required":["type","features"],
"properties":{
"type":{"type":"string","enum":["FeatureCollection"]},
"features":{"type":"array","items":{"type":"object"}}
}})";

constexpr std::string_view kVolumeInputs = R"({
"tin":{"title":"TIN","description":"Id of the TIN.","minOccurs":1,"maxOccurs":1,
"schema":{"type":"string","pattern":"^[A-Za-z0-9][A-Za-z0-9_-]{0,63}$"}},
"level":{"title":"Level","description":"In the TIN's vertical unit.","minOccurs":1,"maxOccurs":1,
"schema":{"type":"number"}},
"polygon":{"title":"Polygon","description":"One ring of x, y, or an outline and holes in it, simple and apart from each other; nothing outside counts. Not with bbox.","minOccurs":0,"maxOccurs":1,
"schema":{"type":"array","items":{"type":"array"}}},
"bbox":{"title":"Box","description":"minx, miny, maxx, maxy: nothing outside counts.","minOccurs":0,"maxOccurs":1,
"schema":{"type":"array","items":{"type":"number"},"minItems":4,"maxItems":4}},
"crs":{"title":"CRS","description":"CRS of the positions, as EPSG:n, URI or URN; without it the TIN's own.","minOccurs":0,"maxOccurs":1,
"schema":{"type":"string"}},
"voids":{"title":"Voids","description":"Whether cells that were nodata in the source raster have no surface (keep) or one across (fill).","minOccurs":0,"maxOccurs":1,
"schema":{"type":"string","enum":["keep","fill"],"default":"keep"}}
})";

constexpr std::string_view kVolumeResult = R"({"type":"object",
"required":["level","volumeAbove","volumeBelow","areaAbove","areaBelow","areaUnit","volumeUnit","verticalUnit","revision"],
"properties":{
"level":{"type":"number","description":"The level"},
"volumeAbove":{"type":"number","description":"Between the level and higher ground"},
"volumeBelow":{"type":"number","description":"Between lower ground and the level"},
"areaAbove":{"type":"number","description":"In the plan, of ground at or above the level"},
"areaBelow":{"type":"number","description":"In the plan, of ground below the level"},
"areaUnit":{"type":"string","enum":["m2","unit2"],"description":"m2; unit2 where the TIN has no CRS"},
"volumeUnit":{"type":"string","enum":["m3","unit3"],"description":"m3; unit3 where the TIN has no CRS"},
"verticalUnit":{"type":"string","nullable":true,"description":"Of elevations; null: not known"},
"revision":{"type":"integer","description":"Revision of the TIN"}
}})";

constexpr std::string_view kCutFillInputs = R"({
"tin":{"title":"TIN","description":"Id of the TIN.","minOccurs":1,"maxOccurs":1,
"schema":{"type":"string","pattern":"^[A-Za-z0-9][A-Za-z0-9_-]{0,63}$"}},
"after":{"title":"TIN after","description":"Id of the TIN whose surface is wanted, in the same CRS.","minOccurs":1,"maxOccurs":1,
"schema":{"type":"string","pattern":"^[A-Za-z0-9][A-Za-z0-9_-]{0,63}$"}},
"polygon":{"title":"Polygon","description":"One ring of x, y, or an outline and holes in it, simple and apart from each other; nothing outside counts. Not with bbox.","minOccurs":0,"maxOccurs":1,
"schema":{"type":"array","items":{"type":"array"}}},
"bbox":{"title":"Box","description":"minx, miny, maxx, maxy: nothing outside counts.","minOccurs":0,"maxOccurs":1,
"schema":{"type":"array","items":{"type":"number"},"minItems":4,"maxItems":4}},
"crs":{"title":"CRS","description":"CRS of the positions, as EPSG:n, URI or URN; without it the TIN's own.","minOccurs":0,"maxOccurs":1,
"schema":{"type":"string"}},
"voids":{"title":"Voids","description":"Whether cells that were nodata in the source raster have no surface (keep) or one across (fill).","minOccurs":0,"maxOccurs":1,
"schema":{"type":"string","enum":["keep","fill"],"default":"keep"}}
})";

constexpr std::string_view kCutFillResult = R"({"type":"object",
"required":["cutVolume","fillVolume","cutArea","fillArea","equalArea","areaUnit","volumeUnit","revision","after","afterRevision"],
"properties":{
"cutVolume":{"type":"number","description":"Where the surface after lies lower"},
"fillVolume":{"type":"number","description":"Where it lies higher"},
"cutArea":{"type":"number","description":"In the plan, where it lies lower"},
"fillArea":{"type":"number","description":"In the plan, where it lies higher"},
"equalArea":{"type":"number","description":"In the plan, where both are the same"},
"areaUnit":{"type":"string","enum":["m2","unit2"],"description":"m2; unit2 where the TIN has no CRS"},
"volumeUnit":{"type":"string","enum":["m3","unit3"],"description":"m3; unit3 where the TIN has no CRS"},
"revision":{"type":"integer","description":"Revision of the TIN"},
"after":{"type":"string","description":"Id of the TIN after"},
"afterRevision":{"type":"integer","description":"Its revision"}
}})";

constexpr std::string_view kSurfaceAreaInputs = R"({
"tin":{"title":"TIN","description":"Id of the TIN.","minOccurs":1,"maxOccurs":1,
"schema":{"type":"string","pattern":"^[A-Za-z0-9][A-Za-z0-9_-]{0,63}$"}},
"polygon":{"title":"Polygon","description":"One ring of x, y, or an outline and holes in it, simple and apart from each other; nothing outside counts. Not with bbox.","minOccurs":0,"maxOccurs":1,
"schema":{"type":"array","items":{"type":"array"}}},
"bbox":{"title":"Box","description":"minx, miny, maxx, maxy: nothing outside counts.","minOccurs":0,"maxOccurs":1,
"schema":{"type":"array","items":{"type":"number"},"minItems":4,"maxItems":4}},
"crs":{"title":"CRS","description":"CRS of the positions, as EPSG:n, URI or URN; without it the TIN's own.","minOccurs":0,"maxOccurs":1,
"schema":{"type":"string"}},
"voids":{"title":"Voids","description":"Whether cells that were nodata in the source raster have no surface (keep) or one across (fill).","minOccurs":0,"maxOccurs":1,
"schema":{"type":"string","enum":["keep","fill"],"default":"keep"}}
})";

constexpr std::string_view kSurfaceAreaResult = R"({"type":"object",
"required":["planarArea","surfaceArea","areaUnit","revision"],
"properties":{
"planarArea":{"type":"number","description":"In the plan"},
"surfaceArea":{"type":"number","description":"Along the slopes"},
"areaUnit":{"type":"string","enum":["m2","unit2"],"description":"m2; unit2 where the TIN has no CRS"},
"revision":{"type":"integer","description":"Revision of the TIN"}
}})";

constexpr std::string_view kProfileInputs = R"({
"tin":{"title":"TIN","description":"Id of the TIN.","minOccurs":1,"maxOccurs":1,
"schema":{"type":"string","pattern":"^[A-Za-z0-9][A-Za-z0-9_-]{0,63}$"}},
"positions":{"title":"Line","description":"Positions x, y.","minOccurs":1,"maxOccurs":1,
"schema":{"type":"array","items":{"type":"array","items":{"type":"number"},"minItems":2,"maxItems":2},"minItems":1}},
"crs":{"title":"CRS","description":"CRS of the positions, as EPSG:n, URI or URN; without it the TIN's own.","minOccurs":0,"maxOccurs":1,
"schema":{"type":"string"}},
"voids":{"title":"Voids","description":"Whether cells that were nodata in the source raster have no surface (keep) or one across (fill).","minOccurs":0,"maxOccurs":1,
"schema":{"type":"string","enum":["keep","fill"],"default":"keep"}}
})";

constexpr std::string_view kProfileResult = R"({"type":"object",
"required":["distance","positions","z","length","lengthUnit","verticalUnit","revision"],
"properties":{
"distance":{"type":"array","items":{"type":"number"},"description":"On the ground from the start, along the line"},
"positions":{"type":"array","items":{"type":"array","items":{"type":"number"},"minItems":2,"maxItems":2},"description":"x, y"},
"z":{"type":"array","items":{"type":"number","nullable":true},"description":"Elevations; null: no surface from here to the next point"},
"length":{"type":"number","description":"Distance of the last point"},
"lengthUnit":{"type":"string","enum":["m","unit"],"description":"Of distances: m; unit where the TIN has no CRS"},
"verticalUnit":{"type":"string","nullable":true,"description":"Of elevations; null: not known"},
"revision":{"type":"integer","description":"Revision of the TIN"}
}})";

constexpr std::string_view kLineOfSightInputs = R"({
"tin":{"title":"TIN","description":"Id of the TIN.","minOccurs":1,"maxOccurs":1,
"schema":{"type":"string","pattern":"^[A-Za-z0-9][A-Za-z0-9_-]{0,63}$"}},
"observer":{"title":"Observer","description":"x, y","minOccurs":1,"maxOccurs":1,
"schema":{"type":"array","items":{"type":"number"},"minItems":2,"maxItems":2}},
"target":{"title":"Target","description":"x, y","minOccurs":1,"maxOccurs":1,
"schema":{"type":"array","items":{"type":"number"},"minItems":2,"maxItems":2}},
"observerHeight":{"title":"Observer's height","description":"Above the surface, in the TIN's vertical unit.","minOccurs":0,"maxOccurs":1,
"schema":{"type":"number","default":0}},
"targetHeight":{"title":"Target's height","description":"Above the surface, in the TIN's vertical unit.","minOccurs":0,"maxOccurs":1,
"schema":{"type":"number","default":0}},
"curvature":{"title":"Curvature","description":"Whether the earth's curvature counts.","minOccurs":0,"maxOccurs":1,
"schema":{"type":"boolean","default":false}},
"refraction":{"title":"Refraction","description":"What part of the curvature the bending of light takes back.","minOccurs":0,"maxOccurs":1,
"schema":{"type":"number","minimum":0,"maximum":1,"default":0.13}},
"crs":{"title":"CRS","description":"CRS of the positions, as EPSG:n, URI or URN; without it the TIN's own.","minOccurs":0,"maxOccurs":1,
"schema":{"type":"string"}},
"voids":{"title":"Voids","description":"Whether cells that were nodata in the source raster have no surface (keep) or one across (fill).","minOccurs":0,"maxOccurs":1,
"schema":{"type":"string","enum":["keep","fill"],"default":"keep"}}
})";

constexpr std::string_view kLineOfSightResult = R"({"type":"object",
"required":["visible","distance","observerZ","targetZ","closest","blockedAt","crossesGap","lengthUnit","verticalUnit","revision"],
"properties":{
"visible":{"type":"boolean","description":"Whether nothing blocks the line; touching does not"},
"distance":{"type":"number","description":"On the ground between both"},
"observerZ":{"type":"number","description":"Elevation of the eye"},
"targetZ":{"type":"number","description":"Elevation of what is looked at"},
"closest":{"type":"object","required":["position","distance","z","clearance"],"properties":{"position":{"type":"array","items":{"type":"number"},"minItems":2,"maxItems":2},"distance":{"type":"number"},"z":{"type":"number"},"clearance":{"type":"number"}},"description":"Where the line is least above the ground"},
"blockedAt":{"type":"object","nullable":true,"required":["position","distance","z","clearance"],"properties":{"position":{"type":"array","items":{"type":"number"},"minItems":2,"maxItems":2},"distance":{"type":"number"},"z":{"type":"number"},"clearance":{"type":"number"}},"description":"Where the ground first rises above the line; null when visible"},
"crossesGap":{"type":"boolean","description":"Whether the line runs outside the surface or over a void; nothing blocks it there"},
"lengthUnit":{"type":"string","enum":["m","unit"],"description":"Of distances: m; unit where the TIN has no CRS"},
"verticalUnit":{"type":"string","nullable":true,"description":"Of elevations; null: not known"},
"revision":{"type":"integer","description":"Revision of the TIN"}
}})";

}  // namespace

const ProcessDescription& contours_description() {
  static constexpr ProcessDescription description{
      "contours",
      "Contour lines",
      "Traces contour lines, exact on the triangles, with higher ground on the left. A vertex on a "
      "level counts as above it. The answer is GeoJSON; GET /tins/{tin}/contours gives the same as a "
      "stream of any length.",
      kContoursInputs,
      "A GeoJSON FeatureCollection of LineStrings with the properties elevation and closed",
      kContoursResult};
  return description;
}

const ProcessDescription& volume_description() {
  static constexpr ProcessDescription description{
      "volume",
      "Volume against a level",
      "Volumes between the surface and a level, above and below it, exact on the triangles; of all or "
      "within a polygon.",
      kVolumeInputs,
      "Volumes and areas",
      kVolumeResult};
  return description;
}

const ProcessDescription& cut_fill_description() {
  static constexpr ProcessDescription description{
      "cut-fill",
      "Cut and fill between two TINs",
      "What has to be taken away and filled up to turn the surface of a TIN into that of another, exact "
      "on the overlay of both triangulations; of all that both cover, or within a polygon.",
      kCutFillInputs,
      "Volumes and areas",
      kCutFillResult};
  return description;
}

const ProcessDescription& surface_area_description() {
  static constexpr ProcessDescription description{
      "surface-area",
      "Surface area",
      "Area of the surface, in the plan and along its slopes; of all or within a polygon.",
      kSurfaceAreaInputs,
      "Areas",
      kSurfaceAreaResult};
  return description;
}

const ProcessDescription& profile_description() {
  static constexpr ProcessDescription description{
      "profile",
      "Profile along a line",
      "Elevations along a line: at its own positions and wherever it crosses an edge of the TIN, so "
      "that the surface is straight in between.",
      kProfileInputs,
      "The profile's points, one list for each property",
      kProfileResult};
  return description;
}

const ProcessDescription& line_of_sight_description() {
  static constexpr ProcessDescription description{
      "line-of-sight",
      "Line of sight",
      "Whether a target can be seen from an observer, where the ground comes nearest to the line "
      "between them, and where it first blocks it.",
      kLineOfSightInputs,
      "What is seen",
      kLineOfSightResult};
  return description;
}

namespace {

/// The TIN's id, and the rest by `read`.
template <class Read>
auto read_about(const Value& value, std::initializer_list<std::string_view> members, const Read& read)
    -> Result<AboutTin<std::decay_t<decltype(*read(std::declval<Object>()))>>> {
  const auto object = value.object(members);
  if (!object) return object.error();
  auto tin = read_tin_id(*object, "tin");
  if (!tin) return std::move(tin).error();
  auto inputs = read(*object);
  if (!inputs) return std::move(inputs).error();
  return AboutTin<std::decay_t<decltype(*inputs)>>{std::move(*tin), std::move(*inputs)};
}

}  // namespace

Result<AboutTin<ContourInputs>> read_contours_process(const Value& inputs, std::size_t max_levels) {
  return read_about(inputs, {"tin", "interval", "base", "levels", "bbox", "crs", "voids"},
                    [&](const Object& object) { return read_contour_inputs(object, max_levels); });
}

Result<AboutTin<VolumeInputs>> read_volume_process(const Value& inputs, std::size_t max_positions) {
  return read_about(inputs, {"tin", "level", "polygon", "bbox", "crs", "voids"},
                    [&](const Object& object) { return read_volume_inputs(object, max_positions); });
}

Result<CutFillInputs> read_cut_fill_process(const Value& inputs, std::size_t max_positions) {
  const auto object = inputs.object({"tin", "after", "polygon", "bbox", "crs", "voids"});
  if (!object) return object.error();
  auto tin = read_tin_id(*object, "tin");
  if (!tin) return std::move(tin).error();
  auto after = read_tin_id(*object, "after");
  if (!after) return std::move(after).error();
  auto area = read_area_inputs(*object, max_positions);
  if (!area) return std::move(area).error();
  return CutFillInputs{std::move(*tin), std::move(*after), std::move(*area)};
}

Result<AboutTin<AreaInputs>> read_surface_area_process(const Value& inputs, std::size_t max_positions) {
  return read_about(inputs, {"tin", "polygon", "bbox", "crs", "voids"},
                    [&](const Object& object) { return read_area_inputs(object, max_positions); });
}

Result<AboutTin<PositionsInputs>> read_profile_process(const Value& inputs, std::size_t max_positions) {
  return read_about(inputs, {"tin", "positions", "crs", "voids"},
                    [&](const Object& object) { return read_positions_inputs(object, max_positions); });
}

Result<AboutTin<SightInputs>> read_line_of_sight_process(const Value& inputs) {
  return read_about(inputs,
                    {"tin", "observer", "target", "observerHeight", "targetHeight", "curvature", "refraction",
                     "crs", "voids"},
                    [](const Object& object) { return read_sight_inputs(object); });
}

}  // namespace proto
