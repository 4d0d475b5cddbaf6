// What GET /processes and /processes/{process} say: OGC API Processes descriptions, written out by hand.
#include "proto/messages.h"
#include "proto/messages_internal.h"

namespace proto {
namespace {

constexpr std::string_view kSimplifyInputs = R"({
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

constexpr std::string_view kSimplifyOutputs = R"({
"verticesBefore":{"title":"Vertices before","schema":{"type":"integer"}},
"verticesAfter":{"title":"Vertices after","schema":{"type":"integer"}},
"maxError":{"title":"Largest vertical distance to a source sample, in the TIN's vertical unit","schema":{"type":"number"}},
"maxErrorAt":{"title":"Where it is, in the TIN's CRS","schema":{"type":"array","items":{"type":"number"},"minItems":2,"maxItems":2,"nullable":true}},
"toleranceMet":{"title":"Whether the tolerance holds; false only when maxVertices got in its way","schema":{"type":"boolean"}},
"editedMeanwhile":{"title":"Whether others edited the TIN while the job worked; their edits stand","schema":{"type":"boolean"}},
"rmse":{"title":"Root mean square of the vertical distances","schema":{"type":"number"}},
"seconds":{"title":"Time the work took","schema":{"type":"number"}},
"tin":{"title":"Id of the simplified TIN","schema":{"type":"string"}},
"revision":{"title":"Its revision","schema":{"type":"integer"}}
})";

std::string without_newlines(std::string_view text) {
  std::string result;
  for (const char c : text) {
    if (c != '\n') result += c;
  }
  return result;
}

/// The members of a summary, without its links.
void write_simplify_summary(JsonWriter& json) {
  json.key("id").string("simplify");
  json.key("title").string("Simplify a TIN");
  json.key("description")
      .string(
          "Takes vertices away as long as every source sample stays within a vertical tolerance, or until a "
          "number of vertices is reached.");
  json.key("version").string("1.0.0");
  json.key("jobControlOptions").begin_array().string("sync-execute").string("async-execute").string("dismiss").end_array();
  json.key("outputTransmission").begin_array().string("value").end_array();
}

}  // namespace

std::string process_list_json() {
  JsonWriter json;
  json.begin_object().key("processes").begin_array();
  json.begin_object();
  write_simplify_summary(json);
  write_links(json, std::vector<Link>{
                        {"/processes/simplify", "self", "application/json", "Description of the process"}});
  json.end_object();
  json.end_array();
  write_links(json, std::vector<Link>{{"/processes", "self", "application/json", "Processes"}});
  json.end_object();
  return json.take();
}

std::optional<std::string> process_json(std::string_view process) {
  if (process != "simplify") return std::nullopt;
  JsonWriter json;
  json.begin_object();
  write_simplify_summary(json);
  json.key("inputs").raw(without_newlines(kSimplifyInputs));
  json.key("outputs").raw(without_newlines(kSimplifyOutputs));
  write_links(json, std::vector<Link>{
                        {"/processes/simplify", "self", "application/json", "Description of the process"},
                        {"/processes/simplify/execution", "http://www.opengis.net/def/rel/ogc/1.0/execute",
                         "application/json", "Execution"}});
  json.end_object();
  return json.take();
}

}  // namespace proto
