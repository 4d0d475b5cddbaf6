// Shapefiles alone, and in ZIP archives of anyone.
#include <gdal_priv.h>
#include <ogrsf_frmts.h>

#include <csignal>
#include <fstream>
#include <iterator>

#include "server/gdal/decoder.h"
#include "server/gdal/library.h"
#include "tests/server/gdal/support.h"

namespace server::gdal::testing {
namespace {

using tin::base::Code;

class ShapefileTest : public ScratchTest {
 protected:
  ShapefileTest() {
    make_vector(path("hill.shp"), "ESRI Shapefile",
                {{.points = {{500000, 4100000, 7}, {500010, 4100000, 8}}}});
  }
  std::string content(const std::string& name) const {
    std::ifstream in(path(name), std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  /// An archive of entries, each with its content.
  std::filesystem::path zip(const std::vector<std::pair<std::string, std::string>>& entries) const {
    const std::string archive = path("upload.zip");
    std::filesystem::remove(archive);
    void* const made = CPLCreateZip(archive.c_str(), nullptr);
    for (const auto& [name, bytes] : entries) {
      EXPECT_EQ(CPLCreateFileInZip(made, name.c_str(), nullptr), CE_None);
      EXPECT_EQ(CPLWriteFileInZip(made, bytes.data(), static_cast<int>(bytes.size())), CE_None);
      EXPECT_EQ(CPLCloseFileInZip(made), CE_None);
    }
    EXPECT_EQ(CPLCloseZip(made), CE_None);
    return archive;
  }
};

void expect_hill(const Import& import) {
  EXPECT_EQ(import.driver, "ESRI Shapefile");
  ASSERT_EQ(import.placements.size(), 2U);
  EXPECT_EQ(import.placements[1].at, import.frame.to_lattice(500010, 4100000).value());
  EXPECT_EQ(import.placements[1].z, 8);
}

TEST_F(ShapefileTest, AloneItHasHeightsAndNoCrs) {
  const Import import = imported(path("hill.shp"));
  expect_hill(import);
  EXPECT_EQ(import.frame.crs, "");
  ImportOptions options;
  options.crs = "EPSG:32632";
  EXPECT_EQ(imported(path("hill.shp"), options).frame.crs, "EPSG:32632");
}

TEST_F(ShapefileTest, InAnArchiveItHasItsCompanions) {
  std::vector<std::pair<std::string, std::string>> entries;
  for (const char* suffix : {".shp", ".SHX", ".dbf", ".prj"}) {
    std::string name = std::string("hill") + suffix;
    if (name == "hill.SHX") name = "hill.shx";
    entries.emplace_back("some folder/Hill" + std::string(suffix), content(name));
  }
  entries.emplace_back("__MACOSX/some folder/._Hill.shp", "junk");
  entries.emplace_back("readme.txt", "hello");
  const auto archive = zip(entries);
  const Import import = imported(archive);
  expect_hill(import);
  EXPECT_EQ(import.frame.crs, "EPSG:32632");
  ImportOptions options;
  options.z_field = "twice";
  EXPECT_EQ(imported(archive, options).placements[1].z, 16);
  EXPECT_EQ(files_left(), 5U);  // the four that the shapefile was made of, and the archive
}

TEST_F(ShapefileTest, ArchivesThatMeanIllAreRefused) {
  const std::string shape = content("hill.shp");
  EXPECT_EQ(import_error(zip({{"readme.txt", "hello"}})).code, Code::kUnsupported);
  EXPECT_EQ(import_error(zip({{"a.shp", shape}, {"b.shp", shape}})).code, Code::kInvalidValue);
  EXPECT_EQ(import_error(zip({{"a.shp", "no shapes"}})).code, Code::kMalformed);
  EXPECT_EQ(import_error(file("upload", "PK\003\004 and then nothing of the kind")).code, Code::kMalformed);
  // Names that lead elsewhere are no names.
  EXPECT_EQ(import_error(zip({{"../../../../../../tmp/escaped.shp", shape}})).code, Code::kMalformed);
  EXPECT_FALSE(std::filesystem::exists("/tmp/escaped.shp"));
}

TEST_F(ShapefileTest, AnArchiveUnpacksUpToTheLimit) {
  ImportOptions options;
  const std::string shape = content("hill.shp");
  options.max_unpacked_bytes = shape.size();
  expect_hill(imported(zip({{"a.shp", shape}, {"other.bin", std::string(1 << 20, 'x')}}), options));
  options.max_unpacked_bytes = shape.size() - 1;
  EXPECT_EQ(import_error(zip({{"a.shp", shape}}), options).code, Code::kTooLarge);
  options.max_unpacked_bytes = 1 << 20;
  EXPECT_EQ(import_error(zip({{"a.shp", std::string(64 << 20, '\0')}}), options).code, Code::kTooLarge);
}

TEST_F(ShapefileTest, AnEntryBeyondTheDecodersFilesIsTooLarge) {
  // As the server has it; the decoder must not inherit that.
  const auto before = std::signal(SIGXFSZ, SIG_IGN);
  const auto archive = zip({{"a.shp", std::string(2 << 20, '\0')}});
  Decoder decoder{TINSMITH_PROGRAM, {}};
  decoder.limits.file_bytes = 1 << 20;
  const auto refused = decoder.import_file(archive, {}, nullptr);
  ASSERT_FALSE(refused.ok());
  EXPECT_EQ(refused.error().code, Code::kTooLarge) << refused.error().message;
  decoder.limits.file_bytes = 2 << 20;
  const auto damaged = decoder.import_file(archive, {}, nullptr);
  ASSERT_FALSE(damaged.ok());
  EXPECT_EQ(damaged.error().code, Code::kMalformed) << damaged.error().message;
  std::signal(SIGXFSZ, before);
}

}  // namespace
}  // namespace server::gdal::testing
