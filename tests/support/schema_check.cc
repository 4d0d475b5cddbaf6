#include "tests/support/schema_check.h"

#include <algorithm>
#include <cctype>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <valijson/adapters/nlohmann_json_adapter.hpp>
#include <valijson/schema.hpp>
#include <valijson/schema_parser.hpp>
#include <valijson/validation_results.hpp>
#include <valijson/validator.hpp>

#include "proto/openapi.h"

namespace tests_support {
namespace {

using Json = nlohmann::json;
using Adapter = valijson::adapters::NlohmannJsonAdapter;

const Json& contract() {
  static const Json document = Json::parse(proto::openapi_json());
  return document;
}

std::string lower(std::string_view text) {
  std::string result(text);
  std::transform(result.begin(), result.end(), result.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return result;
}

/// What a local reference stands for; anything else stands for itself.
const Json& resolved(const Json& node) {
  const auto reference = node.find("$ref");
  if (reference == node.end()) return node;
  return contract().at(Json::json_pointer(reference->get<std::string>().substr(1)));
}

/// OpenAPI 3.0's dialect said in JSON Schema draft 7: references replaced by what they stand for (the
/// contract has no recursive schema), nullable by a second type, and objects closed.
Json translated(const Json& schema_or_reference) {
  const Json& schema = resolved(schema_or_reference);
  if (schema.is_array()) {
    Json list = Json::array();
    for (const Json& item : schema) list.push_back(translated(item));
    return list;
  }
  Json result = schema;
  result.erase("example");
  for (const char* keyword : {"items", "additionalProperties", "oneOf", "anyOf", "allOf", "not"}) {
    if (result.contains(keyword) && result[keyword].is_structured())
      result[keyword] = translated(schema[keyword]);
  }
  if (result.contains("properties")) {
    for (auto& [name, property] : result["properties"].items()) property = translated(property);
    if (!result.contains("additionalProperties")) result["additionalProperties"] = false;
  }
  if (result.value("nullable", false)) {
    result["type"] = Json::array({result.at("type"), "null"});
    if (result.contains("enum")) result["enum"].push_back(nullptr);
  }
  result.erase("nullable");
  return result;
}

std::vector<std::string> validate(const Json& schema_node, const Json& value) {
  const Json draft7 = translated(schema_node);
  valijson::Schema schema;
  valijson::SchemaParser(valijson::SchemaParser::kDraft7).populateSchema(Adapter(draft7), schema);
  valijson::ValidationResults results;
  if (valijson::Validator().validate(schema, Adapter(value), &results)) return {};
  std::vector<std::string> lines;
  valijson::ValidationResults::Error error;
  while (results.popError(error)) {
    std::string line;
    for (const std::string& step : error.context) line += step;
    lines.push_back(line + ": " + error.description);
  }
  return lines;
}

std::vector<std::string> validate_text(const Json& schema_node, std::string_view body) {
  const Json value = Json::parse(body, nullptr, false);
  if (value.is_discarded()) return {std::string("not JSON: ").append(body.substr(0, 200))};
  return validate(schema_node, value);
}

const Json* find_operation(std::string_view method, std::string_view path_template) {
  const auto path = contract().at("paths").find(std::string(path_template));
  if (path == contract().at("paths").end()) return nullptr;
  const auto operation = path->find(lower(method));
  return operation == path->end() ? nullptr : &*operation;
}

/// The entry of `content` for a media type (parameters as they stand), or the only one that is JSON.
const Json* find_media(const Json& content, std::string_view media_type) {
  if (!media_type.empty()) {
    const auto entry = content.find(std::string(media_type));
    return entry == content.end() ? nullptr : &*entry;
  }
  for (const auto& [name, entry] : content.items()) {
    if (name.find("json") != std::string::npos) return &entry;
  }
  return nullptr;
}

void collect_examples(const Json& node, const std::string& path, std::vector<std::string>& wrong) {
  if (!node.is_structured()) return;
  if (node.is_object() && node.contains("example")) {
    // In a parameter or media type the schema stands beside the example; elsewhere the node is the schema.
    const Json& schema = node.contains("schema") ? node.at("schema") : node;
    for (const std::string& line : validate(schema, node.at("example"))) wrong.push_back(path + " " + line);
  }
  for (const auto& [name, child] : node.items()) {
    if (name != "example") collect_examples(child, path + "/" + name, wrong);
  }
}

}  // namespace

std::vector<std::string> violations(std::string_view method, std::string_view path_template, int status,
                                    std::string_view body, std::string_view media_type) {
  const std::string name = std::string(method) + " " + std::string(path_template);
  const Json* operation = find_operation(method, path_template);
  if (operation == nullptr) return {name + " is not documented"};
  const Json& responses = operation->at("responses");
  const auto listed = responses.find(std::to_string(status));
  if (listed == responses.end() && status < 400) {
    return {name + " has no documented answer " + std::to_string(status)};
  }
  const Json& response = resolved(listed != responses.end() ? *listed : responses.at("default"));
  if (!response.contains("content")) {
    return body.empty() ? std::vector<std::string>()
                        : std::vector<std::string>{name + ": a body that is not documented"};
  }
  const Json* media = find_media(response.at("content"), media_type);
  if (media == nullptr) return {name + ": media type " + std::string(media_type) + " is not documented"};
  return validate_text(media->at("schema"), body);
}

std::vector<std::string> request_violations(std::string_view method, std::string_view path_template,
                                            std::string_view body) {
  const Json* operation = find_operation(method, path_template);
  if (operation == nullptr || !operation->contains("requestBody")) return {"no such documented request"};
  const Json* media = find_media(operation->at("requestBody").at("content"), "application/json");
  if (media == nullptr) return {"no documented JSON body"};
  return validate_text(media->at("schema"), body);
}

std::vector<std::string> schema_violations(std::string_view schema_name, std::string_view body) {
  const Json& schemas = contract().at("components").at("schemas");
  const auto schema = schemas.find(std::string(schema_name));
  if (schema == schemas.end()) return {std::string("there is no schema ").append(schema_name)};
  return validate_text(*schema, body);
}

std::vector<std::string> example_violations() {
  std::vector<std::string> wrong;
  collect_examples(contract(), "", wrong);
  return wrong;
}

std::vector<std::string> documented_operations() {
  std::vector<std::string> operations;
  for (const auto& [path, item] : contract().at("paths").items()) {
    for (const auto& [method, operation] : item.items()) {
      if (method == "parameters") continue;
      std::string upper = method;
      std::transform(upper.begin(), upper.end(), upper.begin(),
                     [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
      operations.push_back(upper + " " + path);
    }
  }
  return operations;
}

}  // namespace tests_support
