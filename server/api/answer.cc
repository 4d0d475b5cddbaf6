#include "server/api/answer.h"

#include <algorithm>
#include <charconv>
#include <ctime>

#include "proto/problems.h"
#include "tin/codec/crc32c.h"

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

void append_number(std::string& out, std::uint64_t number) {
  for (int i = 0; i < 8; ++i) out += static_cast<char>(number >> (8 * i));
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

Response status_answer(int status, const std::string& detail) {
  return problem_response(proto::status_problem(status, detail));
}

Response processes_exception(const tin::base::Error& problem, std::string_view name) {
  proto::Problem document = proto::to_problem(problem);
  document.uri = "http://www.opengis.net/def/exceptions/ogcapi-processes-1/1.0/" + std::string(name);
  return problem_response(document);
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
  asked.append(1, '\n').append(tin.title());  // which the TIN's document shows, and no revision counts
  for (const auto& [name, value] : request.query)
    asked.append(1, '\n').append(name).append(1, '=').append(value);
  char digits[17];
  const auto end = std::to_chars(digits, digits + 16, hash(asked), 16).ptr;
  return "\"" + tag_prefix(tin) + std::to_string(revision) + "-" + std::string(digits, end) + "\"";
}

Result<std::vector<std::uint64_t>> expected_revisions(const app::Tin& tin, std::string_view if_match) {
  std::vector<std::uint64_t> revisions;
  if (if_match.empty() || if_match == "*") return revisions;
  const std::string prefix = "\"" + tag_prefix(tin);
  while (!if_match.empty()) {
    const auto comma = std::min(if_match.find(','), if_match.size());
    std::string_view tag = if_match.substr(0, comma);
    if_match.remove_prefix(std::min(comma + 1, if_match.size()));
    while (tag.starts_with(' ') || tag.starts_with('\t')) tag.remove_prefix(1);
    // Weak tags ("W/...") never match here (RFC 9110, 13.1.1), and neither does another TIN's.
    if (!tag.starts_with(prefix)) continue;
    std::uint64_t revision = 0;
    const char* digits = tag.data() + prefix.size();
    const auto parsed = std::from_chars(digits, tag.data() + tag.size(), revision);
    if (parsed.ec == std::errc{} && parsed.ptr != tag.data() + tag.size() && *parsed.ptr == '-') {
      revisions.push_back(revision);
    }
  }
  if (revisions.empty()) {
    return error(Code::kPrecondition, "If-Match names no revision of this TIN.", "header:If-Match");
  }
  return revisions;
}

Result<std::optional<app::RequestKey>> request_key(const Request& request) {
  constexpr std::size_t kMostBytes = 255;
  const std::string_view key = request.header("idempotency-key");
  if (key.empty()) return std::optional<app::RequestKey>();
  const bool printable = std::all_of(key.begin(), key.end(), [](char c) { return c > ' ' && c <= '~'; });
  if (key.size() > kMostBytes || !printable) {
    return error(Code::kMalformed, "An Idempotency-Key has 1 to 255 printable ASCII characters.",
                 "header:Idempotency-Key");
  }
  // Two hashes and the length: nobody gains by a collision, which would take the client's own key.
  std::string request_print;
  std::string asked = std::string(request.path).append(1, '\n').append(request.body);
  if (request.method != http::Method::kPost) asked.append(1, '\n').append(http::method_name(request.method));
  asked.append(request.header("content-crs"));
  for (const std::string_view name : {"author", "note"}) {
    if (const auto text = request.query_value(name)) asked.append(1, '\n').append(*text);
  }
  append_number(request_print, hash(asked));
  append_number(request_print, tin::codec::crc32c(request.body));
  append_number(request_print, request.body.size());
  return std::optional(app::RequestKey{std::string(key), std::move(request_print)});
}

std::string rfc3339(std::int64_t unix_ms) {
  const std::time_t seconds = unix_ms / 1000;
  std::tm utc{};
  gmtime_r(&seconds, &utc);
  char text[32];
  std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", &utc);
  return text;
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
