#include "proto/problems.h"

#include "proto/json_write.h"

namespace proto {
namespace {

using tin::base::Code;

struct Row {
  int status;
  std::string_view slug;
  std::string_view title;
};

/// The table. A code that is missing here does not compile (-Wswitch, -Wreturn-type are errors).
Row row_of(Code code) {
  switch (code) {
    case Code::kMalformed:
      return {400, "malformed", "The request cannot be read"};
    case Code::kUnknownParameter:
      return {400, "unknown-parameter", "The resource has no such parameter"};
    case Code::kNotFound:
      return {404, "not-found", "There is no such resource"};
    case Code::kUnknownVertex:
      return {422, "unknown-vertex", "There is no such vertex"};
    case Code::kNotFinite:
      return {422, "not-finite", "A number is not finite"};
    case Code::kOutsideLattice:
      return {422, "outside-lattice", "A position lies too far from the origin of the TIN"};
    case Code::kDuplicatePosition:
      return {409, "duplicate-position", "A vertex stands at this position already"};
    case Code::kInvalidValue:
      return {422, "invalid-value", "A value is not possible here"};
    case Code::kUnsupported:
      return {415, "unsupported", "The media type or format is not supported"};
    case Code::kConflict:
      return {409, "conflict", "The present state does not allow this"};
    case Code::kPrecondition:
      return {412, "precondition-failed", "The resource has changed"};
    case Code::kGone:
      return {410, "gone", "What was asked for is no longer kept"};
    case Code::kTooLarge:
      return {413, "too-large", "The request is larger than the limit"};
    case Code::kTooMany:
      return {429, "too-many-requests", "Too many requests at once"};
    case Code::kCancelled:
      return {409, "cancelled", "The work was stopped on request"};
    case Code::kStorage:
      return {503, "storage", "The store is not available"};
    case Code::kNoSpace:
      return {507, "insufficient-storage", "There is no room left"};
    case Code::kInternal:
      return {500, "internal", "The server met an error of its own"};
  }
  return {500, "internal", "The server met an error of its own"};
}

Row row_of_status(int status) {
  switch (status) {
    case 401:
      return {401, "unauthorized", "Credentials are needed"};
    case 403:
      return {403, "forbidden", "This is not allowed"};
    case 404:
      return row_of(Code::kNotFound);
    case 405:
      return {405, "method-not-allowed", "The resource does not have this method"};
    case 406:
      return {406, "not-acceptable", "None of the accepted media types can be given"};
    case 408:
      return {408, "request-timeout", "The request took too long to arrive"};
    case 409:
      return row_of(Code::kConflict);
    case 410:
      return row_of(Code::kGone);
    case 411:
      return {411, "length-required", "The length of the body is needed"};
    case 412:
      return row_of(Code::kPrecondition);
    case 413:
      return row_of(Code::kTooLarge);
    case 414:
      return {414, "uri-too-long", "The request's target is too long"};
    case 415:
      return row_of(Code::kUnsupported);
    case 417:
      return {417, "expectation-failed", "The expectation cannot be met"};
    case 422:
      return row_of(Code::kInvalidValue);
    case 428:
      return {428, "precondition-required", "The request must say which state it is for"};
    case 429:
      return row_of(Code::kTooMany);
    case 431:
      return {431, "headers-too-large", "The request's header fields are too large"};
    case 500:
      return row_of(Code::kInternal);
    case 501:
      return {501, "not-implemented", "The server does not do this"};
    case 503:
      return {503, "unavailable", "The server cannot answer now"};
    case 505:
      return {505, "http-version", "The HTTP version is not supported"};
    case 507:
      return row_of(Code::kNoSpace);
    default:
      return status >= 400 && status < 500 ? Row{status, "malformed", "The request cannot be answered"}
                                           : Row{status, "internal", "The server met an error of its own"};
  }
}

constexpr int kTooManyRetry_s = 1;
constexpr int kUnavailableRetry_s = 5;

std::optional<int> retry_after_s(int status) {
  if (status == 429) return kTooManyRetry_s;
  if (status == 503) return kUnavailableRetry_s;
  return std::nullopt;
}

Problem make_problem(const Row& row, std::string detail, std::string where) {
  return Problem{row.status,        std::string(row.slug), std::string(row.title),
                 std::move(detail), std::move(where),      "",
                 retry_after_s(row.status)};
}

}  // namespace

Problem to_problem(const tin::base::Error& error) {
  const Row row = row_of(error.code);
  if (error.code == Code::kInternal) {
    return make_problem(row, "The request was not carried out. The server's log says why.", {});
  }
  if (error.code == Code::kStorage) {
    return make_problem(row, "Nothing was changed. The server's log says why; try again later.", {});
  }
  if (error.code == Code::kNoSpace) {
    return make_problem(row, "Nothing was changed: the disk has no room. Try again when there is some.", {});
  }
  return make_problem(row, error.message, error.where);
}

Problem status_problem(int status, std::string detail, std::string where) {
  return make_problem(row_of_status(status), std::move(detail), std::move(where));
}

std::string problem_json(const Problem& problem) {
  JsonWriter json;
  json.begin_object();
  json.key("type").string(problem.uri.empty() ? "/problems/" + problem.slug : problem.uri);
  json.key("title").string(problem.title);
  json.key("status").integer(static_cast<std::uint64_t>(problem.status));
  if (!problem.detail.empty()) json.key("detail").string(problem.detail);
  if (!problem.where.empty()) json.key("where").string(problem.where);
  json.end_object();
  return json.take();
}

}  // namespace proto
