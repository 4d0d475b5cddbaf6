#include "server/api/answer.h"

#include <charconv>

#include "proto/problems.h"

namespace server::api {

using tin::base::Code;
using tin::base::error;

namespace {

Response problem_response(const proto::Problem& problem) {
  Response response{problem.status,
                    {{"Content-Type", std::string(proto::kProblemMediaType)}},
                    proto::problem_json(problem)};
  if (problem.retry_after_s)
    response.headers.emplace_back("Retry-After", std::to_string(*problem.retry_after_s));
  return response;
}

/// FNV-1a: short names for queries within entity tags.
std::uint64_t hash(std::string_view text) {
  std::uint64_t value = 0xcbf29ce484222325ULL;
  for (const char c : text) value = (value ^ static_cast<unsigned char>(c)) * 0x100000001b3ULL;
  return value;
}

std::string tag_prefix(const app::Tin& tin) {
  return std::to_string(tin.created_ms()) + "-";
}

}  // namespace

Response json_answer(std::string body, int status) {
  return {status, {{"Content-Type", std::string(kJson)}}, std::move(body)};
}

Response problem_answer(const tin::base::Error& problem) {
  return problem_response(proto::to_problem(problem));
}

http::ErrorPages error_pages() {
  return {[](const tin::base::Error& problem) { return problem_answer(problem); },
          [](int status, const std::string& detail) {
            return problem_response(proto::status_problem(status, detail));
          }};
}

http::Handler guarded(std::function<Result<Response>(Request&)> handler) {
  return [handler = std::move(handler)](Request& request) {
    auto answer = handler(request);
    return answer ? std::move(*answer) : problem_answer(answer.error());
  };
}

std::string entity_tag(const app::Tin& tin, std::uint64_t revision, const Request& request) {
  std::string asked = request.path;
  for (const auto& [name, value] : request.query)
    asked.append(1, '\n').append(name).append(1, '=').append(value);
  char digits[17];
  const auto end = std::to_chars(digits, digits + 16, hash(asked), 16).ptr;
  return "\"" + tag_prefix(tin) + std::to_string(revision) + "-" + std::string(digits, end) + "\"";
}

Result<std::optional<std::uint64_t>> expected_revision(const app::Tin& tin, std::string_view if_match) {
  if (if_match.empty() || if_match == "*") return std::optional<std::uint64_t>();
  const std::string prefix = "\"" + tag_prefix(tin);
  std::optional<std::uint64_t> newest;
  for (std::size_t at = if_match.find(prefix); at != std::string_view::npos;
       at = if_match.find(prefix, at + 1)) {
    if (at >= 2 && if_match.substr(at - 2, 2) == "W/")
      continue;  // a weak tag never matches here (RFC 9110, 13.1.1)
    std::uint64_t revision = 0;
    const char* digits = if_match.data() + at + prefix.size();
    const auto parsed = std::from_chars(digits, if_match.data() + if_match.size(), revision);
    if (parsed.ec == std::errc{}) newest = std::max(newest.value_or(0), revision);
  }
  if (!newest) {
    return error(Code::kPrecondition, "If-Match names no revision of this TIN.", "header:If-Match");
  }
  return newest;
}

bool prefers_async(const Request& request) {
  return http::lower_case(request.header("prefer")).find("respond-async") != std::string::npos;
}

tin::base::Error within(std::string_view place, tin::base::Error problem) {
  problem.where = std::string(place) + problem.where;
  return problem;
}

std::string media_type(const Request& request) {
  std::string type = http::lower_case(request.header("content-type"));
  type.resize(std::min(type.size(), type.find(';')));
  while (!type.empty() && type.back() == ' ') type.pop_back();
  return type;
}

Result<void> require_json(const Request& request) {
  const std::string type = media_type(request);
  if (type == kJson || type.ends_with("+json")) return {};
  return error(Code::kUnsupported,
               "The body must be JSON (Content-Type: application/json), not \"" + type + "\".",
               "header:Content-Type");
}

}  // namespace server::api
