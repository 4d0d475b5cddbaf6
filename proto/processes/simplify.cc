#include "proto/processes/simplify.h"

#include "proto/json_write.h"

namespace proto {

using tin::base::Code;
using tin::base::error;
using tin::base::Result;

namespace {

constexpr std::size_t kMaxWord = 256;
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
"effort":{"title":"Effort","description":"How much time to spend on fewer vertices.","minOccurs":0,"maxOccurs":1,
"schema":{"type":"string","enum":["fast"],"default":"fast"}}
})";

constexpr std::string_view kResult = R"({"type":"object",
"required":["verticesBefore","verticesAfter","maxError","maxErrorAt","toleranceMet","editedMeanwhile","rmse","seconds","tin","revision"],
"properties":{
"verticesBefore":{"type":"integer","description":"Vertices before"},
"verticesAfter":{"type":"integer","description":"Vertices after"},
"maxError":{"type":"number","description":"Largest vertical distance to a source sample, in the TIN's vertical unit"},
"maxErrorAt":{"type":"array","items":{"type":"number"},"minItems":2,"maxItems":2,"nullable":true,"description":"Where it is, in the TIN's CRS"},
"toleranceMet":{"type":"boolean","description":"Whether the tolerance holds; false only when maxVertices got in its way"},
"editedMeanwhile":{"type":"boolean","description":"Whether others edited the TIN while the job worked; their edits stand"},
"rmse":{"type":"number","description":"Root mean square of the vertical distances"},
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
    const auto count = member->integer(3, kMaxCount);
    if (!count) return count.error();
    request.max_vertices = static_cast<std::uint64_t>(*count);
  }
  if (const auto member = inputs.find("effort")) {
    const auto effort = member->string(kMaxWord);
    if (!effort) return effort.error();
    if (*effort != "fast") {
      return member->error(Code::kInvalidValue, "there is no such effort; there is: fast");
    }
  }
  if (!request.tolerance && !request.max_vertices) {
    return error(Code::kInvalidValue, "tolerance or maxVertices must be given", "/inputs");
  }
  return {};
}

}  // namespace

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
  const auto inputs = value.object({"tin", "tolerance", "maxVertices", "as", "effort"});
  if (!inputs) return inputs.error();
  SimplifyInputs request;
  auto tin = read_tin_id(*inputs, "tin");
  if (!tin) return std::move(tin).error();
  request.tin = std::move(*tin);
  auto as = read_optional_tin_id(*inputs, "as");
  if (!as) return std::move(as).error();
  request.as = std::move(*as);
  if (auto goals = read_goals(*inputs, request); !goals) return goals.error();
  return request;
}

std::string simplify_results_json(const SimplifyResults& results) {
  JsonWriter json;
  json.begin_object();
  json.key("verticesBefore").integer(results.vertices_before);
  json.key("verticesAfter").integer(results.vertices_after);
  json.key("maxError").number(results.max_error);
  json.key("maxErrorAt");
  if (results.max_error_at) {
    json.begin_array().number(results.max_error_at->x).number(results.max_error_at->y).end_array();
  } else {
    json.null();
  }
  json.key("toleranceMet").boolean(results.tolerance_met);
  json.key("editedMeanwhile").boolean(results.edited_meanwhile);
  json.key("rmse").number(results.rmse);
  json.key("seconds").number(results.seconds);
  json.key("tin").string(results.tin);
  json.key("revision").integer(results.revision);
  json.end_object();
  return json.take();
}

}  // namespace proto
