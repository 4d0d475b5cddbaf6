// What was acknowledged is there again: after SIGTERM, and after SIGKILL at any moment.
#include <random>

#include "tests/e2e/dem.h"
#include "tests/e2e/served.h"

namespace tests::e2e {
namespace {

class RestartTest : public ServedTest {
 protected:
  Json insert(double x, double y, double z) {
    return Json::array({{{"op", "insert"}, {"x", x}, {"y", y}, {"z", z}}});
  }
};

TEST_F(RestartTest, TinsRevisionsAndDigestsSurviveAnOrderlyStop) {
  start();
  EXPECT_EQ(served_->first_line().substr(0, 34), "Tinsmith serves 0 TINs at http://1");
  ASSERT_EQ(served_->upload("?id=voids&title=Luxembourg", sample_file("luxembourg")).status, 201);
  ASSERT_EQ(served_->upload("?id=coast", sample_file("olinda")).status, 201);
  ASSERT_EQ(served_->http().post_json("/tins", R"({"id":"empty","resolution":0.5})").status, 201);
  served_->simplify({{"tin", "coast"}, {"tolerance", 5}});
  served_->edit("voids",
                Json::array({{{"op", "remove"}, {"id", 5}}, {{"op", "set-z"}, {"id", 6}, {"z", 77.25}}}));
  served_->edit("voids", insert(6.123, 49.7, 400));
  const Json list = served_->get("/tins");
  const std::string vertices = served_->http().get("/tins/voids/export?f=geojson&collection=vertices").body;
  const std::string raster = served_->http().get("/tins/voids/export?f=geotiff").body;
  ASSERT_EQ(served_->stop(), 0);
  start();
  EXPECT_EQ(served_->first_line().substr(0, 22), "Tinsmith serves 3 TINs");
  EXPECT_EQ(served_->get("/tins"), list);
  EXPECT_EQ(served_->http().get("/tins/voids/export?f=geojson&collection=vertices").body, vertices)
      << "ids and elevations";
  EXPECT_EQ(served_->http().get("/tins/voids/export?f=geotiff").body, raster)
      << "the source's grid and its voids";
  const Json next = served_->edit("voids", insert(6.124, 49.7, 401));
  EXPECT_EQ(next.at("revision"), 4);
  EXPECT_EQ(next.at("results").at(0).at("id"), 4610) << "no id is given twice";
  EXPECT_EQ(served_->stop(), 0);
}

TEST_F(RestartTest, ADeletedTinStaysDeleted) {
  start();
  ASSERT_EQ(served_->upload("?id=coast", sample_file("olinda")).status, 201);
  EXPECT_EQ(served_->http().remove("/tins/coast").status, 204);
  served_->kill();
  start();
  EXPECT_EQ(served_->http().get("/tins/coast").status, 404);
}

TEST_F(RestartTest, AKilledServerLosesNoAcknowledgedEdit) {
  start();
  ASSERT_EQ(served_->upload("?id=coast", sample_file("olinda")).status, 201);
  const std::size_t begin = served_->get("/tins/coast").at("vertexCount");
  std::mt19937 random(5);
  std::vector<Json> acknowledged;  // x, y, z
  std::uint64_t revision = 1;
  for (int round = 0; round < 20; ++round) {
    for (int edits = 1 + static_cast<int>(random() % 5); edits > 0; --edits) {
      const double x = 289000 + static_cast<double>(acknowledged.size()), y = 9112000.5 + round,
                   z = 1000 + round;
      revision = served_->edit("coast", insert(x, y, z)).at("revision");
      acknowledged.push_back({x, y, z});
    }
    // One more on its way when the server dies: it may be there or not, but whole.
    support::RawClient last(served_->http().port());
    last.send(support::request_bytes({"POST", "/tins/coast/edits", "application/json",
                                      Json{{"ops", Json::array({insert(290000.0 + round, 9113000, 1)[0],
                                                                insert(290000.0 + round, 9113001, 2)[0]})}}
                                          .dump()}));
    served_->kill();
    start();
    const Json tin = served_->get("/tins/coast");
    ASSERT_GE(tin.at("revision"), revision) << "round " << round;
    ASSERT_LE(tin.at("revision"), revision + 1) << "round " << round;
    revision = tin.at("revision");
  }
  Json positions = Json::array();
  for (const Json& vertex : acknowledged) positions.push_back({vertex.at(0), vertex.at(1)});
  const Json z =
      Json::parse(
          served_->http().post_json("/tins/coast/elevation", Json{{"positions", positions}}.dump()).body)
          .at("z");
  for (std::size_t i = 0; i < acknowledged.size(); ++i) EXPECT_EQ(z.at(i), acknowledged[i].at(2)) << i;
  const std::size_t count = served_->get("/tins/coast").at("vertexCount"),
                    halves = count - begin - acknowledged.size();
  EXPECT_EQ(halves % 2, 0U) << "half an edit is there";
  EXPECT_EQ(revision, 1 + acknowledged.size() + halves / 2);
}

TEST_F(RestartTest, ASecondServerOnTheSameFolderIsRefused) {
  start();
  const auto second =
      support::run({TINSMITH_PROGRAM, "serve", "--listen", "127.0.0.1:0", "--data", data().string()});
  EXPECT_EQ(second.status, 1);
  EXPECT_EQ(second.out, "");
  EXPECT_NE(second.err.find(data().string()), std::string::npos) << second.err;
  EXPECT_NE(second.err.find("another"), std::string::npos) << second.err;
  EXPECT_EQ(served_->http().get("/healthz").status, 200) << "the first one serves on";
}

}  // namespace
}  // namespace tests::e2e
