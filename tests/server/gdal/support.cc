#include "tests/server/gdal/support.h"

#include <cpl_string.h>
#include <gdal_priv.h>
#include <ogrsf_frmts.h>

#include <cstdlib>
#include <fstream>
#include <iterator>
#include <memory>

#include "server/gdal/library.h"

namespace server::gdal::testing {
namespace {

namespace fs = std::filesystem;

GDALDriver* driver(const std::string& name) {
  prepare_library();
  return GetGDALDriverManager()->GetDriverByName(name.c_str());
}

fs::path terrain_folder() {
  const char* const set = std::getenv("TINSMITH_TERRAIN");
  if (set != nullptr) return set;
  return fs::path(TINSMITH_SOURCE_DIR) / ".." / "shared" / "terrain";
}

void set_crs(OGRSpatialReference& crs, const std::string& name) {
  crs.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  ASSERT_EQ(crs.SetFromUserInput(name.c_str()), OGRERR_NONE);
}

}  // namespace

ScratchTest::ScratchTest() {
  std::string pattern = (fs::temp_directory_path() / "tinsmith-test-XXXXXX").string();
  if (mkdtemp(pattern.data()) == nullptr) std::abort();
  folder_ = pattern;
}

ScratchTest::~ScratchTest() {
  std::error_code ignored;
  fs::remove_all(folder_, ignored);
}

fs::path ScratchTest::file(const std::string& name, std::string_view content) const {
  std::ofstream out(path(name), std::ios::binary);
  out.write(content.data(), static_cast<std::streamsize>(content.size()));
  return path(name);
}

std::optional<fs::path> ScratchTest::terrain(const std::string& name) const {
  const fs::path source = terrain_folder() / name;
  if (!fs::exists(source)) return std::nullopt;
  const fs::path copy = path("upload-" + std::to_string(files_left()));
  fs::copy_file(source, copy);
  return copy;
}

std::size_t ScratchTest::files_left() const {
  return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder_), fs::directory_iterator()));
}

void make_tiff(const fs::path& file, const TiffSpec& spec) {
  CPLStringList options;
  for (const std::string& option : spec.creation_options) options.AddString(option.c_str());
  const GDALDataType type = GDALGetDataTypeByName(spec.type.c_str());
  GDALDatasetUniquePtr dataset(
      driver("GTiff")->Create(file.c_str(), spec.width, spec.height, 1, type, options.List()));
  ASSERT_TRUE(dataset);
  std::array<double, 6> transform = spec.geotransform;
  if (spec.placed) dataset->SetGeoTransform(transform.data());
  if (!spec.crs.empty()) {
    OGRSpatialReference crs;
    set_crs(crs, spec.crs);
    dataset->SetSpatialRef(&crs);
  }
  GDALRasterBand& band = *dataset->GetRasterBand(1);
  if (spec.nodata) band.SetNoDataValue(*spec.nodata);
  if (spec.scale != 1) band.SetScale(spec.scale);
  if (spec.offset != 0) band.SetOffset(spec.offset);
  if (!spec.unit.empty()) band.SetUnitType(spec.unit.c_str());
  if (spec.masked) {
    CPLSetThreadLocalConfigOption("GDAL_TIFF_INTERNAL_MASK", "YES");
    ASSERT_EQ(dataset->CreateMaskBand(GMF_PER_DATASET), CE_None);
    CPLSetThreadLocalConfigOption("GDAL_TIFF_INTERNAL_MASK", nullptr);
  }
  for (int row = 0; row < spec.height; ++row) {
    std::vector<double> values;
    for (int column = 0; column < spec.width; ++column) values.push_back(spec.value(column, row));
    ASSERT_EQ(band.RasterIO(GF_Write, 0, row, spec.width, 1, values.data(), spec.width, 1, GDT_Float64, 0, 0,
                            nullptr),
              CE_None);
    if (!spec.masked) continue;
    std::vector<std::uint8_t> mask(static_cast<std::size_t>(spec.width), 255);
    if (row == 0) mask[0] = 0;
    ASSERT_EQ(band.GetMaskBand()->RasterIO(GF_Write, 0, row, spec.width, 1, mask.data(), spec.width, 1,
                                           GDT_Byte, 0, 0, nullptr),
              CE_None);
  }
}

void make_vector(const fs::path& file, const std::string& driver_name,
                 const std::vector<PointLayer>& layers) {
  GDALDatasetUniquePtr dataset(driver(driver_name)->Create(file.c_str(), 0, 0, 0, GDT_Unknown, nullptr));
  ASSERT_TRUE(dataset);
  for (const PointLayer& wanted : layers) {
    OGRSpatialReference crs;
    set_crs(crs, wanted.crs);
    OGRLayer* layer =
        dataset->CreateLayer(wanted.name.c_str(), &crs, wanted.polygons ? wkbPolygon : wkbPoint25D);
    ASSERT_NE(layer, nullptr);
    OGRFieldDefn twice("twice", OFTReal);
    layer->CreateField(&twice);
    for (const auto& [x, y, z] : wanted.points) {
      OGRFeature feature(layer->GetLayerDefn());
      OGRPoint point(x, y, z);
      feature.SetGeometry(&point);
      feature.SetField("twice", 2 * z);
      ASSERT_EQ(layer->CreateFeature(&feature), OGRERR_NONE);
    }
  }
}

ReadBack read_back(const fs::path& file) {
  prepare_library();
  ReadBack read;
  GDALDatasetUniquePtr dataset(GDALDataset::Open(file.c_str(), GDAL_OF_RASTER));
  if (!dataset) {
    ADD_FAILURE() << "GDAL cannot read " << file;
    return read;
  }
  read.width = dataset->GetRasterXSize();
  read.height = dataset->GetRasterYSize();
  dataset->GetGeoTransform(read.geotransform.data());
  if (const OGRSpatialReference* crs = dataset->GetSpatialRef(); crs && crs->GetAuthorityCode(nullptr)) {
    read.authority = std::string(crs->GetAuthorityName(nullptr)) + ":" + crs->GetAuthorityCode(nullptr);
  }
  GDALRasterBand& band = *dataset->GetRasterBand(1);
  int has_nodata = FALSE;
  const double nodata = band.GetNoDataValue(&has_nodata);
  if (has_nodata) read.nodata = nodata;
  read.data_type = GDALGetDataTypeName(band.GetRasterDataType());
  read.unit = band.GetUnitType();
  const auto text = [](const char* value) { return std::string(value == nullptr ? "" : value); };
  read.area_or_point = text(dataset->GetMetadataItem(GDALMD_AREA_OR_POINT));
  read.compression = text(dataset->GetMetadataItem("COMPRESSION", "IMAGE_STRUCTURE"));
  read.predictor = text(dataset->GetMetadataItem("PREDICTOR", "IMAGE_STRUCTURE"));
  band.GetBlockSize(&read.block_width, &read.block_height);
  read.values.resize(static_cast<std::size_t>(read.width) * static_cast<std::size_t>(read.height));
  EXPECT_EQ(band.RasterIO(GF_Read, 0, 0, read.width, read.height, read.values.data(), read.width, read.height,
                          GDT_Float64, 0, 0, nullptr),
            CE_None);
  return read;
}

tin::base::Error import_error(const fs::path& file, const ImportOptions& options) {
  auto import = import_file(file, options, nullptr);
  if (!import) return import.error();
  ADD_FAILURE() << "read as " << import->driver << ", " << import->placements.size() << " samples";
  return {};
}

Import imported(const fs::path& file, const ImportOptions& options) {
  auto import = import_file(file, options, nullptr);
  if (import) return *std::move(import);
  ADD_FAILURE() << import.error().message;
  return {};
}

ImportOptions named(const std::string& file_name) {
  ImportOptions options;
  options.file_name = file_name;
  return options;
}

}  // namespace server::gdal::testing
