// Files that lie, or mean harm.
#include <arpa/inet.h>
#include <fcntl.h>
#include <gdal_priv.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cstring>
#include <fstream>
#include <iterator>
#include <thread>

#include "server/gdal/crs.h"
#include "server/gdal/library.h"
#include "tests/server/gdal/support.h"

namespace server::gdal::testing {
namespace {

using tin::base::Code;

class HostileTest : public ScratchTest {
 protected:
  std::string content(const std::filesystem::path& file) const {
    std::ifstream in(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }
};

/// A socket on this machine that nobody may come to.
class Listener {
 public:
  Listener() : socket_(::socket(AF_INET, SOCK_STREAM, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t length = sizeof address;
    EXPECT_EQ(::bind(socket_, reinterpret_cast<sockaddr*>(&address), length), 0);
    EXPECT_EQ(::listen(socket_, 4), 0);
    EXPECT_EQ(::getsockname(socket_, reinterpret_cast<sockaddr*>(&address), &length), 0);
    port_ = ntohs(address.sin_port);
    ::fcntl(socket_, F_SETFL, O_NONBLOCK);
  }
  ~Listener() { ::close(socket_); }
  std::string url() const { return "http://127.0.0.1:" + std::to_string(port_) + "/"; }
  bool visited() const {
    const int visitor = ::accept(socket_, nullptr, nullptr);
    if (visitor >= 0) ::close(visitor);
    return visitor >= 0;
  }

 private:
  int socket_;
  int port_ = 0;
};

TEST_F(HostileTest, OnlyTheAllowedDriversExist) {
  prepare_library();
  GDALDriverManager& manager = *GetGDALDriverManager();
  EXPECT_EQ(static_cast<std::size_t>(manager.GetDriverCount()),
            raster_drivers().size() + vector_drivers().size() + 1);
  // It can only write.
  ASSERT_NE(manager.GetDriverByName("COG"), nullptr);
  EXPECT_EQ(manager.GetDriverByName("COG")->pfnOpen, nullptr);
  for (const char* name :
       {"VRT", "OGR_VRT", "HTTP", "WMS", "WCS", "WFS", "OAPIF", "DERIVED", "GTI", "CSV", "XYZ"}) {
    EXPECT_EQ(manager.GetDriverByName(name), nullptr) << name;
  }
  for (const char* name : raster_drivers()) EXPECT_NE(manager.GetDriverByName(name), nullptr) << name;
  for (const char* name : vector_drivers()) EXPECT_NE(manager.GetDriverByName(name), nullptr) << name;
}

TEST_F(HostileTest, AVrtIsNotReadWhateverItIsCalled) {
  make_tiff(path("secret.tif"), {});
  const std::string vrt =
      "<VRTDataset rasterXSize=\"4\" rasterYSize=\"3\"><GeoTransform>0,1,0,0,0,-1</GeoTransform>"
      "<VRTRasterBand dataType=\"Float32\" band=\"1\"><SimpleSource><SourceFilename>" +
      path("secret.tif").string() +
      "</SourceFilename><SourceBand>1</SourceBand></SimpleSource></VRTRasterBand></VRTDataset>";
  const auto upload = file("upload", vrt);
  for (const char* name : {"dem.tif", "dem.vrt", "", "a.csv", "N44W072.hgt"}) {
    EXPECT_EQ(import_error(upload, named(name)).code, Code::kUnsupported) << name;
  }
  for (const char* format : {"geotiff", "csv", "aaigrid", "geojson"}) {
    ImportOptions options;
    options.format = format;
    EXPECT_EQ(import_error(upload, options).code, Code::kUnsupported) << format;
  }
  ImportOptions options;
  options.format = "vrt";
  EXPECT_EQ(import_error(upload, options).where, "query:format");
}

TEST_F(HostileTest, NamesWithPathsAreNeverOpened) {
  const Listener listener;
  const auto tiff = path("upload");
  make_tiff(tiff, {});
  for (const std::string& name :
       {"/vsicurl/" + listener.url() + "a.tif", std::string("../../etc/passwd.tif"),
        std::string("GTIFF_DIR:1:/etc/passwd"), std::string(100000, 'a') + ".tif"}) {
    EXPECT_EQ(imported(tiff, named(name)).placements.size(), 12U);
  }
  const auto hgt = file("tile", std::string(1201 * 1201 * 2, '\0'));
  for (const std::string& name : {"/vsicurl/" + listener.url() + "N44W072.hgt", std::string("../N44W072.hgt"),
                                  std::string("N44W072.hgt/.."), std::string("N44W72.hgt"),
                                  std::string("a.hgt"), std::string("N44W072.hgt\n"), std::string()}) {
    const auto problem = import_error(hgt, named(name));
    EXPECT_EQ(problem.code, Code::kInvalidValue) << name;
    EXPECT_NE(problem.message.find("N44W072.hgt"), std::string::npos);
  }
  EXPECT_EQ(imported(hgt, named("n44w072.SRTMGL1.HGT")).frame.crs, "EPSG:4326");
  EXPECT_FALSE(listener.visited());
}

TEST_F(HostileTest, ALinkInAFileIsNotFollowed) {
  const Listener listener;
  // Should a request be made after all, it would wait for an answer; then the visit is seen, and the test
  // ends.
  const auto upload =
      file("upload", R"({"type":"FeatureCollection","crs":{"type":"link","properties":{"href":")" +
                         listener.url() +
                         R"(crs.wkt","type":"ogcwkt"}},"features":[{"type":"Feature",)"
                         R"("properties":{},"geometry":{"type":"Point",)"
                         R"("coordinates":[8,47,1]}}]})");
  EXPECT_EQ(import_error(upload).code, Code::kMalformed);
  EXPECT_FALSE(listener.visited());
  EXPECT_FALSE(read_crs(listener.url()).ok());
  EXPECT_FALSE(listener.visited());
}

TEST_F(HostileTest, NeighboursAreNotRead) {
  TiffSpec spec;
  spec.placed = false;
  spec.crs = "";
  make_tiff(path("raster.tif"), spec);
  file("raster.tfw", "10\n0\n0\n-10\n500005\n4999995\n");
  file("raster.tif.aux.xml", "<PAMDataset><GeoTransform>0,1,0,0,0,-1</GeoTransform></PAMDataset>");
  EXPECT_EQ(import_error(path("raster.tif")).code, Code::kInvalidValue)
      << "without its sidecars it lies nowhere";
}

TEST_F(HostileTest, TextCalledTifIsNotRecognised) {
  auto problem = import_error(file("upload", "Dear all,\nplease find attached\n"), named("dem.tif"));
  EXPECT_EQ(problem.code, Code::kUnsupported);
  EXPECT_NE(problem.message.find("not recognised"), std::string::npos);
  ImportOptions options;
  options.content_type = "image/tiff; application=geotiff";
  EXPECT_EQ(import_error(file("upload", "1,2,3\n"), options).code, Code::kUnsupported);
  options = {};
  options.format = "geotiff";
  EXPECT_EQ(import_error(file("upload", "1,2,3\n"), options).code, Code::kUnsupported);
}

TEST_F(HostileTest, UnknownBinariesAreNotRecognised) {
  EXPECT_EQ(import_error(file("upload", std::string("\x7F"
                                                    "ELF\0\0\0\0",
                                                    8)))
                .code,
            Code::kUnsupported);
  EXPECT_EQ(import_error(file("upload", std::string(1000, '\0'))).code, Code::kUnsupported);
  EXPECT_EQ(import_error(file("upload", std::string("\x89HDF\0\0\1\2", 8)), named("a.csv")).code,
            Code::kUnsupported);
  EXPECT_EQ(import_error(file("upload", std::string(1000, '\0')), named("N44W072.hgt")).code,
            Code::kUnsupported);
}

TEST_F(HostileTest, EmptyAndMissingFilesAreNamedAsSuch) {
  EXPECT_EQ(import_error(file("upload", ""), named("dem.tif")).code, Code::kInvalidValue);
  EXPECT_EQ(import_error(path("nothing")).code, Code::kInvalidValue);
  EXPECT_EQ(import_error(path(".")).code, Code::kInvalidValue);
}

/// A little-endian TIFF of one strip or tile whose tags are as given.
std::string bare_tiff(const std::vector<std::array<std::uint32_t, 3>>& tags) {
  const auto put = [](std::string& out, std::uint32_t value, int bytes) {
    for (int i = 0; i < bytes; ++i) out.push_back(static_cast<char>(value >> (8 * i)));
  };
  std::string out("II*\0", 4);
  put(out, 8, 4);
  put(out, static_cast<std::uint32_t>(tags.size()), 2);
  for (const auto& [tag, type, value] : tags) {
    put(out, tag, 2);
    put(out, type, 2);
    put(out, 1, 4);
    put(out, value, 4);
  }
  put(out, 0, 4);
  return out + std::string(512, '\1');
}

TEST_F(HostileTest, HugeRastersAreRefusedBeforeTheyAreAllocated) {
  constexpr std::uint32_t kHuge = 0x7fffffff;
  const auto strips = file("strips", bare_tiff({{256, 4, kHuge},
                                                {257, 4, kHuge},
                                                {258, 3, 16},
                                                {259, 3, 1},
                                                {262, 3, 1},
                                                {273, 4, 8},
                                                {277, 3, 1},
                                                {278, 4, 1},
                                                {279, 4, 16}}));
  EXPECT_EQ(import_error(strips).code, Code::kTooLarge);
  const auto tile = file("tile", bare_tiff({{256, 4, 10},
                                            {257, 4, 10},
                                            {258, 3, 16},
                                            {259, 3, 1},
                                            {262, 3, 1},
                                            {277, 3, 1},
                                            {322, 4, 1 << 20},
                                            {323, 4, 1 << 20},
                                            {324, 4, 8},
                                            {325, 4, 16}}));
  const Code code = import_error(tile).code;
  EXPECT_TRUE(code == Code::kTooLarge || code == Code::kMalformed);
  const auto grid =
      file("grid", "ncols 2000000000\nnrows 2000000000\nxllcorner 0\nyllcorner 0\ncellsize 1\n1 2 3\n");
  const Code text = import_error(grid).code;
  EXPECT_TRUE(text == Code::kTooLarge || text == Code::kMalformed);
}

TEST_F(HostileTest, SparseRastersAreHeldToTheLimitToo) {
  TiffSpec spec;
  spec.width = 3000;
  spec.height = 3000;
  spec.creation_options = {"SPARSE_OK=YES", "COMPRESS=DEFLATE", "TILED=YES"};
  make_tiff(path("upload"), spec);
  ImportOptions options;
  options.max_samples = 1000000;
  EXPECT_EQ(import_error(path("upload"), options).code, Code::kTooLarge);
}

TEST_F(HostileTest, CutFilesAreErrorsAtEveryLength) {
  TiffSpec spec;
  spec.width = 64;
  spec.height = 64;
  spec.creation_options = {"COMPRESS=DEFLATE"};
  make_tiff(path("whole"), spec);
  const std::string whole = content(path("whole"));
  for (std::size_t length = 0; length < whole.size(); length += 1 + whole.size() / 150) {
    EXPECT_FALSE(import_file(file("upload", whole.substr(0, length)), {}, nullptr).ok()) << length;
  }
  make_vector(path("whole.gpkg"), "GPKG", {{"points", "EPSG:32632", {{1, 2, 3}, {4, 5, 6}}}});
  make_vector(path("whole.fgb"), "FlatGeobuf", {{"points", "EPSG:32632", {{1, 2, 3}, {4, 5, 6}}}});
  for (const char* name : {"whole.gpkg", "whole.fgb"}) {
    const std::string bytes = content(path(name));
    for (std::size_t length = 1; length < bytes.size() - bytes.size() / 20; length += 1 + bytes.size() / 20) {
      EXPECT_FALSE(import_file(file("upload", bytes.substr(0, length)), {}, nullptr).ok())
          << name << " " << length;
    }
  }
}

TEST_F(HostileTest, FlippedBytesNeverCrash) {
  TiffSpec spec;
  spec.width = 16;
  spec.height = 16;
  spec.creation_options = {"COMPRESS=LZW", "PREDICTOR=3"};
  make_tiff(path("a"), spec);
  make_vector(path("b.fgb"), "FlatGeobuf", {{"points", "EPSG:32632", {{1, 2, 3}, {4, 5, 6}}}});
  ImportOptions options;
  options.max_pixels = options.max_samples = 1'000'000;
  std::uint32_t random = 12345;
  for (const char* name : {"a", "b.fgb"}) {
    const std::string good = content(path(name));
    for (int round = 0; round < 400; ++round) {
      std::string bad = good;
      for (int flips = 0; flips < 3; ++flips) {
        random = random * 1664525 + 1013904223;
        bad[(random >> 8) % bad.size()] ^= static_cast<char>(1U << (random >> 29));
      }
      const auto import = import_file(file("upload", bad), options, nullptr);
      if (!import) {
        EXPECT_NE(import.error().code, Code::kInternal);
      }
    }
  }
}

TEST_F(HostileTest, AsciiGridsWithoutSenseAreRefused) {
  const auto grid = [&](const std::string& origin, const std::string& size, const std::string& values) {
    return import_error(file("upload", "ncols 2\nnrows 2\nxllcorner " + origin + "\nyllcorner 0\ncellsize " +
                                           size + "\nNODATA_value -9\n" + values))
        .code;
  };
  EXPECT_EQ(grid("nan", "1", "1 2\n3 4\n"), Code::kNotFinite);
  EXPECT_EQ(grid("1e400", "1", "1 2\n3 4\n"), Code::kNotFinite);
  EXPECT_EQ(grid("1e300", "1", "1 2\n3 4\n"), Code::kInvalidValue);
  EXPECT_EQ(grid("0", "0", "1 2\n3 4\n"), Code::kInvalidValue);
  EXPECT_EQ(grid("0", "1", "-9 -9\n-9 -9\n"), Code::kInvalidValue);
  EXPECT_EQ(grid("0", "1", "1 2\n"), Code::kMalformed) << "a row is missing";
}

TEST_F(HostileTest, MessagesDoNotTellOurPaths) {
  for (const char* bytes : {"II*\0garbage", "SQLite format 3\0garbage", "fgb\3fgb\0garbage", "{\"type\":"}) {
    const std::size_t size = bytes[0] == 'S' ? 23 : bytes[0] == 'f' ? 15 : bytes[0] == 'I' ? 11 : 8;
    const auto problem = import_error(file("upload", std::string(bytes, size)));
    EXPECT_EQ(problem.message.find("/tmp"), std::string::npos) << problem.message;
    EXPECT_EQ(problem.message.find("tinsmith-import"), std::string::npos) << problem.message;
  }
  EXPECT_EQ(files_left(), 1U);
}

TEST_F(HostileTest, ThreadsDoNotDisturbEachOther) {
  make_tiff(path("good"), {});
  file("bad", "II*\0garbage");
  std::vector<std::jthread> threads;
  for (int i = 0; i < 4; ++i) {
    threads.emplace_back([&, i] {
      for (int round = 0; round < 25; ++round) {
        const auto import = import_file(path(i % 2 == 0 ? "good" : "bad"), {}, nullptr);
        EXPECT_EQ(import.ok(), i % 2 == 0);
      }
    });
  }
}

}  // namespace
}  // namespace server::gdal::testing
