// Uploads: recognition of their format, our own reading of text, and GDAL's drivers as we allow them. The
// first byte chooses what the client says of the file.
#include "server/gdal/import.h"

#include <unistd.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>

#include "tests/fuzz/target.h"

namespace tests::fuzz {
namespace {

constexpr std::array<const char*, 8> kNames = {"",          "a.csv", "a.xyz", "N44W072.hgt",
                                               "a.geojson", "a.tif", "a.asc", "a.tsv"};

/// A folder in memory where there is one, removed at the end.
struct Folder {
  Folder() {
    namespace fs = std::filesystem;
    const fs::path base = fs::exists("/dev/shm") ? fs::path("/dev/shm") : fs::temp_directory_path();
    path = base / ("tinsmith-fuzz-" + std::to_string(::getpid()));
    fs::create_directories(path);
  }
  ~Folder() {
    std::error_code ignored;
    std::filesystem::remove_all(path, ignored);
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  std::filesystem::path path;
};

}  // namespace

std::vector<std::string> seeds() {
  std::vector<std::string> out;
  const auto add = [&](char name, const std::string& content) { out.push_back(name + content); };
  add('\1', "x,y,z\n1,2,3\n4,5,6\n7.5,8e1,-9\n");
  add('\1', "longitude;latitude;height\n7,1;45,9;1000\n7,2;45,8;1001,5\n");
  add('\1', "\"id\",\"x\",\"y\",\"z\"\r\n\"a \"\"b\"\"\",1,2,3\r\n");
  add('\2', "1 2 3\n4 5 6\n\n7\t8\t9\n");
  add('\7',
      "\xef\xbb\xbf"
      "east\tnorth\telev\n1\t2\t3\n");
  add('\6', "ncols 3\nnrows 2\nxllcorner 0\nyllcorner 0\ncellsize 1\nNODATA_value -9\n1 2 3\n4 -9 6\n");
  add('\4', R"({"type":"FeatureCollection","features":[{"type":"Feature","properties":{"h":2},)"
            R"("geometry":{"type":"Point","coordinates":[8,47,1]}}]})");
  std::string tiff("II*\0\10\0\0\0\12\0", 10);
  const auto put = [&](std::uint32_t value, int bytes) {
    for (int i = 0; i < bytes; ++i) tiff.push_back(static_cast<char>(value >> (8 * i)));
  };
  for (const auto& [tag, type, value] : std::vector<std::array<std::uint32_t, 3>>{{256, 4, 4},
                                                                                  {257, 4, 3},
                                                                                  {258, 3, 16},
                                                                                  {259, 3, 1},
                                                                                  {262, 3, 1},
                                                                                  {273, 4, 134},
                                                                                  {277, 3, 1},
                                                                                  {278, 4, 3},
                                                                                  {279, 4, 24},
                                                                                  {339, 3, 2}}) {
    put(tag, 2);
    put(type, 2);
    put(1, 4);
    put(value, 4);
  }
  put(0, 4);
  add('\5', tiff + std::string(24, '\2'));
  return out;
}

}  // namespace tests::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  namespace fs = std::filesystem;
  static const tests::fuzz::Folder folder;
  if (size == 0) return 0;
  const std::string_view bytes = tests::fuzz::text(data + 1, size - 1);
  const fs::path file = folder.path / "upload";
  std::ofstream(file, std::ios::binary | std::ios::trunc) << bytes;
  server::gdal::ImportOptions options;
  options.file_name = tests::fuzz::kNames[data[0] % tests::fuzz::kNames.size()];
  options.max_samples = 10'000;
  options.max_pixels = 100'000;
  const auto import = server::gdal::import_file(file, options, nullptr);
  if (!import) {
    TIN_CHECK(!import.error().message.empty());
    return 0;
  }
  TIN_CHECK(!import->placements.empty() && import->placements.size() <= options.max_samples);
  for (const auto& placement : import->placements) {
    TIN_CHECK(std::isfinite(placement.z));
    TIN_CHECK(tin::exact::in_lattice(placement.at.x, placement.at.y));
  }
  return 0;
}
