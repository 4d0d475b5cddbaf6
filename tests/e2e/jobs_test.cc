// Long work of the program: polled to its end, or stopped in its midst.
#include <fstream>

#include "tests/e2e/dem.h"
#include "tests/e2e/served.h"

namespace tests::e2e {
namespace {

constexpr const char* kAsync = "Prefer: respond-async\r\n";

class AsyncTest : public ServedTest {
 protected:
  AsyncTest() { start(); }

  std::string submit_import(const std::filesystem::path& file, const std::string& id) {
    const RawAnswer answer = served_->upload("?id=" + id, file, kAsync);
    EXPECT_EQ(answer.status, 201) << answer.body;
    return answer.header("location");
  }
  std::string submit_simplify(const Json& inputs) {
    const RawAnswer answer =
        served_->http().post_json("/processes/simplify/execution", Json{{"inputs", inputs}}.dump(), kAsync);
    EXPECT_EQ(answer.status, 201) << answer.body;
    return answer.header("location");
  }
  /// Waits until the job is at it.
  std::string running(const std::string& job) {
    std::string status = "accepted";
    while (status == "accepted") status = served_->get(job).at("status");
    return status;
  }
  Json dismiss(const std::string& job) { return Json::parse(served_->http().remove(job).body); }

  /// A DEM of 1000 x 1000 pixels: enough work to be stopped in its midst.
  std::filesystem::path large_dem() {
    const std::string file = folder_.path() / "large.tif";
    const auto made = support::run({"gdal_translate", "-q", "-outsize", "1000", "1000", "-r", "cubic",
                                    "-a_srs", "EPSG:32725", sample_file("olinda"), file});
    EXPECT_EQ(made.status, 0) << made.err;
    return file;
  }
};

TEST_F(AsyncTest, AnImportAndASimplificationAreFollowedToTheirEnd) {
  const std::string import = submit_import(sample_file("olinda"), "coast");
  EXPECT_EQ(served_->finished_job(import).at("status"), "successful");
  Json made = served_->get(import + "/results"), shown = served_->get("/tins/coast");
  EXPECT_EQ(made.at("duplicates"), 0);
  made.erase("duplicates");  // told once
  made.erase("links");       // a job does not know how its client calls the server
  shown.erase("links");
  EXPECT_EQ(made, shown);
  const std::string work = submit_simplify({{"tin", "coast"}, {"tolerance", 5}, {"as", "coast-5"}});
  const Json done = served_->finished_job(work);
  EXPECT_EQ(done.at("status"), "successful");
  EXPECT_EQ(done.at("progress"), 100);
  const Json results = served_->get(work + "/results");
  EXPECT_EQ(results.at("verticesAfter"), served_->get("/tins/coast-5").at("vertexCount"));
}

TEST_F(AsyncTest, AnImportThatIsDismissedMakesNothing) {
  const std::string job = submit_import(large_dem(), "never");
  running(job);
  const Json end = dismiss(job);
  EXPECT_EQ(end.at("status"), "dismissed") << end;
  EXPECT_EQ(served_->http().get("/tins/never").status, 404);
  EXPECT_EQ(served_->get("/tins").at("numberMatched"), 0);
  EXPECT_EQ(served_->http().get(job + "/results").status, 410);
  EXPECT_EQ(served_->stop(), 0);
  EXPECT_TRUE(std::filesystem::is_empty(data() / "uploads"));
}

TEST_F(AsyncTest, ASimplificationThatIsDismissedChangesNothing) {
  ASSERT_EQ(served_->upload("?id=large", large_dem()).status, 201);
  const Json before = served_->get("/tins");
  for (const Json& inputs : {Json{{"tin", "large"}, {"tolerance", 0.01}},
                             Json{{"tin", "large"}, {"tolerance", 0.01}, {"as", "never"}}}) {
    const std::string job = submit_simplify(inputs);
    EXPECT_EQ(running(job), "running");
    const Json end = dismiss(job);
    EXPECT_EQ(end.at("status"), "dismissed") << end;
    EXPECT_EQ(served_->get("/tins"), before);
  }
}

TEST_F(AsyncTest, EditsGoOnWhileAJobRunsAndStay) {
  ASSERT_EQ(served_->upload("?id=large", large_dem()).status, 201);
  const Json box = served_->get("/tins/large").at("bbox");
  const std::string job = submit_simplify({{"tin", "large"}, {"tolerance", 2}});
  running(job);
  const double x = box.at(0).get<double>() + 1234.567, y = box.at(1).get<double>() + 2345.678;
  served_->edit("large", Json::array({{{"op", "insert"}, {"x", x}, {"y", y}, {"z", 5000}}}));
  EXPECT_EQ(served_->finished_job(job).at("status"), "successful");
  const std::string at = "/tins/large/elevation?x=" + Json(x).dump() + "&y=" + Json(y).dump();
  EXPECT_EQ(served_->get(at).at("z"), 5000);
  EXPECT_EQ(served_->get("/tins/large").at("revision"), 3);
}

TEST_F(AsyncTest, AStopLetsARunningJobFinish) {
  ASSERT_EQ(served_->upload("?id=large", large_dem()).status, 201);
  EXPECT_EQ(running(submit_simplify({{"tin", "large"}, {"tolerance", 2}, {"as", "large-2"}})), "running");
  EXPECT_EQ(served_->stop(), 0);
  start();
  EXPECT_LT(served_->get("/tins/large-2").at("vertexCount"), 1'000'000);
}

TEST_F(AsyncTest, AJobThatOutlivesTheDrainChangesNothing) {
  EXPECT_EQ(served_->stop(), 0);
  std::ofstream(folder_.path() / "config.json") << R"({"http":{"drain_seconds":0}})";
  start({"--config", (folder_.path() / "config.json").string()});
  ASSERT_EQ(served_->upload("?id=large", large_dem()).status, 201);
  const Json before = served_->get("/tins");
  EXPECT_EQ(running(submit_simplify({{"tin", "large"}, {"tolerance", 0.01}})), "running");
  EXPECT_EQ(served_->stop(), 0);
  start();
  EXPECT_EQ(served_->get("/tins"), before);
}

}  // namespace
}  // namespace tests::e2e
