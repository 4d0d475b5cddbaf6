#include "proto/processes/process.h"

#include <gtest/gtest.h>

#include "proto/processes/simplify.h"
#include "tests/proto/expect_errors.h"
#include "tests/support/schema_check.h"

namespace {

using proto::ExecutionRequest;
using tests_support::expect_errors;
using tests_support::violations;
using tin::base::Code;
using tin::base::Result;

void expect_clean(const std::vector<std::string>& wrong, const std::string& json) {
  for (const auto& line : wrong) ADD_FAILURE() << line << "\n" << json;
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

Result<proto::SimplifyInputs> execute_simplify(const char* body) {
  const auto request = ExecutionRequest::read(body);
  if (!request) return request.error();
  return proto::read_simplify_inputs(request->inputs());
}

TEST(SimplifyInputsTest, ReadsEveryInput) {
  const auto inputs =
      execute_simplify(
          R"({"inputs":{"tin":"a","tolerance":0,"maxVertices":3,"as":"b","effort":"best","maxSeconds":2.5,"seed":7,)"
          R"("elevations":"fit","keepFlat":12,"against":"surface"}})")
          .value();
  EXPECT_EQ(inputs.elevations, proto::SimplifyElevations::kFit);
  EXPECT_EQ(inputs.keep_flat, 12U);
  EXPECT_EQ(inputs.against, proto::SimplifyAgainst::kSurface);
  EXPECT_EQ(inputs.tin, "a");
  EXPECT_EQ(inputs.tolerance, 0);
  EXPECT_EQ(inputs.max_vertices, 3U);
  EXPECT_EQ(inputs.as, "b");
  EXPECT_EQ(inputs.effort, proto::SimplifyEffort::kBest);
  EXPECT_EQ(inputs.max_seconds, 2.5);
  EXPECT_EQ(inputs.seed, 7U);
  const auto small = execute_simplify(R"({"inputs":{"tin":"a","maxVertices":1000}})").value();
  EXPECT_FALSE(small.tolerance || small.as || small.max_seconds);
  EXPECT_EQ(small.effort, proto::SimplifyEffort::kBalanced);
  EXPECT_EQ(small.elevations, proto::SimplifyElevations::kSource);
  EXPECT_EQ(small.keep_flat, 0U);
  EXPECT_EQ(small.against, proto::SimplifyAgainst::kSamples);
  EXPECT_EQ(execute_simplify(R"({"inputs":{"tin":"a","tolerance":1,"keepFlat":true}})")->keep_flat, 64U);
  EXPECT_EQ(execute_simplify(R"({"inputs":{"tin":"a","tolerance":1,"keepFlat":false}})")->keep_flat, 0U);
}

TEST(SimplifyInputsTest, ReadsWhatStays) {
  const auto one = execute_simplify(R"({"inputs":{"tin":"a","tolerance":1,"protect":"border"}})").value();
  EXPECT_TRUE(one.protect.border);
  const auto many =
      execute_simplify(
          R"({"inputs":{"tin":"a","tolerance":1,"protect":[7,{"type":"Polygon","coordinates":[[[0,0],[4,0],[0,4,1]],)"
          R"([[1,1],[2,1],[1,2]]]},{"type":"MultiPolygon","coordinates":[[[[9,9],[10,9],[9,10]]]]},8]}})")
          .value();
  EXPECT_FALSE(many.protect.border);
  ASSERT_EQ(many.protect.ids.size(), 2U);
  EXPECT_EQ(many.protect.ids[1].id.value(), 8U);
  EXPECT_EQ(many.protect.ids[1].where, "/inputs/protect/3");
  ASSERT_EQ(many.protect.polygons.size(), 2U);
  EXPECT_EQ(many.protect.polygons[0].size(), 2U);
  EXPECT_EQ(many.protect.polygons[0][0][2], (proto::Position2{0, 4}));
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
          {R"({"inputs":{"tin":"a","tolerance":1,"effort":"most"}})", Code::kInvalidValue, "/inputs/effort"},
          {R"({"inputs":{"tin":"a","tolerance":1,"maxSeconds":0}})", Code::kInvalidValue,
           "/inputs/maxSeconds"},
          {R"({"inputs":{"tin":"a","tolerance":1,"maxSeconds":86401}})", Code::kInvalidValue,
           "/inputs/maxSeconds"},
          {R"({"inputs":{"tin":"a","tolerance":1,"elevations":"any"}})", Code::kInvalidValue,
           "/inputs/elevations"},
          {R"({"inputs":{"tin":"a","tolerance":1,"elevations":1}})", Code::kMalformed, "/inputs/elevations"},
          {R"({"inputs":{"tin":"a","tolerance":1,"against":"points"}})", Code::kInvalidValue,
           "/inputs/against"},
          {R"({"inputs":{"tin":"a","tolerance":1,"keepFlat":0}})", Code::kInvalidValue, "/inputs/keepFlat"},
          {R"({"inputs":{"tin":"a","tolerance":1,"keepFlat":"yes"}})", Code::kMalformed, "/inputs/keepFlat"},
          {R"({"inputs":{"tin":"a","tolerance":1,"protect":"all"}})", Code::kInvalidValue, "/inputs/protect"},
          {R"({"inputs":{"tin":"a","tolerance":1,"protect":[1,0]}})", Code::kInvalidValue,
           "/inputs/protect/1"},
          {R"({"inputs":{"tin":"a","tolerance":1,"protect":{"type":"Point","coordinates":[1,2]}}})",
           Code::kInvalidValue, "/inputs/protect/type"},
          {R"({"inputs":{"tin":"a","tolerance":1,"protect":{"type":"Polygon","coordinates":[[[1,2],[3]]]}}})",
           Code::kInvalidValue, "/inputs/protect/coordinates/0"},
          {R"({"inputs":{"tin":"a","tolerance":1,"protect":{"type":"Polygon","coordinates":[[[1,2],[3],[4,5]]]}}})",
           Code::kMalformed, "/inputs/protect/coordinates/0/1"},
          {R"({"inputs":{"tin":"a","tolerance":1,"seed":-1}})", Code::kInvalidValue, "/inputs/seed"},
          {R"({"inputs":{"tin":"a","tolerance":1,"seed":1.5}})", Code::kMalformed, "/inputs/seed"},
          {R"({"inputs":{"tin":"a","tolerance":1,"as":""}})", Code::kInvalidValue, "/inputs/as"},
          {R"({"inputs":{"tin":"a","tolerance":1,"speed":9}})", Code::kMalformed, "/inputs/speed"},
      },
      execute_simplify);
  EXPECT_NE(execute_simplify(R"({"inputs":{"tin":"a","tolerance":1,"effort":"most"}})")
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
  proto::SimplifyResults results;
  results.vertices_before = 1442401;
  results.vertices_after = 17250;
  results.crs = "EPSG:4326";
  results.max_error = 9.99;
  results.worst = proto::SimplifyWorst{-71.5, 44.25, 1203, 9.99, 600, 900, std::nullopt};
  results.rmse = 3.5;
  results.against_source = true;
  results.samples = 1442401;
  results.out_of_force = 2;
  results.level = 300;
  results.crossings = 4000;
  results.out_of_time = true;
  results.histogram_bin = 5;
  results.histogram = {1000000, 442401};
  results.seconds = 11.25;
  results.tin = "hill";
  results.revision = 5;
  EXPECT_EQ(proto::simplify_results_json(results),
            R"({"verticesBefore":1442401,"verticesAfter":17250,"maxError":9.99,"maxErrorAt":[-71.5,44.25],)"
            R"("maxErrorSample":{"z":1203,"column":600,"row":900},"crs":"EPSG:4326","verticalUnit":null,"toleranceMet":true,)"
            R"("rmse":3.5,"certifiedAgainst":"original samples","samples":1442401,"levelSamples":300,)"
            R"("surfaceCrossings":4000,"samplesOutOfForce":2,)"
            R"("histogram":{"bin":5,"counts":[1000000,442401]},"outOfTime":true,"seconds":11.25,"editedMeanwhile":false,"tin":"hill","revision":5})");
  results.worst->column = results.worst->row = std::nullopt;
  results.worst->index = 17;
  results.duplicates = 3;
  results.vertical_unit = "metre";
  const std::string of_points = proto::simplify_results_json(results);
  expect_clean(violations("GET", "/jobs/{job}/results", 200, of_points), of_points);
  results.worst.reset();
  results.against_source = false;
  const std::string json = proto::simplify_results_json(results);
  expect_clean(violations("GET", "/jobs/{job}/results", 200, json), json);
  const std::string document = proto::result_document(json);
  expect_clean(violations("GET", "/jobs/{job}/results", 200, document), document);
}

}  // namespace
