#include "proto/processes/simplify.h"

#include "proto/bbox.h"

namespace proto {

using tin::base::Code;
using tin::base::error;
using tin::base::Result;

namespace {

constexpr std::size_t kMaxWord = 256;
constexpr std::int64_t kFewestVertices = 3;
constexpr double kMinSeconds = 0.001, kMaxSeconds = 86400;
constexpr std::int64_t kMaxCount = std::int64_t{1} << 53;  // exact in every JSON reader

// One line for each input and member, however long.
constexpr std::string_view kInputs = R"({
"tin":{"title":"TIN","description":"Id of the TIN to simplify.","minOccurs":1,"maxOccurs":1,
"schema":{"type":"string","pattern":"^[A-Za-z0-9][A-Za-z0-9_-]{0,63}$"}},
"tolerance":{"title":"Tolerance","description":"Largest vertical distance to any source sample, in the TIN's vertical unit; held at every sample unless maxVertices forbids it. tolerance or maxVertices must be given.","minOccurs":0,"maxOccurs":1,
"schema":{"type":"number","minimum":0}},
"maxVertices":{"title":"Largest number of vertices","description":"No more vertices than these remain. With a tolerance as well, this one wins where both cannot be had, and toleranceMet says so.","minOccurs":0,"maxOccurs":1,
"schema":{"type":"integer","minimum":3}},
"as":{"title":"New TIN","description":"Id of a TIN to make of the result; without it the TIN itself gets a new revision.","minOccurs":0,"maxOccurs":1,
"schema":{"type":"string","pattern":"^[A-Za-z0-9][A-Za-z0-9_-]{0,63}$"}},
"effort":{"title":"Effort","description":"How much time to spend on fewer vertices: balanced takes about three times as long as fast, thorough ten times, best fifty times or until maxSeconds.","minOccurs":0,"maxOccurs":1,
"schema":{"type":"string","enum":["fast","balanced","thorough","best"],"default":"balanced"}},
"elevations":{"title":"Elevations","description":"source: vertices have the elevations of the samples where they stand. fit: theirs may be any within the tolerance, which takes a fifth to a third fewer vertices; hull corners, what is protected and plateaus that are kept flat keep their own.","minOccurs":0,"maxOccurs":1,
"schema":{"type":"string","enum":["source","fit"],"default":"source"}},
"keepFlat":{"title":"Plateaus stay flat","description":"Water and other plateaus are not tilted within the tolerance: samples that are level with all their neighbours lie on the result exactly, where at least so many of them hang together; true: 64 of them.","minOccurs":0,"maxOccurs":1,
"schema":{"oneOf":[{"type":"boolean"},{"type":"integer","minimum":1,"maximum":9007199254740992}],"default":false}},
"against":{"title":"Against","description":"What stays within the tolerance. samples: every source sample. surface: every point of the surface that the samples make, triangulated; it takes more vertices and several times as long.","minOccurs":0,"maxOccurs":1,
"schema":{"type":"string","enum":["samples","surface"],"default":"samples"}},
"protect":{"title":"What stays","description":"Vertices that stay whatever they are worth: one item or an array of them, each a vertex id, a GeoJSON Polygon or MultiPolygon in the TIN's CRS (the vertices inside it), or the word border (those on the outline).","minOccurs":0,"maxOccurs":1,
"schema":{"oneOf":[{"type":"integer","minimum":1},{"type":"string","enum":["border"]},{"type":"object"},{"type":"array","items":{"oneOf":[{"type":"integer","minimum":1},{"type":"string","enum":["border"]},{"type":"object"}]}}]}},
"maxSeconds":{"title":"Time budget","description":"Once so much time is spent, the best result so far is certified and returned; the tolerance holds in any case, so that a first result may take longer. Without it, and at most, what the server's configuration allows.","minOccurs":0,"maxOccurs":1,
"schema":{"type":"number","minimum":0.001,"maximum":86400}},
"seed":{"title":"Seed","description":"Chooses the way of the search. The same inputs give the same result, unless time was up.","minOccurs":0,"maxOccurs":1,
"schema":{"type":"integer","minimum":0,"maximum":9007199254740992,"default":1}}
})";

constexpr std::string_view kResult = R"({"type":"object",
"required":["verticesBefore","verticesAfter","maxError","maxErrorAt","maxErrorSample","crs","verticalUnit","toleranceMet","editedMeanwhile","rmse","certifiedAgainst","samples","levelSamples","surfaceCrossings","samplesOutOfForce","outOfTime","histogram","seconds","tin","revision"],
"properties":{
"verticesBefore":{"type":"integer","description":"Vertices before"},
"verticesAfter":{"type":"integer","description":"Vertices after"},
"maxError":{"type":"number","description":"Largest vertical distance to a source sample, in the TIN's vertical unit"},
"maxErrorAt":{"type":"array","items":{"type":"number"},"minItems":2,"maxItems":2,"nullable":true,"description":"Where it is, in the TIN's CRS"},
"maxErrorSample":{"type":"object","nullable":true,"description":"The sample there: its own height, and its place in the source (column and row of a raster, index of points by position); a vertex that somebody made has no place, nor has a place between samples, whose height is then the surface's","properties":{"z":{"type":"number"},"column":{"type":"integer"},"row":{"type":"integer"},"index":{"type":"integer"}}},
"crs":{"type":"string","nullable":true,"description":"The TIN's CRS; null when it is not known"},
"verticalUnit":{"type":"string","nullable":true,"description":"Unit of maxError, rmse and the histogram; null when it is not known"},
"toleranceMet":{"type":"boolean","description":"Whether the tolerance holds; false only when maxVertices got in its way"},
"editedMeanwhile":{"type":"boolean","description":"Whether others edited the TIN while the job worked; their edits stand. Where toleranceMet, the errors are those of the revision that came of both, else of the version that the job saw"},
"rmse":{"type":"number","description":"Root mean square of the vertical distances"},
"certifiedAgainst":{"type":"string","enum":["original samples","vertices"],"description":"Original samples: those of the source, with people's edits in the place of the samples that they touched. Vertices: those of the TIN and those that earlier simplifications took away, where no source is kept"},
"samples":{"type":"integer","description":"How many samples that were"},
"levelSamples":{"type":"integer","description":"How many of them lie on plateaus that were kept flat"},
"surfaceCrossings":{"type":"integer","description":"How many crossings with edges of the samples' surface were measured besides"},
"samplesOutOfForce":{"type":"integer","description":"How many samples of the source do not count any more, because people edited there"},
"histogram":{"type":"object","description":"How many samples have which error: counts[i] of them in [i, i + 1) times bin, all larger ones in the last","properties":{"bin":{"type":"number"},"counts":{"type":"array","items":{"type":"integer"}}}},
"outOfTime":{"type":"boolean","description":"Whether a time budget ended the search"},
"seconds":{"type":"number","description":"Time the work took"},
"tin":{"type":"string","description":"Id of the simplified TIN"},
"revision":{"type":"integer","description":"Its revision"}
}})";

Result<void> read_goals(const Object& inputs, SimplifyInputs& request) {
  if (const auto member = inputs.find("tolerance")) {
    const auto tolerance = member->number();
    if (!tolerance) return tolerance.error();
    if (*tolerance < 0) return member->error(Code::kInvalidValue, "a tolerance must not be negative");
    request.tolerance = *tolerance;
  }
  if (const auto member = inputs.find("maxVertices")) {
    const auto count = member->integer(kFewestVertices, kMaxCount);
    if (!count) return count.error();
    request.max_vertices = static_cast<std::uint64_t>(*count);
  }
  if (!request.tolerance && !request.max_vertices) {
    return error(Code::kInvalidValue, "tolerance or maxVertices must be given", "/inputs");
  }
  return {};
}

constexpr std::size_t kMostProtected = 1'000'000;  // items, rings of a polygon, positions of a ring

Result<SimplifyProtect::Ring> read_ring(const Value& value) {
  const auto positions = value.array(kMostProtected);
  if (!positions) return positions.error();
  if (positions->size() < 3) return value.error(Code::kInvalidValue, "a ring has at least three positions");
  SimplifyProtect::Ring ring;
  for (const Value item : *positions) {
    const auto numbers = item.array(3);
    if (!numbers) return numbers.error();
    std::vector<double> at;
    for (const Value number : *numbers) {
      const auto read = number.number();
      if (!read) return read.error();
      at.push_back(*read);
    }
    if (at.size() < 2) return item.error(Code::kMalformed, "here must be x and y");
    ring.push_back({at[0], at[1]});
  }
  return ring;
}

Result<void> read_polygon(const Value& value, SimplifyProtect& protect) {
  const auto rings = value.array(kMostProtected);
  if (!rings) return rings.error();
  SimplifyProtect::Polygon polygon;
  for (const Value item : *rings) {
    auto ring = read_ring(item);
    if (!ring) return ring.error();
    polygon.push_back(*std::move(ring));
  }
  if (polygon.empty()) return value.error(Code::kInvalidValue, "a polygon has at least one ring");
  protect.polygons.push_back(std::move(polygon));
  return {};
}

Result<void> read_geometry(const Value& value, SimplifyProtect& protect) {
  const auto object = value.object({"type", "coordinates", "bbox"});
  if (!object) return object.error();
  const auto type = object->require("type");
  if (!type) return type.error();
  const auto name = type->string(kMaxWord);
  if (!name) return name.error();
  const auto coordinates = object->require("coordinates");
  if (!coordinates) return coordinates.error();
  if (*name == "Polygon") return read_polygon(*coordinates, protect);
  if (*name != "MultiPolygon")
    return type->error(Code::kInvalidValue, "what is protected is a Polygon or a MultiPolygon");
  const auto polygons = coordinates->array(kMostProtected);
  if (!polygons) return polygons.error();
  for (const Value polygon : *polygons) {
    if (auto fine = read_polygon(polygon, protect); !fine) return fine;
  }
  return {};
}

Result<void> read_protected(const Value& value, SimplifyProtect& protect) {
  if (const auto id = value.integer(1, kMaxCount)) {
    protect.ids.push_back({VertexId(static_cast<std::uint64_t>(*id)), value.pointer()});
    return {};
  }
  if (value.any_object()) return read_geometry(value, protect);
  const auto word = value.string(kMaxWord);
  if (!word || *word != "border")
    return value.error(Code::kInvalidValue, "what is protected is a vertex id, a GeoJSON polygon or \"border\"");
  protect.border = true;
  return {};
}

Result<void> read_protect(const Object& inputs, SimplifyProtect& protect) {
  const auto member = inputs.find("protect");
  if (!member) return {};
  if (!member->is_array()) return read_protected(*member, protect);
  const auto items = member->array(kMostProtected);
  if (!items) return items.error();
  for (const Value item : *items) {
    if (auto fine = read_protected(item, protect); !fine) return fine;
  }
  return {};
}

Result<std::uint64_t> read_keep_flat(const Value& value) {
  if (const auto wanted = value.boolean()) return *wanted ? kPlateauSamples : 0;
  const auto count = value.integer(1, kMaxCount);
  if (count) return static_cast<std::uint64_t>(*count);
  if (count.error().code == Code::kMalformed)
    return value.error(Code::kMalformed, "keepFlat is true, false or a number of samples");
  return count.error();
}

Result<void> check_seconds(double seconds, std::string where) {
  if (seconds >= kMinSeconds && seconds <= kMaxSeconds) return {};
  return error(Code::kInvalidValue, "maxSeconds must be from 0.001 to 86400", std::move(where));
}

Result<void> read_means(const Object& inputs, SimplifyInputs& request) {
  if (const auto member = inputs.find("effort")) {
    const auto word = member->string(kMaxWord);
    if (!word) return word.error();
    const auto effort = parse_effort(*word, member->pointer());
    if (!effort) return effort.error();
    request.effort = *effort;
  }
  if (const auto member = inputs.find("elevations")) {
    const auto word = member->string(kMaxWord);
    if (!word) return word.error();
    const auto elevations = parse_elevations(*word, member->pointer());
    if (!elevations) return elevations.error();
    request.elevations = *elevations;
  }
  if (const auto member = inputs.find("against")) {
    const auto word = member->string(kMaxWord);
    if (!word) return word.error();
    const auto against = parse_against(*word, member->pointer());
    if (!against) return against.error();
    request.against = *against;
  }
  if (const auto member = inputs.find("keepFlat")) {
    const auto flat = read_keep_flat(*member);
    if (!flat) return flat.error();
    request.keep_flat = *flat;
  }
  if (const auto member = inputs.find("maxSeconds")) {
    const auto seconds = member->number();
    if (!seconds) return seconds.error();
    if (auto fine = check_seconds(*seconds, member->pointer()); !fine) return fine;
    request.max_seconds = *seconds;
  }
  if (const auto member = inputs.find("seed")) {
    const auto seed = member->integer(0, kMaxCount);
    if (!seed) return seed.error();
    request.seed = static_cast<std::uint64_t>(*seed);
  }
  return {};
}

void write_worst(JsonWriter& json, const SimplifyWorst& worst) {
  json.key("maxErrorAt").begin_array().number(worst.x).number(worst.y).end_array();
  json.key("maxErrorSample").begin_object().key("z").number(worst.z);
  if (worst.column) json.key("column").integer(*worst.column);
  if (worst.row) json.key("row").integer(*worst.row);
  if (worst.index) json.key("index").integer(*worst.index);
  json.end_object();
}

}  // namespace

Result<SimplifyEffort> parse_effort(std::string_view text, std::string where) {
  if (text == "fast") return SimplifyEffort::kFast;
  if (text == "balanced") return SimplifyEffort::kBalanced;
  if (text == "thorough") return SimplifyEffort::kThorough;
  if (text == "best") return SimplifyEffort::kBest;
  return error(Code::kInvalidValue, "effort is fast, balanced, thorough or best", std::move(where));
}

Result<SimplifyElevations> parse_elevations(std::string_view text, std::string where) {
  if (text == "source") return SimplifyElevations::kSource;
  if (text == "fit") return SimplifyElevations::kFit;
  return error(Code::kInvalidValue, "elevations is source or fit", std::move(where));
}

Result<std::uint64_t> parse_keep_flat(std::string_view text, std::string where) {
  if (text == "true") return kPlateauSamples;
  if (text == "false") return 0;
  auto count = parse_count(text, 1, kMaxCount, where);
  if (!count && count.error().code == Code::kMalformed)
    return error(Code::kMalformed, "keepFlat is true, false or a number of samples", std::move(where));
  return count;
}

Result<std::uint64_t> parse_max_vertices(std::string_view text, const std::string& where) {
  return parse_count(text, kFewestVertices, kMaxCount, where);
}

Result<double> parse_max_seconds(std::string_view text, const std::string& where) {
  const auto seconds = parse_number(text, where);
  if (!seconds) return seconds;
  if (auto fine = check_seconds(*seconds, where); !fine) return fine.error();
  return seconds;
}

Result<std::uint64_t> parse_seed(std::string_view text, const std::string& where) {
  return parse_count(text, 0, kMaxCount, where);
}

Result<SimplifyAgainst> parse_against(std::string_view text, std::string where) {
  if (text == "samples") return SimplifyAgainst::kSamples;
  if (text == "surface") return SimplifyAgainst::kSurface;
  return error(Code::kInvalidValue, "against is samples or surface", std::move(where));
}

const ProcessDescription& simplify_description() {
  static constexpr ProcessDescription description{
      "simplify",
      "Simplify a TIN",
      "Takes vertices away as long as every source sample stays within a vertical tolerance, or until a "
      "number of vertices is reached.",
      kInputs,
      "What became of the TIN",
      kResult};
  return description;
}

Result<SimplifyInputs> read_simplify_inputs(const Value& value) {
  const auto inputs =
      value.object({"tin", "tolerance", "maxVertices", "as", "effort", "elevations", "keepFlat", "against", "maxSeconds",
                    "seed", "protect"});
  if (!inputs) return inputs.error();
  SimplifyInputs request;
  auto tin = read_tin_id(*inputs, "tin");
  if (!tin) return std::move(tin).error();
  request.tin = std::move(*tin);
  auto as = read_optional_tin_id(*inputs, "as");
  if (!as) return std::move(as).error();
  request.as = std::move(*as);
  if (auto goals = read_goals(*inputs, request); !goals) return goals.error();
  if (auto means = read_means(*inputs, request); !means) return means.error();
  if (auto protect = read_protect(*inputs, request.protect); !protect) return protect.error();
  return request;
}

void write_simplify_report(JsonWriter& json, const SimplifyResults& results) {
  json.key("verticesBefore").integer(results.vertices_before);
  json.key("verticesAfter").integer(results.vertices_after);
  json.key("maxError").number(results.max_error);
  if (results.worst) {
    write_worst(json, *results.worst);
  } else {
    json.key("maxErrorAt").null().key("maxErrorSample").null();
  }
  json.key("crs");
  results.crs.empty() ? json.null() : json.string(results.crs);
  json.key("verticalUnit");
  results.vertical_unit.empty() ? json.null() : json.string(results.vertical_unit);
  json.key("toleranceMet").boolean(results.tolerance_met);
  json.key("rmse").number(results.rmse);
  json.key("certifiedAgainst").string(results.against_source ? "original samples" : "vertices");
  json.key("samples").integer(results.samples);
  json.key("levelSamples").integer(results.level);
  json.key("surfaceCrossings").integer(results.crossings);
  json.key("samplesOutOfForce").integer(results.out_of_force);
  if (results.duplicates) json.key("duplicates").integer(*results.duplicates);
  json.key("histogram").begin_object().key("bin").number(results.histogram_bin).key("counts").begin_array();
  for (const std::uint64_t count : results.histogram) json.integer(count);
  json.end_array().end_object();
  json.key("outOfTime").boolean(results.out_of_time);
  json.key("seconds").number(results.seconds);
}

void write_simplify_results(JsonWriter& json, const SimplifyResults& results) {
  json.begin_object();
  write_simplify_report(json, results);
  json.key("editedMeanwhile").boolean(results.edited_meanwhile);
  json.key("tin").string(results.tin);
  json.key("revision").integer(results.revision);
  json.end_object();
}

std::string simplify_results_json(const SimplifyResults& results) {
  JsonWriter json;
  write_simplify_results(json, results);
  return json.take();
}

}  // namespace proto
