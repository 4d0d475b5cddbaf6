// What becomes of a position where a vertex stands already, by the TIN's policy.
#include <gtest/gtest.h>

#include <optional>

#include "tests/contract/test_server.h"

namespace tests::contract {
namespace {

/// A policy, and the elevation where 20 comes to 10 (nothing: refused).
struct Case {
  std::string policy;
  std::optional<double> z;
};
const std::vector<Case> kCases{{"replace", 20}, {"keep", 10}, {"mean", 15},
                               {"max", 20},     {"min", 10},  {"reject", std::nullopt}};

class DuplicatesTest : public testing::TestWithParam<Case> {
 protected:
  double z_at_origin(const std::string& tin) {
    return Json::parse(server_.get("/tins/" + tin + "/elevation?x=0&y=0").body).at("z").get<double>();
  }

  TestServer server_;
};

TEST_P(DuplicatesTest, AnInsertionMeetsAVertex) {
  const auto& [policy, z] = GetParam();
  ASSERT_EQ(server_
                .post_json("/tins", R"({"id":"t","duplicates":")" + policy +
                                        R"(","vertices":[[0,0,10],[9,0,1],[0,9,1]]})")
                .status,
            201);
  const std::string before = server_.state();
  const RawAnswer answer = server_.post_json(
      "/tins/t/edits", R"({"ops":[{"op":"set-z","id":2,"z":7},{"op":"insert","x":0,"y":0,"z":20}]})");
  if (!z) {
    EXPECT_EQ(answer.status, 409);
    EXPECT_EQ(slug(answer), "duplicate-position");
    EXPECT_EQ(Json::parse(answer.body).at("where"), "/ops/1");
    EXPECT_EQ(server_.state(), before);
    return;
  }
  EXPECT_EQ(Json::parse(answer.body).at("results").at(1).at("id"), 1) << answer.body;
  EXPECT_EQ(z_at_origin("t"), *z);
  EXPECT_EQ(server_.tin("t").at("vertexCount"), 3);
}

TEST_P(DuplicatesTest, VerticesOfANewTinMeet) {
  const auto& [policy, z] = GetParam();
  const std::string before = server_.state();
  const RawAnswer answer =
      server_.post_json("/tins", R"({"id":"t","duplicates":")" + policy +
                                     R"(","vertices":[[0,0,10],[9,0,1],[0,9,1],[0,0,20]]})");
  if (!z) {
    EXPECT_EQ(answer.status, 409);
    EXPECT_EQ(Json::parse(answer.body).at("where"), "/vertices/3");
    EXPECT_EQ(server_.state(), before);
    return;
  }
  ASSERT_EQ(answer.status, 201) << answer.body;
  EXPECT_EQ(z_at_origin("t"), *z);
  EXPECT_EQ(server_.tin("t").at("vertexCount"), 3);
}

TEST_P(DuplicatesTest, PointsOfAFileMeet) {
  const auto& [policy, z] = GetParam();
  const std::string before = server_.state();
  const RawAnswer answer =
      server_.upload("/tins?id=t&duplicates=" + policy, "text/csv", "x,y,z\n0,0,10\n9,0,1\n0,9,1\n0,0,20\n");
  EXPECT_EQ(server_.leftovers(), std::set<std::string>{});
  if (!z) {
    EXPECT_EQ(answer.status, 409);
    EXPECT_EQ(slug(answer), "duplicate-position");
    EXPECT_EQ(server_.state(), before);
    return;
  }
  ASSERT_EQ(answer.status, 201) << answer.body;
  EXPECT_EQ(z_at_origin("t"), *z);
}

/// A move may never take another vertex's place: there are two ids then, and no policy says whose elevation
/// stays.
TEST_P(DuplicatesTest, AMoveOntoAnotherVertexIsRefused) {
  ASSERT_EQ(server_
                .post_json("/tins", R"({"id":"t","duplicates":")" + GetParam().policy +
                                        R"(","vertices":[[0,0,10],[9,0,1],[0,9,1]]})")
                .status,
            201);
  const std::string before = server_.state();
  const RawAnswer answer = server_.post_json(
      "/tins/t/edits", R"({"ops":[{"op":"move","id":1,"x":5,"y":5},{"op":"move","id":2,"x":5,"y":5}]})");
  EXPECT_EQ(answer.status, 409);
  EXPECT_EQ(slug(answer), "duplicate-position");
  EXPECT_EQ(server_.state(), before);
}

INSTANTIATE_TEST_SUITE_P(Policies, DuplicatesTest, testing::ValuesIn(kCases),
                         [](const auto& one) { return one.param.policy; });

}  // namespace
}  // namespace tests::contract
