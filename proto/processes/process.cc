#include "proto/processes/process.h"

#include <algorithm>
#include <initializer_list>
#include <vector>

#include "proto/messages.h"
#include "proto/messages_internal.h"

namespace proto {

using tin::base::Code;
using tin::base::error;
using tin::base::Result;

namespace {

constexpr std::size_t kMaxWord = 256;

std::string without_newlines(std::string_view text) {
  std::string result;
  std::copy_if(text.begin(), text.end(), std::back_inserter(result), [](char c) { return c != '\n'; });
  return result;
}

/// The members of a summary, without its links.
void write_summary(JsonWriter& json, const ProcessDescription& process) {
  json.key("id").string(process.id);
  json.key("title").string(process.title);
  json.key("description").string(process.description);
  json.key("version").string("1.0.0");
  json.key("jobControlOptions").begin_array();
  json.string("sync-execute").string("async-execute").string("dismiss").end_array();
  json.key("outputTransmission").begin_array().string("value").end_array();
}

Link self_link(const ProcessDescription& process) {
  return {"/processes/" + std::string(process.id), "self", "application/json", "Description of the process"};
}

/// One of the words, where the member is there.
Result<std::optional<std::string_view>> read_word(const Object& object, std::string_view name,
                                                  std::initializer_list<std::string_view> words) {
  const auto member = object.find(name);
  if (!member) return std::optional<std::string_view>();
  const auto text = member->string(kMaxWord);
  if (!text) return text.error();
  const auto known = std::find(words.begin(), words.end(), *text);
  if (known != words.end()) return std::optional(*known);
  return member->error(Code::kInvalidValue, "this is no word that is known here");
}

/// "outputs" may name the one output that there is, by value.
Result<void> check_outputs(const Object& request) {
  const auto member = request.find("outputs");
  if (!member) return {};
  const auto outputs = member->object({"result"});
  if (!outputs) {
    auto problem = outputs.error();
    if (member->any_object()) problem.code = Code::kInvalidValue;
    return problem;
  }
  const auto wanted = outputs->find("result");
  if (!wanted) return {};
  const auto how = wanted->object({"transmissionMode", "format"});
  if (!how) return how.error();
  if (const auto mode = read_word(*how, "transmissionMode", {"value"}); !mode) return mode.error();
  const auto format = how->find("format");
  if (!format) return {};
  const auto members = format->object({"mediaType", "encoding", "schema"});
  if (!members) return members.error();
  const auto type = read_word(*members, "mediaType", {"application/json"});
  return type ? Result<void>() : type.error();
}

}  // namespace

std::string process_list_json(std::span<const ProcessDescription* const> processes) {
  JsonWriter json;
  json.begin_object().key("processes").begin_array();
  for (const ProcessDescription* process : processes) {
    json.begin_object();
    write_summary(json, *process);
    write_links(json, std::vector<Link>{self_link(*process)});
    json.end_object();
  }
  json.end_array();
  write_links(json, std::vector<Link>{{"/processes", "self", "application/json", "Processes"}});
  json.end_object();
  return json.take();
}

std::string process_json(const ProcessDescription& process) {
  JsonWriter json;
  json.begin_object();
  write_summary(json, process);
  json.key("inputs").raw(without_newlines(process.inputs));
  json.key("outputs").begin_object().key("result").begin_object();
  json.key("title").string(process.result_title);
  json.key("schema").raw(without_newlines(process.result_schema));
  json.end_object().end_object();
  const Link self = self_link(process);
  write_links(json, std::vector<Link>{self,
                                      {self.href + "/execution",
                                       "http://www.opengis.net/def/rel/ogc/1.0/execute", "application/json",
                                       "Execution"}});
  json.end_object();
  return json.take();
}

Result<ExecutionRequest> ExecutionRequest::read(std::string_view body) {
  auto document = Document::parse(body);
  if (!document) return std::move(document).error();
  ExecutionRequest request(std::move(*document));
  // "mode" is what drafts of the standard had in place of the header field Prefer; it changes nothing.
  const auto object = request.document_.root().object({"inputs", "outputs", "response", "mode"});
  if (!object) return object.error();
  if (auto fine = check_outputs(*object); !fine) return fine.error();
  const auto response = read_word(*object, "response", {"raw", "document"});
  if (!response) return response.error();
  if (const auto mode = read_word(*object, "mode", {"sync", "async", "auto"}); !mode) return mode.error();
  const auto inputs = object->require("inputs");
  if (!inputs) return inputs.error();
  if (const auto members = inputs->any_object(); !members) return members.error();
  request.as_document_ = *response == "document";
  return request;
}

Value ExecutionRequest::inputs() const {
  return *document_.root().any_object()->find("inputs");
}

std::string result_document(std::string_view result) {
  JsonWriter json;
  json.begin_object().key("result").raw(result).end_object();
  return json.take();
}

Result<std::optional<std::string>> read_optional_tin_id(const Object& inputs, std::string_view name) {
  const auto member = inputs.find(name);
  if (!member) return std::optional<std::string>();
  const auto text = member->string(std::string_view::npos);
  if (!text) return text.error();
  if (is_tin_id(*text)) return std::optional(std::string(*text));
  return member->error(Code::kInvalidValue,
                       "an id has 1 to 64 letters, digits, - and _, and begins with a letter or digit");
}

Result<std::string> read_tin_id(const Object& inputs, std::string_view name) {
  if (const auto member = inputs.require(name); !member) return member.error();
  auto id = read_optional_tin_id(inputs, name);
  if (!id) return std::move(id).error();
  return std::move(**id);
}

}  // namespace proto
