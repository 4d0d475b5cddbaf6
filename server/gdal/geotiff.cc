#include "server/gdal/geotiff.h"

#include <cpl_string.h>
#include <gdal_priv.h>
#include <ogr_spatialref.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <memory>
#include <optional>
#include <system_error>
#include <vector>

#include "server/gdal/crs_internal.h"
#include "server/gdal/library.h"
#include "server/gdal/not_written.h"

namespace server::gdal {
namespace {

using tin::base::Code;
using tin::base::error;
using tin::base::Error;
using tin::base::Progress;
using tin::base::Result;

using Dataset = std::unique_ptr<GDALDataset, GDALDatasetUniquePtrDeleter>;

constexpr std::int64_t kTile = 256;
constexpr std::int64_t kLowestTile = 16;
constexpr std::int64_t kBufferBytes = std::int64_t{64} << 20;

std::optional<Error> check(const RasterSpec& spec) {
  constexpr std::int64_t kLongest = std::numeric_limits<std::int32_t>::max() - kTile;
  if (spec.width < 1 || spec.height < 1 || spec.width > kLongest || spec.height > kLongest) {
    return error(Code::kInvalidValue, "A raster needs between 1 and 2^31 columns and rows");
  }
  const auto& g = spec.geotransform;
  if (!std::all_of(g.begin(), g.end(), [](double v) { return std::isfinite(v); }) ||
      g[1] * g[5] == g[2] * g[4]) {
    return error(Code::kInvalidValue, "The geotransform must be finite and invertible");
  }
  const bool single = spec.data_type == "Float32";
  if (!single && spec.data_type != "Float64") {
    return error(Code::kInvalidValue, "Elevations are written as Float32 or Float64");
  }
  const bool representable =
      !std::isfinite(spec.nodata) || std::abs(spec.nodata) <= std::numeric_limits<float>::max();
  if (single &&
      (!representable || (std::isfinite(spec.nodata) && static_cast<float>(spec.nodata) != spec.nodata))) {
    return error(Code::kInvalidValue, "The nodata value is not a Float32");
  }
  return std::nullopt;
}

/// Rows of tiles as high as the buffer allows, in powers of two.
std::int64_t tile_height(std::int64_t width, std::int64_t bytes_per_value) {
  std::int64_t height = kTile;
  while (height > kLowestTile && height * width * bytes_per_value > kBufferBytes) height /= 2;
  return height;
}

/// A GeoTIFF under construction. Whole tiles are handed to GDAL in order, past its block cache: what other
/// threads read or write cannot change the order of the tiles in the file, so that its bytes depend on its
/// content only.
template <class Value>
class TileWriter {
 public:
  TileWriter(GDALRasterBand& band, const RasterSpec& spec, std::int64_t tile_rows)
      : band_(band),
        spec_(spec),
        tile_rows_(tile_rows),
        tile_(static_cast<std::size_t>(kTile * tile_rows)),
        strip_(static_cast<std::size_t>(spec.width * tile_rows)),
        row_(static_cast<std::size_t>(spec.width)) {}

  std::optional<Error> write_strip(std::int64_t strip, const RowSource& rows, Progress* progress) {
    const std::int64_t first = strip * tile_rows_;
    const std::int64_t count = std::min(tile_rows_, spec_.height - first);
    for (std::int64_t i = 0; i < count; ++i) {
      if (progress != nullptr && progress->cancelled())
        return error(Code::kCancelled, "The export was cancelled");
      if (auto filled = rows(first + i, row_); !filled) return filled.error();
      std::transform(row_.begin(), row_.end(), strip_.begin() + i * spec_.width,
                     [](double value) { return static_cast<Value>(value); });
    }
    for (std::int64_t tile = 0; tile * kTile < spec_.width; ++tile) {
      fill_tile(tile * kTile, count);
      if (band_.WriteBlock(static_cast<int>(tile), static_cast<int>(strip), tile_.data()) != CE_None) {
        return error(Code::kStorage, "The GeoTIFF could not be written");
      }
    }
    if (progress != nullptr)
      progress->report(static_cast<double>(first + count) / static_cast<double>(spec_.height));
    return std::nullopt;
  }

 private:
  void fill_tile(std::int64_t first_column, std::int64_t rows) {
    const std::int64_t columns = std::min(kTile, spec_.width - first_column);
    std::fill(tile_.begin(), tile_.end(), static_cast<Value>(spec_.nodata));
    for (std::int64_t i = 0; i < rows; ++i) {
      std::copy_n(strip_.begin() + i * spec_.width + first_column, columns, tile_.begin() + i * kTile);
    }
  }

  GDALRasterBand& band_;
  const RasterSpec& spec_;
  std::int64_t tile_rows_;
  std::vector<Value> tile_, strip_;
  std::vector<double> row_;
};

template <class Value>
std::optional<Error> write_tiles(GDALRasterBand& band, const RasterSpec& spec, std::int64_t tile_rows,
                                 const RowSource& rows, Progress* progress) {
  TileWriter<Value> writer(band, spec, tile_rows);
  for (std::int64_t strip = 0; strip * tile_rows < spec.height; ++strip) {
    if (auto bad = writer.write_strip(strip, rows, progress)) return bad;
  }
  return std::nullopt;
}

Dataset create(const std::filesystem::path& out, const RasterSpec& spec, std::int64_t tile_rows) {
  CPLStringList options;
  options.SetNameValue("TILED", "YES");
  options.SetNameValue("BLOCKXSIZE", std::to_string(kTile).c_str());
  options.SetNameValue("BLOCKYSIZE", std::to_string(tile_rows).c_str());
  options.SetNameValue("COMPRESS", "DEFLATE");
  options.SetNameValue("PREDICTOR", "3");
  options.SetNameValue("BIGTIFF", "IF_SAFER");
  GDALDriver* driver = GetGDALDriverManager()->GetDriverByName("GTiff");
  const GDALDataType type = spec.data_type == "Float32" ? GDT_Float32 : GDT_Float64;
  return Dataset(driver->Create(out.c_str(), static_cast<int>(spec.width), static_cast<int>(spec.height), 1,
                                type, options.List()));
}

bool describe(GDALDataset& dataset, const RasterSpec& spec, const OGRSpatialReference* crs) {
  std::array<double, 6> transform = spec.geotransform;
  GDALRasterBand& band = *dataset.GetRasterBand(1);
  bool good = dataset.SetGeoTransform(transform.data()) == CE_None;
  good = good && (crs == nullptr || dataset.SetSpatialRef(crs) == CE_None);
  good = good && dataset.SetMetadataItem(GDALMD_AREA_OR_POINT, GDALMD_AOP_AREA) == CE_None;
  good = good && band.SetNoDataValue(spec.nodata) == CE_None;
  return good && (spec.vertical_unit.empty() || band.SetUnitType(spec.vertical_unit.c_str()) == CE_None);
}

std::optional<Error> write(const std::filesystem::path& out, const RasterSpec& spec,
                           const OGRSpatialReference* crs, const RowSource& rows, Progress* progress) {
  const Complaints complaints;
  const bool single = spec.data_type == "Float32";
  const std::int64_t tile_rows = tile_height(spec.width, single ? 4 : 8);
  Dataset dataset = create(out, spec, tile_rows);
  const auto failed = [&] {
    return not_written("The GeoTIFF could not be written" + complaints.aside(out.parent_path()), out);
  };
  if (!dataset || !describe(*dataset, spec, crs)) return failed();
  GDALRasterBand& band = *dataset->GetRasterBand(1);
  auto bad = single ? write_tiles<float>(band, spec, tile_rows, rows, progress)
                    : write_tiles<double>(band, spec, tile_rows, rows, progress);
  if (bad && bad->code == Code::kStorage) return failed();
  dataset.reset();
  if (bad) return bad;
  // Closing reports its failures, such as a full disk, only as messages.
  if (complaints.any()) return failed();
  return std::nullopt;
}

}  // namespace

Result<void> write_geotiff(const std::filesystem::path& out, const RasterSpec& spec, const RowSource& rows,
                           Progress* progress) {
  prepare_library();
  if (auto bad = check(spec)) return *std::move(bad);
  std::unique_ptr<OGRSpatialReference> crs;
  if (!spec.crs.empty()) {
    auto parsed = parse_crs(spec.crs);
    if (!parsed) return parsed.error();
    crs = *std::move(parsed);
  }
  std::error_code ignored;
  std::filesystem::remove(out, ignored);
  if (auto bad = write(out, spec, crs.get(), rows, progress)) {
    std::filesystem::remove(out, ignored);
    return *std::move(bad);
  }
  return {};
}

namespace {

/// A file that goes with its scope, and what GDAL may have put beside it.
struct Temporary {
  std::filesystem::path path;
  ~Temporary() {
    std::error_code ignored;
    std::filesystem::remove(path, ignored);
  }
};

std::optional<Error> copy_as_cog(const std::filesystem::path& from, const std::filesystem::path& out) {
  const Complaints complaints;
  CPLStringList options;
  options.SetNameValue("COMPRESS", "DEFLATE");
  options.SetNameValue("PREDICTOR", "YES");
  options.SetNameValue("RESAMPLING", "AVERAGE");
  options.SetNameValue("BIGTIFF", "IF_SAFER");
  const char* const drivers[] = {"GTiff", nullptr};
  Dataset source(GDALDataset::Open(from.c_str(), GDAL_OF_RASTER | GDAL_OF_READONLY, drivers));
  Dataset copy;
  if (source) {
    copy.reset(GetGDALDriverManager()->GetDriverByName("COG")->CreateCopy(out.c_str(), source.get(), FALSE,
                                                                          options.List(), nullptr, nullptr));
  }
  const bool made = copy != nullptr;
  copy.reset();
  if (made && !complaints.any()) return std::nullopt;
  return not_written("The cloud-optimised GeoTIFF could not be written" + complaints.aside(out.parent_path()), out);
}

}  // namespace

Result<void> write_cog(const std::filesystem::path& out, const RasterSpec& spec, const RowSource& rows,
                       Progress* progress) {
  const Temporary plain{out.string() + ".plain.tif"};
  if (auto written = write_geotiff(plain.path, spec, rows, progress); !written) return written.error();
  std::error_code ignored;
  std::filesystem::remove(out, ignored);
  if (auto bad = copy_as_cog(plain.path, out)) {
    std::filesystem::remove(out, ignored);
    return *std::move(bad);
  }
  return {};
}

}  // namespace server::gdal
