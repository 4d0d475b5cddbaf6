#include "tests/contract/contract.h"

#include <algorithm>
#include <cctype>
#include <nlohmann/json.hpp>

#include "proto/openapi.h"
#include "tests/support/schema_check.h"

namespace tests::contract {
namespace {

using Json = nlohmann::json;

const Json& document() {
  static const Json parsed = Json::parse(proto::openapi_json());
  return parsed;
}

const Json& resolved(const Json& node) {
  const auto reference = node.find("$ref");
  return reference == node.end() ? node
                                 : document().at(Json::json_pointer(reference->get<std::string>().substr(1)));
}

std::vector<std::string> segments(const std::string& path) {
  std::vector<std::string> parts;
  for (std::size_t at = 0; at != std::string::npos && at < path.size();) {
    const std::size_t end = path.find('/', at + 1);
    parts.push_back(path.substr(at + 1, end == std::string::npos ? end : end - at - 1));
    at = end;
  }
  return parts;
}

bool fits(const std::string& path_template, const std::string& path) {
  const auto a = segments(path_template), b = segments(path);
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](const std::string& part, const std::string& given) {
                      return part.starts_with('{') ? !given.empty() : part == given;
                    });
}

const Json* operation_node(const std::string& operation) {
  const std::size_t space = operation.find(' ');
  if (space == std::string::npos) return nullptr;
  std::string method = operation.substr(0, space);
  for (char& c : method) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  const auto& paths = document().at("paths");
  const auto path = paths.find(operation.substr(space + 1));
  return path != paths.end() && path->contains(method) ? &path->at(method) : nullptr;
}

std::set<std::string> parameters(const std::string& operation, const std::string& in) {
  std::set<std::string> names;
  const auto collect = [&](const Json& holder) {
    for (const Json& entry : holder.value("parameters", Json::array())) {
      const Json& parameter = resolved(entry);
      if (parameter.at("in") == in) names.insert(parameter.at("name").get<std::string>());
    }
  };
  collect(document().at("paths").at(operation.substr(operation.find(' ') + 1)));
  collect(*operation_node(operation));
  return names;
}

void check_common_fields(const RawAnswer& answer, std::vector<std::string>& wrong) {
  if (!answer.complete) wrong.push_back("the answer was cut");
  if (answer.header("access-control-allow-origin") != "*") wrong.push_back("no CORS field");
  for (const char* exposed : {"ETag", "Location", "Link", "Content-Crs"}) {
    if (answer.header("access-control-expose-headers").find(exposed) == std::string::npos) {
      wrong.push_back(std::string("not exposed: ") + exposed);
    }
  }
  if (answer.header("x-request-id").empty()) wrong.push_back("no X-Request-Id");
}

void check_problem(const RawAnswer& answer, std::vector<std::string>& wrong) {
  if (answer.header("content-type") != "application/problem+json")
    wrong.push_back("an error without a problem document");
  for (const auto& line : tests_support::schema_violations("Problem", answer.body))
    wrong.push_back("problem: " + line);
  const Json problem = Json::parse(answer.body, nullptr, false);
  if (!problem.is_object()) return;
  if (problem.value("status", 0) != answer.status) wrong.push_back("the problem has another status");
  const std::string type = problem.value("type", "");
  if (!type.starts_with("/problems/") && !type.starts_with("http://www.opengis.net/def/exceptions/ogcapi-processes-1/1.0/"))
    wrong.push_back("the problem's type is no slug of ours");
  if (problem.value("detail", "").empty()) wrong.push_back("the problem says nothing");
  if (answer.status == 405 && answer.header("allow").empty()) wrong.push_back("405 without Allow");
  const bool later = answer.status == 429 || answer.status == 503;
  if (later && answer.header("retry-after").empty()) wrong.push_back("no Retry-After");
}

void check_documented_fields(const Json& response, const RawAnswer& answer, bool preferred,
                             std::vector<std::string>& wrong) {
  const Json fields = response.value("headers", Json::object());
  const Json body = Json::parse(answer.body, nullptr, false);
  const bool is_job = body.is_object() && body.contains("jobID");
  for (const auto& [name, field] : fields.items()) {
    if (name == "Preference-Applied" ? !is_job || !preferred : (name == "ETag" && is_job)) continue;
    if (name == "Content-Crs") continue;  // a TIN may have no CRS
    std::string lower = name;
    for (char& c : lower) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    if (answer.header(lower).empty()) wrong.push_back("no " + name);
  }
  if (!preferred && !answer.header("preference-applied").empty())
    wrong.push_back("a preference applied that nobody stated");
  const std::string tag = answer.header("etag");
  if (tag.empty()) return;
  if (!fields.contains("ETag")) wrong.push_back("an ETag that is not documented");
  if (tag.size() < 3 || tag.front() != '"' || tag.back() != '"') wrong.push_back("no strong ETag: " + tag);
}

}  // namespace

std::string operation_of(const Ask& ask) {
  const std::string method = ask.method == "HEAD" ? "GET" : ask.method;
  const std::string path = ask.target.substr(0, ask.target.find('?'));
  for (const std::string& operation : tests_support::documented_operations()) {
    if (operation.starts_with(method + " ") && fits(operation.substr(method.size() + 1), path))
      return operation;
  }
  return {};
}

std::vector<std::string> breaches(const Ask& ask, const RawAnswer& answer) {
  std::vector<std::string> wrong;
  check_common_fields(answer, wrong);
  if (answer.status >= 400 && ask.method != "HEAD") check_problem(answer, wrong);
  const std::string operation = operation_of(ask);
  if (operation.empty()) {
    if (answer.status < 400 && answer.status != 308 && ask.method != "OPTIONS")
      wrong.push_back("an answer of no documented operation");
    return wrong;
  }
  if (answer.status == 304 || ask.method == "HEAD") return wrong;
  const Json& responses = operation_node(operation)->at("responses");
  const auto listed = responses.find(std::to_string(answer.status));
  if (listed != responses.end() && answer.status < 400)
    check_documented_fields(resolved(*listed), answer, ask.fields.find("respond-async") != std::string::npos,
                            wrong);
  const std::string type = answer.header("content-type");
  const std::string plain = type.starts_with("text/html") ? "text/html" : type;
  if (plain.find("json") == std::string::npos && !(plain.empty() && answer.body.empty())) {
    const Json content = listed != responses.end() ? resolved(*listed).value("content", Json::object()) : Json::object();
    const bool known = content.contains(plain) || content.contains(plain.substr(0, plain.find(';')));
    if (!known) wrong.push_back("media type " + plain + " is not documented");
    return wrong;
  }
  const std::size_t space = operation.find(' ');
  for (const auto& line : tests_support::violations(operation.substr(0, space), operation.substr(space + 1),
                                                    answer.status, answer.body, plain)) {
    wrong.push_back(line);
  }
  return wrong;
}

std::set<std::string> documented_query(const std::string& operation) {
  return parameters(operation, "query");
}

std::set<std::string> documented_path_parameters(const std::string& operation) {
  return parameters(operation, "path");
}

bool documents_a_body(const std::string& operation) {
  return operation_node(operation)->contains("requestBody");
}

std::set<std::string> documented_statuses() {
  std::set<std::string> all;
  for (const std::string& operation : tests_support::documented_operations()) {
    for (const auto& [status, response] : operation_node(operation)->at("responses").items()) {
      if (status != "default") all.insert(operation + " " + status);
    }
  }
  return all;
}

}  // namespace tests::contract
