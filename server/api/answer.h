// What all resources answer alike: JSON, problems, entity tags.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "server/app/tin.h"
#include "server/http/message.h"
#include "server/http/options.h"
#include "tin/base/result.h"

namespace server::api {

using http::Request;
using http::Response;
using tin::base::Result;

inline constexpr std::string_view kJson = "application/json";

Response json_answer(std::string body, int status = 200);
Response problem_answer(const tin::base::Error& error);

/// A problem that no error code stands for, such as 428.
Response status_answer(int status, const std::string& detail);

/// The pages that the HTTP server uses for its own errors.
http::ErrorPages error_pages();

/// A handler whose errors become problem documents.
http::Handler guarded(std::function<Result<Response>(Request&)> handler);

/// The strong entity tag of a representation of a TIN: the TIN's creation, its revision, and what was asked
/// for.
std::string entity_tag(const app::Tin& tin, std::uint64_t revision, const Request& request);
/// The revisions that an If-Match field allows; none when it allows all ("" or "*").
/// Errors: kPrecondition when it holds no tag of this TIN.
Result<std::vector<std::uint64_t>> expected_revisions(const app::Tin& tin, std::string_view if_match);

/// The request's Idempotency-Key with a fingerprint of the request, if it bears one. Errors: kMalformed.
Result<std::optional<app::RequestKey>> request_key(const Request& request);

/// "2026-11-27T08:15:00Z".
std::string rfc3339(std::int64_t unix_ms);

/// Whether the client prefers to be answered at once and to ask for the result later (RFC 7240).
bool prefers_async(const Request& request);

/// Prepends where an index came from: "/3" in "/ops" becomes "/ops/3".
tin::base::Error within(std::string_view place, tin::base::Error error);

/// The body's media type without parameters, in lower case.
std::string media_type(const Request& request);
/// Errors: kUnsupported unless the body says that it is JSON.
Result<void> require_json(const Request& request);

}  // namespace server::api
