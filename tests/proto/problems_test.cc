#include "proto/problems.h"

#include <gtest/gtest.h>

#include <set>

#include "tests/support/schema_check.h"

namespace {

using tin::base::Code;
using tin::base::error;

constexpr Code kAll[] = {Code::kMalformed,         Code::kUnknownParameter, Code::kNotFound,
                         Code::kUnknownVertex,     Code::kNotFinite,        Code::kOutsideLattice,
                         Code::kDuplicatePosition, Code::kInvalidValue,     Code::kUnsupported,
                         Code::kConflict,          Code::kPrecondition,     Code::kGone,
                         Code::kTooLarge,          Code::kTooMany,          Code::kCancelled,
                         Code::kStorage,           Code::kInternal};

TEST(ProblemsTest, EveryCodeHasItsOwnSlugAndAnErrorStatus) {
  std::set<std::string> slugs;
  for (const Code code : kAll) {
    const proto::Problem problem = proto::to_problem(error(code, "so it is", "/a"));
    EXPECT_GE(problem.status, 400);
    EXPECT_LT(problem.status, 600);
    EXPECT_TRUE(slugs.insert(problem.slug).second) << problem.slug;
    EXPECT_TRUE(tests_support::schema_violations("Problem", proto::problem_json(problem)).empty());
  }
}

TEST(ProblemsTest, AProblemSaysWhatAndWhere) {
  const auto problem = proto::to_problem(error(Code::kUnknownVertex, "there is no vertex 7", "/ops/0/id"));
  EXPECT_EQ(proto::problem_json(problem),
            R"({"type":"/problems/unknown-vertex","title":"There is no such vertex","status":422,)"
            R"("detail":"there is no vertex 7","where":"/ops/0/id"})");
}

TEST(ProblemsTest, WhatIsInternalStaysInTheLog) {
  for (const Code code : {Code::kInternal, Code::kStorage}) {
    const std::string json =
        proto::problem_json(proto::to_problem(error(code, "/var/lib/secret.db", "/root")));
    EXPECT_EQ(json.find("secret"), std::string::npos) << json;
    EXPECT_EQ(json.find("/root"), std::string::npos) << json;
  }
}

TEST(ProblemsTest, RetryAfterGoesWith429And503) {
  EXPECT_TRUE(proto::to_problem(error(Code::kTooMany, "later")).retry_after_s.has_value());
  EXPECT_TRUE(proto::to_problem(error(Code::kStorage, "full")).retry_after_s.has_value());
  EXPECT_FALSE(proto::to_problem(error(Code::kConflict, "taken")).retry_after_s.has_value());
}

TEST(ProblemsTest, AnyStatusGivesADocument) {
  for (int status = 400; status < 600; ++status) {
    const proto::Problem problem = proto::status_problem(status, "why");
    EXPECT_EQ(problem.status, status);
    EXPECT_FALSE(problem.slug.empty());
    EXPECT_TRUE(tests_support::schema_violations("Problem", proto::problem_json(problem)).empty());
  }
  EXPECT_EQ(proto::status_problem(405).slug, "method-not-allowed");
  EXPECT_EQ(proto::status_problem(413).slug, "too-large");
}

TEST(ProblemsTest, DetailsThatAreNotUtf8DoNotBreakTheDocument) {
  const auto problem = proto::to_problem(error(Code::kMalformed, "file \xff\xc3(", "query:\x80"));
  EXPECT_TRUE(tests_support::schema_violations("Problem", proto::problem_json(problem)).empty());
}

}  // namespace
