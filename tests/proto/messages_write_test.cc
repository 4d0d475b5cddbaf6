#include <gtest/gtest.h>

#include "proto/messages.h"
#include "tests/support/schema_check.h"

namespace {

using proto::Link;
using proto::VertexId;
using tests_support::violations;

void expect_clean(const std::vector<std::string>& lines, const std::string& json) {
  for (const std::string& line : lines) ADD_FAILURE() << line << "\nin " << json;
}

proto::TinDocument hill() {
  proto::TinDocument tin;
  tin.id = "hill";
  tin.title = "A \"hill\"";
  tin.crs = "EPSG:32617";
  tin.resolution = {0.001, 0.001};
  tin.origin = {500000, 4500000};
  tin.revision = 2;
  tin.vertex_count = 4;
  tin.triangle_count = 2;
  tin.bbox = {500000, 4500000, 500100, 4500100.5};
  tin.z_range = {-1, 12.25};
  tin.digest = "0123456789abcdef0123456789abcdef";
  tin.vertical_unit = "metre";
  tin.links = {{"/tins/hill", "self", "application/json", ""}};
  return tin;
}

TEST(TinDocumentTest, IsWrittenInAFixedOrder) {
  EXPECT_EQ(proto::tin_json(hill()),
            R"({"id":"hill","title":"A \"hill\"","crs":"EPSG:32617","resolution":[0.001,0.001],)"
            R"("origin":[500000,4500000],"revision":2,"vertexCount":4,"triangleCount":2,)"
            R"("bbox":[500000,4500000,500100,4500100.5],"zRange":[-1,12.25],)"
            R"("digest":"0123456789abcdef0123456789abcdef","verticalUnit":"metre",)"
            R"("links":[{"href":"/tins/hill","rel":"self","type":"application/json"}]})");
}

TEST(TinDocumentTest, KeepsTheContract) {
  proto::TinDocument tin = hill();
  expect_clean(violations("GET", "/tins/{tin}", 200, proto::tin_json(tin)), proto::tin_json(tin));
  expect_clean(violations("POST", "/tins", 201, proto::tin_json(tin)), proto::tin_json(tin));
  tin.crs.clear();
  tin.bbox.reset();
  tin.z_range.reset();
  tin.source = proto::SourceInfo{1201, 1201, "Int16", -32768};
  expect_clean(violations("GET", "/tins/{tin}", 200, proto::tin_json(tin)), proto::tin_json(tin));
  tin.source->nodata.reset();
  const std::string list =
      proto::tin_list_json({{tin, hill()}, 7, {{"/tins", "self", "application/json", "TINs"}}});
  expect_clean(violations("GET", "/tins", 200, list), list);
}

TEST(AnswersTest, OfEditsAndElevationsKeepTheContract) {
  const std::string edit = proto::edit_result_json(3, std::vector<VertexId>{VertexId(4), VertexId(1)});
  EXPECT_EQ(edit, R"({"revision":3,"results":[{"id":4},{"id":1}]})");
  expect_clean(violations("POST", "/tins/{tin}/edits", 200, edit), edit);
  const std::string inside =
      proto::elevation_json({12.5, std::array{VertexId(1), VertexId(2), VertexId(3)}, 3});
  EXPECT_EQ(inside, R"({"z":12.5,"triangle":[1,2,3],"revision":3})");
  expect_clean(violations("GET", "/tins/{tin}/elevation", 200, inside), inside);
  const std::string outside = proto::elevation_json({std::nullopt, std::nullopt, 3});
  EXPECT_EQ(outside, R"({"z":null,"triangle":null,"revision":3})");
  expect_clean(violations("GET", "/tins/{tin}/elevation", 200, outside), outside);
  const std::string many =
      proto::elevations_json(std::vector<std::optional<double>>{0.1, std::nullopt, -0.0}, 9);
  EXPECT_EQ(many, R"({"z":[0.1,null,0],"revision":9})");
  expect_clean(violations("POST", "/tins/{tin}/elevation", 200, many), many);
}

TEST(AnswersTest, OfTheServiceKeepTheContract) {
  const std::vector<Link> links = {
      {"/api", "service-desc", "application/vnd.oai.openapi+json;version=3.0", "API"},
      {"/tins", "data", "", ""}};
  const std::string landing = proto::landing_json({"Tinsmith", "TINs", links});
  expect_clean(violations("GET", "/", 200, landing), landing);
  const std::string conformance = proto::conformance_json(std::vector<std::string>{"http://a", "http://b"});
  expect_clean(violations("GET", "/conformance", 200, conformance), conformance);
  const std::string health = proto::health_json("ok", "0.1.0");
  EXPECT_EQ(health, R"({"status":"ok","version":"0.1.0"})");
  expect_clean(violations("GET", "/healthz", 200, health), health);
}

TEST(AnswersTest, OfCollectionsKeepTheContract) {
  proto::CollectionDocument vertices;
  vertices.id = "vertices";
  vertices.title = "Vertices";
  vertices.crs = {"http://www.opengis.net/def/crs/OGC/1.3/CRS84"};
  const std::string bare = proto::collection_json(vertices);
  expect_clean(violations("GET", "/tins/{tin}/collections/{collection}", 200, bare), bare);
  vertices.description = "Points";
  vertices.bbox = {-72, 44, -71, 45};
  vertices.storage_crs = "http://www.opengis.net/def/crs/EPSG/0/4326";
  vertices.links = {{"/tins/a/collections/vertices/items", "items", "application/geo+json", ""}};
  const std::string both = proto::collections_json(std::vector{vertices, vertices}, vertices.links);
  expect_clean(violations("GET", "/tins/{tin}/collections", 200, both), both);
}

TEST(AnswersTest, OfJobsKeepTheContract) {
  using proto::JobState;
  std::vector<proto::JobStatus> jobs;
  for (const JobState state : {JobState::kAccepted, JobState::kRunning, JobState::kSuccessful,
                               JobState::kFailed, JobState::kDismissed}) {
    proto::JobStatus job;
    job.id = std::string("j").append(std::to_string(jobs.size()));
    job.process = "simplify";
    job.state = state;
    job.progress = static_cast<int>(jobs.size()) * 50;  // past 100: must be written as 100
    if (state != JobState::kAccepted) job.started = job.created = "2026-01-31T12:00:00Z";
    if (state == JobState::kFailed) job.message = "out of \x80 memory";
    const std::string json = proto::job_json(job);
    expect_clean(violations("GET", "/jobs/{job}", 200, json), json);
    expect_clean(violations("POST", "/processes/{process}/execution", 201, json), json);
    expect_clean(violations("POST", "/tins", 201, json), json);
    jobs.push_back(job);
  }
  const std::string list = proto::job_list_json(jobs, {});
  expect_clean(violations("GET", "/jobs", 200, list), list);
}

}  // namespace
