// Errors as clients see them: RFC 9457 problem documents, from one table.
//
//   Problem p = to_problem(error(Code::kUnknownVertex, "there is no vertex 7", "/ops/0/id"));
//   p.status;         // 422
//   problem_json(p);  // {"type":"/problems/unknown-vertex","title":...,"where":"/ops/0/id"}
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "tin/base/result.h"

namespace proto {

inline constexpr std::string_view kProblemMediaType = "application/problem+json";

/// What a failed request is told. `slug` is stable: clients may branch on it.
struct Problem {
  int status = 500;
  std::string slug;
  std::string title;
  std::string detail;
  std::string where;                 // JSON pointer, "query:name" or the like; empty when there is no place
  std::string uri;                   // of the kind of problem where a standard gives it one; else it is made of the slug
  std::optional<int> retry_after_s;  // to be sent as Retry-After
};

/// The problem of an error. The message of an internal error is for the log: clients get a general sentence.
Problem to_problem(const tin::base::Error& error);

/// A problem that no Code stands for: 405, 406, 408 and the other plain answers of HTTP. Any status will do.
Problem status_problem(int status, std::string detail = {}, std::string where = {});

/// The document, of media type kProblemMediaType.
std::string problem_json(const Problem& problem);

}  // namespace proto
