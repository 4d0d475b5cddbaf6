// A disk that is really full: a file system of a few megabytes. Where it cannot be mounted, the failing disk
// of faulty_disk.h has to do.
#include <gtest/gtest.h>
#include <sys/mount.h>

#include <cerrno>
#include <chrono>
#include <cstring>
#include <fstream>
#include <thread>

#include "tests/e2e/served.h"

namespace tests::faults {
namespace {

using e2e::Json;
using e2e::Served;

/// A file system in memory, of that size, at a folder; gone at the end of the scope.
class SmallDisk {
 public:
  SmallDisk(std::filesystem::path at, const std::string& size) : at_(std::move(at)) {
    std::filesystem::create_directory(at_);
    mounted_ = ::mount("tmpfs", at_.c_str(), "tmpfs", 0, ("size=" + size).c_str()) == 0;
  }
  SmallDisk(const SmallDisk&) = delete;
  SmallDisk& operator=(const SmallDisk&) = delete;
  ~SmallDisk() {
    if (mounted_) ::umount2(at_.c_str(), MNT_DETACH);
  }

  bool mounted() const { return mounted_; }
  const std::filesystem::path& path() const { return at_; }
  std::uintmax_t room() const { return std::filesystem::space(at_).available; }

  /// Takes what is left, but for so many bytes.
  void fill_but(std::uintmax_t left) {
    std::ofstream out(at_ / "ballast", std::ios::binary | std::ios::app);
    const std::string block(4096, 'b');
    while (out && room() >= left + block.size()) out << block << std::flush;
  }
  void free() { std::filesystem::remove(at_ / "ballast"); }

 private:
  const std::filesystem::path at_;
  bool mounted_ = false;
};

class FullDiskTest : public testing::Test {
 protected:
  void SetUp() override {
    if (!disk_.mounted()) GTEST_SKIP() << "mount: " << std::strerror(errno);
    served_ = std::make_unique<Served>(disk_.path());
    Json vertices = Json::array();
    for (int y = 0; y < 20; ++y) {
      for (int x = 0; x < 20; ++x) vertices.push_back({x, y, x + y});
    }
    ASSERT_EQ(served_->http().post_json("/tins", Json{{"id", "t"}, {"vertices", vertices}}.dump()).status,
              201);
    remember();
  }
  void TearDown() override { served_.reset(); }

  support::RawAnswer insert(int count) {
    Json ops = Json::array();
    for (int i = 0; i < count; ++i, ++inserted_)
      ops.push_back(
          {{"op", "insert"}, {"x", 0.001 * (inserted_ % 19'000)}, {"y", 0.4 + inserted_ / 19'000}, {"z", 1}});
    return served_->http().post_json("/tins/t/edits", Json{{"ops", ops}}.dump());
  }
  void remember() {
    const Json tin = served_->get("/tins/t");
    digest_ = tin.at("digest");
    revision_ = tin.at("revision");
  }
  /// Readers see what was acknowledged, nothing less and nothing more.
  void expect_as_remembered() {
    const Json tin = served_->get("/tins/t");
    EXPECT_EQ(tin.at("digest"), digest_);
    EXPECT_EQ(tin.at("revision"), revision_);
    EXPECT_EQ(served_->get("/tins/t/elevation?x=3&y=4").at("z"), 7);
  }
  /// Edits until there is no room; what was acknowledged is remembered.
  void edit_until_full() {
    int status = 200;
    for (int i = 0; i < 2000 && status == 200; ++i) {
      const auto answer = insert(100);
      status = answer.status;
      if (status == 200) remember();
    }
    ASSERT_EQ(status, 507);
  }

  support::TempDir folder_;
  SmallDisk disk_{folder_.path() / "disk", "12m"};
  std::unique_ptr<Served> served_;
  std::string digest_;
  std::uint64_t revision_ = 0;
  int inserted_ = 0;
};

TEST_F(FullDiskTest, EditsGet507ReadsGoOnAndRoomEndsIt) {
  disk_.fill_but(200'000);
  edit_until_full();
  expect_as_remembered();
  const auto refused = insert(1000);
  EXPECT_EQ(refused.status, 507);
  EXPECT_EQ(Json::parse(refused.body).at("type"), "/problems/insufficient-storage") << refused.body;
  EXPECT_EQ(served_->http().post_json("/tins", R"({"id":"u"})").status / 100, 5);
  expect_as_remembered();
  disk_.free();
  EXPECT_EQ(insert(1000).status, 200);
  remember();
  served_->kill();
  served_ = std::make_unique<Served>(disk_.path());
  expect_as_remembered();
  EXPECT_EQ(insert(1).status, 200);
}

TEST_F(FullDiskTest, KilledWhileItIsFullItLosesNothing) {
  disk_.fill_but(100'000);
  edit_until_full();
  served_->kill();
  disk_.free();
  served_ = std::make_unique<Served>(disk_.path());
  expect_as_remembered();
  EXPECT_EQ(insert(10).status, 200);
}

TEST_F(FullDiskTest, FilesThatDoNotFitGet507AndLeaveNothing) {
  disk_.fill_but(500'000);
  const std::uintmax_t room = disk_.room();
  std::string points = "x,y,z\n";
  for (int i = 0; points.size() < 2'000'000; ++i)
    points += std::to_string(i % 1000) + "," + std::to_string(i / 1000) + ",1\n";
  const auto upload = served_->http().post("/tins", "text/csv", points);
  EXPECT_EQ(upload.status, 507) << upload.body;
  for (int i = 0; i < 100 && disk_.room() < room; ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  EXPECT_GE(disk_.room() + 65'536, room);
  disk_.fill_but(20'000);
  const auto raster = served_->http().get("/tins/t/export?f=geotiff&cell-size=0.01");
  EXPECT_EQ(raster.status, 507) << raster.body.substr(0, 300);
  disk_.free();
  EXPECT_EQ(served_->http().post("/tins", "text/csv", points).status, 201);
  EXPECT_EQ(served_->http().get("/tins/t/export?f=geotiff&cell-size=0.01").status, 200);
}

/// What cannot be written at the start is said, and nothing is spoilt.
TEST_F(FullDiskTest, AStartWithoutRoomServesOrSaysWhy) {
  EXPECT_EQ(served_->stop(), 0);
  disk_.fill_but(0);
  try {
    served_ = std::make_unique<Served>(disk_.path());
    expect_as_remembered();
    served_->kill();
  } catch (const std::runtime_error& why) {
    EXPECT_NE(std::string(why.what()).find("full"), std::string::npos) << why.what();
  }
  disk_.free();
  served_ = std::make_unique<Served>(disk_.path());
  expect_as_remembered();
  EXPECT_EQ(insert(10).status, 200);
}

}  // namespace
}  // namespace tests::faults
