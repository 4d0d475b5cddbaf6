// Elevation rasters: one sample per valid pixel, at the pixel's centre.
#include <gdal_priv.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>

#include "server/gdal/import_internal.h"
#include "server/gdal/library.h"
#include "tin/terrain/heights_builder.h"

namespace server::gdal {
namespace {

using tin::base::Code;
using tin::base::error;
using tin::base::Error;
using tin::base::Result;

using Dataset = std::unique_ptr<GDALDataset, GDALDatasetUniquePtrDeleter>;

constexpr std::size_t kSamplesAtOnce = std::size_t{8} << 20;
/// No terrain is as high as this: fill values that a file forgot to declare, such as -3.4e38, are void.
constexpr double kLargestHeight = 1e30;

const char* driver_name(Format format) {
  switch (format) {
    case Format::kHgt:
      return "SRTMHGT";
    case Format::kAsciiGrid:
      return "AAIGrid";
    case Format::kUsgsDem:
      return "USGSDEM";
    case Format::kDted:
      return "DTED";
    case Format::kSurferText:
      return "GSAG";
    case Format::kSurferBinary:
      return "GSBG";
    case Format::kSurfer7:
      return "GS7BG";
    case Format::kVtpTerrain:
      return "BT";
    default:
      return "GTiff";
  }
}

Result<Dataset> open(const ImportTask& task) {
  const Complaints complaints;
  const char* const drivers[] = {driver_name(task.format), nullptr};
  Dataset dataset(
      GDALDataset::Open(task.workspace.file().c_str(), GDAL_OF_RASTER | GDAL_OF_READONLY, drivers));
  if (!dataset) {
    return error(Code::kMalformed, "The " + std::string(format_title(task.format)) + " file cannot be read" +
                                       complaints.aside(task.workspace.folder()));
  }
  return dataset;
}

bool is_real(GDALDataType type) {
  constexpr std::array kReal{GDT_Byte,  GDT_UInt16,  GDT_Int16,  GDT_UInt32,
                             GDT_Int32, GDT_Float32, GDT_Float64};
  return std::find(kReal.begin(), kReal.end(), type) != kReal.end();
}

/// What must hold before anything of the raster's size is allocated.
std::optional<Error> check_size(GDALDataset& dataset, const ImportOptions& options) {
  const auto width = static_cast<std::uint64_t>(std::max(0, dataset.GetRasterXSize()));
  const auto height = static_cast<std::uint64_t>(std::max(0, dataset.GetRasterYSize()));
  const auto bands = static_cast<std::uint64_t>(std::max(0, dataset.GetRasterCount()));
  if (width == 0 || height == 0 || bands == 0) return error(Code::kInvalidValue, "The raster is empty");
  if (width > options.max_pixels / height) {
    return error(Code::kTooLarge, "The raster has " + std::to_string(width) + " x " + std::to_string(height) +
                                      " pixels; the limit here is " + std::to_string(options.max_pixels));
  }
  int block_x = 0, block_y = 0;
  dataset.GetRasterBand(1)->GetBlockSize(&block_x, &block_y);
  const auto block = static_cast<std::uint64_t>(block_x) * static_cast<std::uint64_t>(block_y);
  constexpr std::uint64_t kSmallBlock = 1 << 20;
  if (block_x <= 0 || block_y <= 0 || block > std::max(options.max_pixels, kSmallBlock) / bands) {
    return error(Code::kTooLarge, "The raster is stored in blocks that are too large to be read");
  }
  return std::nullopt;
}

/// One band as samples: reads rows, tells valid from void, applies scale and offset.
class Samples {
 public:
  static Result<Samples> of(GDALRasterBand& band) {
    Samples samples(band);
    if (!is_real(band.GetRasterDataType())) {
      return error(Code::kUnsupported, std::string("Pixels of type ") +
                                           GDALGetDataTypeName(band.GetRasterDataType()) + " are not read");
    }
    if (!std::isfinite(samples.scale_) || !std::isfinite(samples.offset_) || samples.scale_ == 0) {
      return error(Code::kMalformed, "The raster's scale or offset is not usable");
    }
    return samples;
  }

  bool scaled() const { return scale_ != 1 || offset_ != 0; }
  std::optional<double> nodata() const { return nodata_; }

  /// Reads `rows` rows from `row` on. False when the file is damaged.
  bool read(int row, int rows) {
    const int width = band_->GetXSize();
    values_.resize(static_cast<std::size_t>(width) * static_cast<std::size_t>(rows));
    if (band_->RasterIO(GF_Read, 0, row, width, rows, values_.data(), width, rows, GDT_Float64, 0, 0,
                        nullptr) != CE_None) {
      return false;
    }
    if (mask_ == nullptr) return true;
    masked_.resize(values_.size());
    return mask_->RasterIO(GF_Read, 0, row, width, rows, masked_.data(), width, rows, GDT_Byte, 0, 0,
                           nullptr) == CE_None;
  }

  /// The height at the i-th sample of those read; NaN when it is void.
  double height(std::size_t i) const {
    constexpr double kVoid = std::numeric_limits<double>::quiet_NaN();
    const double value = values_[i];
    if ((nodata_ && (value == *nodata_ || value == nodata_as_stored_)) ||
        (mask_ != nullptr && masked_[i] == 0)) {
      return kVoid;
    }
    const double height = value * scale_ + offset_;
    return std::abs(height) <= kLargestHeight ? height : kVoid;
  }

 private:
  explicit Samples(GDALRasterBand& band) : band_(&band), scale_(band.GetScale()), offset_(band.GetOffset()) {
    int has_nodata = FALSE;
    const double nodata = band.GetNoDataValue(&has_nodata);
    if (has_nodata) {
      nodata_ = nodata_as_stored_ = nodata;
      if (band.GetRasterDataType() == GDT_Float32 && std::abs(nodata) <= std::numeric_limits<float>::max()) {
        nodata_as_stored_ = static_cast<float>(nodata);
      }
    }
    if ((band.GetMaskFlags() & (GMF_PER_DATASET | GMF_ALPHA)) != 0) {
      GDALRasterBand* mask = band.GetMaskBand();
      if (mask != nullptr && mask->GetXSize() == band.GetXSize() && mask->GetYSize() == band.GetYSize())
        mask_ = mask;
    }
  }

  GDALRasterBand* band_;
  GDALRasterBand* mask_ = nullptr;
  double scale_, offset_;
  std::optional<double> nodata_;
  double nodata_as_stored_ = 0;
  std::vector<double> values_;
  std::vector<std::uint8_t> masked_;
};

Result<std::array<double, 6>> geotransform_of(GDALDataset& dataset) {
  std::array<double, 6> g{};
  if (dataset.GetGeoTransform(g.data()) != CE_None) {
    return error(Code::kInvalidValue, "The raster does not say where it lies: it has no georeference");
  }
  if (!std::all_of(g.begin(), g.end(), [](double v) { return std::isfinite(v); })) {
    return error(Code::kNotFinite, "The raster's origin or pixel size is not a finite number");
  }
  if (g[2] != 0 || g[4] != 0) return error(Code::kUnsupported, "Rotated or sheared rasters are not read");
  if (g[1] < 0) return error(Code::kUnsupported, "Rasters that run from east to west are not read");
  if (g[1] == 0 || g[5] == 0) return error(Code::kInvalidValue, "The raster's pixels have no size");
  return g;
}

/// The frame of the raster, and its grid without the valid bits.
Result<Import> fit(const ImportTask& task, GDALDataset& dataset) {
  auto crs = effective_crs(task, dataset.GetSpatialRef());
  if (!crs) return crs.error();
  auto transform = geotransform_of(dataset);
  if (!transform) return transform.error();
  const std::array<double, 6>& g = *transform;
  const int width = dataset.GetRasterXSize();
  const int height = dataset.GetRasterYSize();
  const bool north_up = g[5] < 0;
  const tin::frame::RasterShape shape{
      g[0] + g[1] / 2, north_up ? g[3] + g[5] / 2 : g[3] + g[5] * (height - 0.5), g[1], std::abs(g[5]), width,
      height};
  auto frame = tin::frame::fit_raster(shape, *crs ? (*crs)->scale : tin::frame::GroundScale{},
                                      task.options.resolution_x, task.options.resolution_y);
  if (!frame) return frame.error();

  Import import;
  import.frame = *std::move(frame);
  describe_frame(import.frame, *crs, vertical_unit(dataset.GetRasterBand(1)->GetUnitType()));
  import.driver = driver_name(task.format);
  import.bands = dataset.GetRasterCount();
  import.grid = std::make_shared<tin::terrain::SourceGrid>();
  tin::terrain::SourceGrid& grid = *import.grid;
  const auto parts_y = static_cast<std::int32_t>(import.frame.y.parts);
  grid.width = width;
  grid.height = height;
  grid.dx = static_cast<std::int32_t>(import.frame.x.parts);
  grid.dy = north_up ? -parts_y : parts_y;
  grid.x0 = -(width / 2) * grid.dx;
  grid.y0 = (north_up ? height / 2 : height / 2 - (height - 1)) * parts_y;
  grid.geotransform = g;
  return import;
}

/// Keeps heights and valid bits, as one who takes rows.
class KeptRows final : public RowTaker {
 public:
  KeptRows(Import& import, std::size_t pixels, std::pmr::memory_resource* memory)
      : import_(import), heights_(pixels, memory) {
    import.grid->valid.assign((pixels + 63) / 64, 0);
  }

  bool begin(const Import&) override { return true; }
  bool take(std::span<const double> heights) override {
    for (const double height : heights) {
      if (std::isnan(height)) {
        heights_.skip();
      } else {
        const std::size_t bit = heights_.size();
        heights_.add(height);
        import_.grid->valid[bit / 64] |= std::uint64_t{1} << (bit % 64);
      }
    }
    return true;
  }
  /// `all` says that every pixel is a sample.
  void finish(bool all) {
    if (all) import_.grid->valid.clear();
    import_.heights = std::move(heights_).finish();
  }

 private:
  Import& import_;
  tin::terrain::HeightsBuilder heights_;
};

/// Gives the heights to `rows`, and fills placements if they are wanted.
Result<std::size_t> read_rows(const ImportTask& task, GDALRasterBand& band, Samples& samples, RowTaker& rows,
                              Import& import) {
  const Complaints complaints;
  const tin::terrain::SourceGrid& grid = *import.grid;
  const auto width = static_cast<std::size_t>(grid.width);
  std::size_t count = 0;
  std::vector<double> heights(width);
  int block_x = 0, block_y = 0;
  band.GetBlockSize(&block_x, &block_y);
  const int at_once =
      std::clamp(block_y, 1, static_cast<int>(std::max<std::size_t>(1, kSamplesAtOnce / width)));
  if (!rows.begin(import)) return cancelled_error();
  for (std::int32_t row = 0; row < grid.height; ++row) {
    if (task.cancelled()) return cancelled_error();
    const int within = row % at_once;
    if (within == 0 && !samples.read(row, std::min(at_once, grid.height - row))) {
      return error(Code::kMalformed, "The raster is damaged at row " + std::to_string(row) +
                                         complaints.aside(task.workspace.folder()));
    }
    const std::size_t first = static_cast<std::size_t>(within) * width;
    for (std::int32_t column = 0; column < grid.width; ++column) {
      const auto i = static_cast<std::size_t>(column);
      heights[i] = samples.height(first + i);
      if (std::isnan(heights[i])) continue;
      ++count;
      if (!task.options.heights_only) import.placements.push_back({grid.centre(column, row), heights[i]});
    }
    if (!rows.take(heights)) return cancelled_error();
    if (!task.options.heights_only && count > task.options.max_samples)
      return too_many_samples(task.options.max_samples);
    task.report(static_cast<double>(row + 1) / grid.height);
  }
  if (count == 0)
    return error(Code::kInvalidValue, "The raster holds no elevations: it is all nodata");
  return count;
}

/// Fills placements, heights and valid bits, or gives the last two to who takes rows.
std::optional<Error> read_samples(const ImportTask& task, GDALRasterBand& band, Samples& samples,
                                  Import& import) {
  if (task.rows != nullptr) {
    const auto count = read_rows(task, band, samples, *task.rows, import);
    return count ? std::nullopt : std::optional(count.error());
  }
  const std::size_t pixels =
      static_cast<std::size_t>(import.grid->width) * static_cast<std::size_t>(import.grid->height);
  KeptRows kept(import, pixels, task.options.memory);
  const auto count = read_rows(task, band, samples, kept, import);
  if (!count) return count.error();
  kept.finish(*count == pixels);
  return std::nullopt;
}

}  // namespace

Result<Import> import_raster(const ImportTask& task) {
  auto dataset = open(task);
  if (!dataset) return dataset.error();
  if (auto bad = check_size(**dataset, task.options)) return *std::move(bad);
  GDALRasterBand& band = *(*dataset)->GetRasterBand(1);
  auto samples = Samples::of(band);
  if (!samples) return samples.error();
  auto import = fit(task, **dataset);
  if (!import) return import.error();
  // Scaled values are no longer of the file's type, and its nodata value may be one of them.
  import->grid->data_type = samples->scaled() ? "Float64" : GDALGetDataTypeName(band.GetRasterDataType());
  if (!samples->scaled()) import->grid->nodata = samples->nodata();
  if (task.options.look) {
    if (auto fine = task.options.look(*import); !fine) return fine.error();
  }
  if (auto bad = read_samples(task, band, *samples, *import)) return *std::move(bad);
  return import;
}

}  // namespace server::gdal
