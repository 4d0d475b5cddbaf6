#include "proto/processes/process.h"

#include <gtest/gtest.h>

#include "proto/processes/simplify.h"
#include "tests/support/schema_check.h"

namespace {

using proto::ExecutionRequest;
using tests_support::violations;
using tin::base::Code;
using tin::base::Result;

void expect_clean(const std::vector<std::string>& wrong, const std::string& json) {
  for (const auto& line : wrong) ADD_FAILURE() << line << "\n" << json;
}

struct Wrong {
  const char* body;
  Code code;
  const char* where;
};

template <class Read>
void expect_errors(std::initializer_list<Wrong> cases, Read read) {
  for (const Wrong& wrong : cases) {
    const auto result = read(wrong.body);
    ASSERT_FALSE(result.ok()) << wrong.body;
    EXPECT_EQ(static_cast<int>(result.error().code), static_cast<int>(wrong.code))
        << wrong.body << ": " << result.error().message;
    EXPECT_EQ(result.error().where, wrong.where) << wrong.body;
    EXPECT_FALSE(result.error().message.empty());
  }
}

TEST(ExecutionRequestTest, TheResultStandsInADocumentOnlyIfAskedTo) {
  EXPECT_FALSE(ExecutionRequest::read(R"({"inputs":{}})")->as_document());
  EXPECT_FALSE(ExecutionRequest::read(R"({"inputs":{},"response":"raw","mode":"async"})")->as_document());
  const auto request = ExecutionRequest::read(
      R"({"inputs":{"a":[1]},"response":"document","outputs":{"result":{"transmissionMode":"value",)"
      R"("format":{"mediaType":"application/json"}}}})");
  ASSERT_TRUE(request.ok()) << request.error().message;
  EXPECT_TRUE(request->as_document());
  EXPECT_EQ(request->inputs().any_object()->find("a")->pointer(), "/inputs/a");
  EXPECT_EQ(proto::result_document(R"({"a":1})"), R"({"result":{"a":1}})");
}

TEST(ExecutionRequestTest, ErrorsSayWhere) {
  expect_errors(
      {
          {"{}", Code::kMalformed, ""},
          {"[]", Code::kMalformed, ""},
          {R"({"inputs":[]})", Code::kMalformed, "/inputs"},
          {R"({"inputs":{},"priority":1})", Code::kMalformed, "/priority"},
          {R"({"inputs":{},"response":"both"})", Code::kInvalidValue, "/response"},
          {R"({"inputs":{},"response":1})", Code::kMalformed, "/response"},
          {R"({"inputs":{},"mode":"later"})", Code::kInvalidValue, "/mode"},
          {R"({"inputs":{},"outputs":[]})", Code::kMalformed, "/outputs"},
          {R"({"inputs":{},"outputs":{"tin":{}}})", Code::kInvalidValue, "/outputs/tin"},
          {R"({"inputs":{},"outputs":{"result":1}})", Code::kMalformed, "/outputs/result"},
          {R"({"inputs":{},"outputs":{"result":{"transmissionMode":"reference"}}})", Code::kInvalidValue,
           "/outputs/result/transmissionMode"},
          {R"({"inputs":{},"outputs":{"result":{"format":{"mediaType":"image/tiff"}}}})", Code::kInvalidValue,
           "/outputs/result/format/mediaType"},
      },
      [](const char* body) { return ExecutionRequest::read(body); });
}

Result<proto::SimplifyInputs> read_simplify(const char* body) {
  const auto request = ExecutionRequest::read(body);
  if (!request) return request.error();
  return proto::read_simplify_inputs(request->inputs());
}

TEST(SimplifyInputsTest, ReadsEveryInput) {
  const auto inputs =
      read_simplify(
          R"({"inputs":{"tin":"a","tolerance":0,"maxVertices":3,"as":"b","effort":"fast"}})")
          .value();
  EXPECT_EQ(inputs.tin, "a");
  EXPECT_EQ(inputs.tolerance, 0);
  EXPECT_EQ(inputs.max_vertices, 3U);
  EXPECT_EQ(inputs.as, "b");
  const auto small = read_simplify(R"({"inputs":{"tin":"a","maxVertices":1000}})").value();
  EXPECT_FALSE(small.tolerance || small.as);
}

TEST(SimplifyInputsTest, ErrorsSayWhere) {
  expect_errors(
      {
          {R"({"inputs":{"tolerance":1}})", Code::kMalformed, "/inputs"},
          {R"({"inputs":{"tin":"a"}})", Code::kInvalidValue, "/inputs"},
          {R"({"inputs":{"tin":"a b","tolerance":1}})", Code::kInvalidValue, "/inputs/tin"},
          {R"({"inputs":{"tin":7,"tolerance":1}})", Code::kMalformed, "/inputs/tin"},
          {R"({"inputs":{"tin":"a","tolerance":-1}})", Code::kInvalidValue, "/inputs/tolerance"},
          {R"({"inputs":{"tin":"a","tolerance":1e999}})", Code::kNotFinite, "/inputs/tolerance"},
          {R"({"inputs":{"tin":"a","tolerance":"1"}})", Code::kMalformed, "/inputs/tolerance"},
          {R"({"inputs":{"tin":"a","maxVertices":2}})", Code::kInvalidValue, "/inputs/maxVertices"},
          {R"({"inputs":{"tin":"a","maxVertices":10.5}})", Code::kMalformed, "/inputs/maxVertices"},
          {R"({"inputs":{"tin":"a","tolerance":1,"effort":"best"}})", Code::kInvalidValue, "/inputs/effort"},
          {R"({"inputs":{"tin":"a","tolerance":1,"as":""}})", Code::kInvalidValue, "/inputs/as"},
          {R"({"inputs":{"tin":"a","tolerance":1,"speed":9}})", Code::kMalformed, "/inputs/speed"},
      },
      read_simplify);
  EXPECT_NE(read_simplify(R"({"inputs":{"tin":"a","tolerance":1,"effort":"best"}})")
                .error()
                .message.find("fast"),
            std::string::npos);
}

TEST(ProcessDescriptionTest, KeepsTheContract) {
  const std::vector descriptions{&proto::simplify_description()};
  const std::string list = proto::process_list_json(descriptions);
  expect_clean(violations("GET", "/processes", 200, list), list);
  const std::string simplify = proto::process_json(proto::simplify_description());
  expect_clean(violations("GET", "/processes/{process}", 200, simplify), simplify);
}

TEST(SimplifyResultsTest, KeepTheContract) {
  proto::SimplifyResults results{1442401, 17250,  9.99, proto::Position2{-71.5, 44.25}, true, false,
                                 3.5,     11.25, "hill", 5};
  EXPECT_EQ(proto::simplify_results_json(results),
            R"({"verticesBefore":1442401,"verticesAfter":17250,"maxError":9.99,"maxErrorAt":[-71.5,44.25],)"
            R"("toleranceMet":true,"editedMeanwhile":false,"rmse":3.5,"seconds":11.25,"tin":"hill","revision":5})");
  results.max_error_at.reset();
  const std::string json = proto::simplify_results_json(results);
  expect_clean(violations("GET", "/jobs/{job}/results", 200, json), json);
  const std::string document = proto::result_document(json);
  expect_clean(violations("GET", "/jobs/{job}/results", 200, document), document);
}

}  // namespace
