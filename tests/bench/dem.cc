#include "tests/bench/dem.h"

#include <gdal_priv.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "tin/frame/frame.h"

namespace bench {

using tin::terrain::SourceGrid;

namespace {

struct Closer {
  void operator()(GDALDataset* dataset) const { GDALClose(dataset); }
};
using Dataset = std::unique_ptr<GDALDataset, Closer>;

std::shared_ptr<const SourceGrid> lattice(std::int32_t width, std::int32_t height, const std::array<double, 6>& transform,
                                          bool geographic) {
  const double pixel_x = transform[1], pixel_y = std::abs(transform[5]);
  const auto frame = tin::frame::fit_raster(
      {transform[0] + pixel_x / 2, transform[3] - pixel_y / 2, pixel_x, pixel_y, width, height}, {.geographic = geographic});
  if (!frame) throw std::runtime_error("no lattice holds the raster");
  auto grid = std::make_shared<SourceGrid>();
  grid->width = width;
  grid->height = height;
  grid->dx = static_cast<std::int32_t>(frame->x.parts);
  grid->dy = -static_cast<std::int32_t>(frame->y.parts);
  grid->x0 = -(width / 2) * grid->dx;
  grid->y0 = -(height / 2) * grid->dy;
  grid->geotransform = transform;
  return grid;
}

/// Cubic convolution (Keys 1981) of four values at 0 <= t < 1 between the middle ones.
double cubic(const std::array<double, 4>& v, double t) {
  return v[1] + t * (v[2] - v[0] + t * (2 * v[0] - 5 * v[1] + 4 * v[2] - v[3] + t * (3 * (v[1] - v[2]) + v[3] - v[0]))) / 2;
}

}  // namespace

Dem read_dem(const std::string& path) {
  GDALAllRegister();
  const Dataset dataset(static_cast<GDALDataset*>(GDALOpen(path.c_str(), GA_ReadOnly)));
  if (!dataset || dataset->GetRasterCount() < 1) throw std::runtime_error("can't read " + path);
  Dem dem;
  dem.name = path.substr(path.find_last_of('/') + 1);
  dem.name = dem.name.substr(0, dem.name.find_last_of('.'));
  const int width = dataset->GetRasterXSize(), height = dataset->GetRasterYSize();
  std::array<double, 6> transform{0, 1, 0, 0, 0, -1};
  dataset->GetGeoTransform(transform.data());
  const auto* const crs = dataset->GetSpatialRef();
  dem.grid = lattice(width, height, transform, crs != nullptr && crs->IsGeographic() != 0);
  dem.z.resize(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  auto* const band = dataset->GetRasterBand(1);
  if (band->RasterIO(GF_Read, 0, 0, width, height, dem.z.data(), width, height, GDT_Float64, 0, 0) != CE_None) {
    throw std::runtime_error("can't read " + path);
  }
  int has_nodata = 0;
  const double nodata = band->GetNoDataValue(&has_nodata);
  for (double& z : dem.z) {
    if (has_nodata != 0 && z == nodata) z = std::numeric_limits<double>::quiet_NaN();
  }
  return dem;
}

Dem squared(const Dem& dem) {
  constexpr std::int32_t kParts = 1024;
  Dem out = dem;
  auto grid = std::make_shared<SourceGrid>(*dem.grid);
  grid->dx = kParts;
  grid->dy = -kParts;
  grid->x0 = -(grid->width / 2) * grid->dx;
  grid->y0 = -(grid->height / 2) * grid->dy;
  out.grid = std::move(grid);
  return out;
}

Dem enlarged(const Dem& dem, std::int32_t side) {
  Dem out;
  out.name = dem.name + "-" + std::to_string(side);
  auto transform = dem.grid->geotransform;
  transform[1] *= static_cast<double>(dem.width()) / side;
  transform[5] *= static_cast<double>(dem.height()) / side;
  out.grid = lattice(side, side, transform, true);
  const auto at = [&dem](std::int32_t column, std::int32_t row) {
    column = std::clamp(column, 0, dem.width() - 1);
    row = std::clamp(row, 0, dem.height() - 1);
    return dem.z[static_cast<std::size_t>(row) * static_cast<std::size_t>(dem.width()) + static_cast<std::size_t>(column)];
  };
  std::uint32_t noise = 1;
  out.z.reserve(static_cast<std::size_t>(side) * static_cast<std::size_t>(side));
  for (std::int32_t row = 0; row < side; ++row) {
    const double y = static_cast<double>(row) * (dem.height() - 1) / (side - 1);
    for (std::int32_t column = 0; column < side; ++column) {
      const double x = static_cast<double>(column) * (dem.width() - 1) / (side - 1);
      const auto x0 = static_cast<std::int32_t>(x), y0 = static_cast<std::int32_t>(y);
      std::array<double, 4> rows{};
      for (std::int32_t i = 0; i < 4; ++i) {
        rows[static_cast<std::size_t>(i)] =
            cubic({at(x0 - 1, y0 - 1 + i), at(x0, y0 - 1 + i), at(x0 + 1, y0 - 1 + i), at(x0 + 2, y0 - 1 + i)}, x - x0);
      }
      noise = noise * 1664525U + 1013904223U;
      out.z.push_back(std::round(cubic(rows, y - y0) + static_cast<double>(noise >> 16) / 65536 - 0.5));
    }
  }
  return out;
}

void write_png(const std::string& path, std::int32_t width, std::int32_t height, const std::vector<std::uint8_t>& grey) {
  GDALAllRegister();
  auto* const memory = GetGDALDriverManager()->GetDriverByName("MEM");
  auto* const png = GetGDALDriverManager()->GetDriverByName("PNG");
  if (memory == nullptr || png == nullptr) throw std::runtime_error("GDAL writes no PNG here");
  const Dataset picture(memory->Create("", width, height, 1, GDT_Byte, nullptr));
  auto copy = grey;
  if (picture->GetRasterBand(1)->RasterIO(GF_Write, 0, 0, width, height, copy.data(), width, height, GDT_Byte, 0, 0) != CE_None) {
    throw std::runtime_error("can't draw " + path);
  }
  const Dataset written(png->CreateCopy(path.c_str(), picture.get(), 0, nullptr, nullptr, nullptr));
  if (!written) throw std::runtime_error("can't write " + path);
}

}  // namespace bench
