#include "proto/surface_queries.h"

#include <gtest/gtest.h>

#include "proto/processes/surface.h"
#include "tests/proto/expect_errors.h"
#include "tests/support/schema_check.h"

namespace {

using proto::Document;
using tests_support::schema_violations;
using tests_support::Wrong;
using tin::base::Code;

/// `read` takes the object that a body is.
template <class Read>
void expect_refused(std::initializer_list<Wrong> cases, Read read) {
  tests_support::expect_errors(cases, [&](const char* body) -> decltype(read(std::declval<proto::Object>())) {
    const auto document = Document::parse(body);
    if (!document) return document.error();
    return read(*document->root().any_object());
  });
}

void expect_fits(const std::string& schema, const std::string& json) {
  for (const auto& line : schema_violations(schema, json)) ADD_FAILURE() << line << '\n' << json;
}

TEST(PositionsTest, ArePairsOfNumbers) {
  const auto line = proto::parse_positions("1,2,-3.5,4e1", 2, "query:coords");
  ASSERT_TRUE(line.ok());
  EXPECT_EQ(*line, (std::vector<proto::Position2>{{1, 2}, {-3.5, 40}}));
  const auto code = [](const char* text) {
    return proto::parse_positions(text, 2, "query:coords").error().code;
  };
  EXPECT_EQ(code(""), Code::kMalformed);
  EXPECT_EQ(code("1"), Code::kMalformed);
  EXPECT_EQ(code("1,2,"), Code::kMalformed);
  EXPECT_EQ(code("1,2,3"), Code::kMalformed);
  EXPECT_EQ(code("1,nan"), Code::kNotFinite);
  EXPECT_EQ(code("1,2,3,4,5,6"), Code::kTooLarge);
}

TEST(PolygonTest, IsARingOrAnOutlineWithHoles) {
  const auto read = [](const char* body) {
    const auto document = *Document::parse(body);
    return *proto::read_area_inputs(*document.root().any_object(), 7);
  };
  EXPECT_EQ(read(R"({"polygon":[[0,0],[1,0],[1,1]]})").area.polygon.size(), 1U);
  const auto holed =
      read(R"({"polygon":[[[0,0],[9,0],[9,9],[0,9]],[[1,1],[2,1],[2,2]]],"crs":"EPSG:4326","voids":"fill"})");
  ASSERT_EQ(holed.area.polygon.size(), 2U);
  EXPECT_EQ(holed.area.polygon[1][2], (proto::Position2{2, 2}));
  EXPECT_EQ(holed.manner.crs, "EPSG:4326");
  EXPECT_EQ(holed.manner.voids, proto::Voids::kFill);
  EXPECT_TRUE(read(R"({"bbox":[0,0,1,1]})").area.box.has_value());
  EXPECT_TRUE(read("{}").area.polygon.empty());
}

TEST(SurfaceInputsTest, ErrorsSayWhere) {
  const auto area = [](const proto::Object& object) { return proto::read_area_inputs(object, 7); };
  expect_refused(
      {{R"({"polygon":1})", Code::kMalformed, "/polygon"},
       {R"({"polygon":[[0,0],[1]]})", Code::kMalformed, "/polygon/1"},
       {R"({"polygon":[[0,0],[1,"2"]]})", Code::kMalformed, "/polygon/1/1"},
       {R"({"polygon":[[[0,0],[1,0],[1,1]],[[0]]]})", Code::kMalformed, "/polygon/1/0"},
       {R"({"polygon":[[0,0],[1,1e999]]})", Code::kNotFinite, "/polygon/1/1"},
       {R"({"polygon":[[0,0],[1,0],[2,0],[3,0],[4,0],[5,0],[6,0],[7,0]]})", Code::kTooLarge, "/polygon"},
       {R"({"polygon":[[[0,0],[1,0],[2,0],[3,0]],[[0,0],[1,0],[2,0],[3,0]]]})", Code::kTooLarge,
        "/polygon/1"},
       {R"({"bbox":[0,0,1]})", Code::kMalformed, "/bbox"},
       {R"({"bbox":[2,0,1,1]})", Code::kInvalidValue, "/bbox"},
       {R"({"bbox":[0,0,1,1],"polygon":[[0,0],[1,0],[1,1]]})", Code::kInvalidValue, "/bbox"},
       {R"({"crs":7})", Code::kMalformed, "/crs"},
       {R"({"voids":"some"})", Code::kInvalidValue, "/voids"}},
      area);
  expect_refused({{R"({})", Code::kMalformed, ""}, {R"({"level":"1"})", Code::kMalformed, "/level"}},
                 [](const proto::Object& object) { return proto::read_volume_inputs(object, 7); });
  expect_refused({{R"({"observer":[1,2]})", Code::kMalformed, ""},
                  {R"({"observer":[1,2,3],"target":[1,2]})", Code::kMalformed, "/observer"},
                  {R"({"observer":[1,2],"target":[1,2],"curvature":1})", Code::kMalformed, "/curvature"}},
                 [](const proto::Object& object) { return proto::read_sight_inputs(object); });
  expect_refused({{R"({"levels":[1,2,3,4]})", Code::kTooLarge, "/levels"},
                  {R"({"interval":"1"})", Code::kMalformed, "/interval"}},
                 [](const proto::Object& object) { return proto::read_contour_inputs(object, 3); });
}

TEST(SurfaceProcessesTest, TakeNoMembersThatTheyDoNotKnow) {
  const auto refused = [](const auto& result) {
    return !result.ok() && result.error().code == Code::kMalformed;
  };
  const auto document = *Document::parse(
      R"({"tin":"a","level":1,"observer":[0,0],"target":[0,0],"positions":[],"after":"b","interval":1,"colour":1})");
  EXPECT_TRUE(refused(proto::read_contours_process(document.root(), 9)));
  EXPECT_TRUE(refused(proto::read_volume_process(document.root(), 9)));
  EXPECT_TRUE(refused(proto::read_cut_fill_process(document.root(), 9)));
  EXPECT_TRUE(refused(proto::read_surface_area_process(document.root(), 9)));
  EXPECT_TRUE(refused(proto::read_profile_process(document.root(), 9)));
  EXPECT_TRUE(refused(proto::read_line_of_sight_process(document.root())));
}

TEST(SurfaceProcessesTest, DescribeThemselves) {
  for (const auto* description : {&proto::contours_description(), &proto::volume_description(),
                                  &proto::cut_fill_description(), &proto::surface_area_description(),
                                  &proto::profile_description(), &proto::line_of_sight_description()}) {
    const std::string json = proto::process_json(*description);
    EXPECT_TRUE(Document::parse(json).ok()) << json;
    expect_fits("Process", json);
  }
}

TEST(SurfaceAnswersTest, FitTheContract) {
  const proto::Units metres{true, "metre"}, unknown{false, ""};
  expect_fits("Slope", proto::slope_json(tin::query::Gradient{0.5, 0}, 3));
  expect_fits("Slope", proto::slope_json(std::nullopt, 3));
  expect_fits(
      "Slopes",
      proto::slopes_json(
          std::vector<std::optional<tin::query::Gradient>>{tin::query::Gradient{0, 0}, std::nullopt}, 3));
  const std::vector<tin::query::ProfilePoint> points{{0, {0, 0}, 1.5}, {2, {1, 1}, std::nullopt}};
  const std::vector<proto::Position2> at{{0, 0}, {1, 1}};
  const std::string profile = proto::profile_json(points, at, metres, 3);
  expect_fits("Profile", profile);
  EXPECT_EQ(
      profile,
      R"({"distance":[0,2],"positions":[[0,0],[1,1]],"z":[1.5,null],"length":2,"lengthUnit":"m","verticalUnit":"metre","revision":3})");
  expect_fits("Profile", proto::profile_json({}, {}, unknown, 3));
  tin::query::Sight sight;
  expect_fits("LineOfSight", proto::sight_json(sight, {1, 2}, std::nullopt, unknown, 3));
  sight.blocked_at = tin::query::SightPoint{3, {0, 0}, 1, -1};
  expect_fits("LineOfSight", proto::sight_json(sight, {1, 2}, proto::Position2{3, 4}, metres, 3));
  expect_fits("LevelVolumes", proto::volume_json({1, 2, 3, 4}, 7, unknown, 3));
  expect_fits("SurfaceArea", proto::surface_area_json({1, 2}, metres, 3));
  expect_fits("CutFill", proto::cut_fill_json({1, 2, 3, 4, 5}, metres, 3, "b", 4));
}

}  // namespace
