#include "tests/bench/fractal.h"

#include <gdal_priv.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <memory>
#include <stdexcept>
#include <vector>

namespace bench {

namespace {

struct Closer {
  void operator()(GDALDataset* dataset) const { GDALClose(dataset); }
};
using Dataset = std::unique_ptr<GDALDataset, Closer>;

constexpr std::int32_t kCoarsest = 2048, kFinest = 4;  // pixels between the knots of an octave
constexpr double kRelief_m = 1500, kRoughness = 0.9, kShift_m = 250;

/// -1..1, by splitmix64.
double knot(std::uint64_t seed, std::int32_t octave, std::int32_t column, std::int32_t row) {
  std::uint64_t x = seed + static_cast<std::uint64_t>(octave) * 0x9e3779b97f4a7c15U +
                    static_cast<std::uint64_t>(column) * 0xbf58476d1ce4e5b9U +
                    static_cast<std::uint64_t>(row) * 0x94d049bb133111ebU;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9U;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebU;
  x ^= x >> 31;
  return static_cast<double>(x >> 11) * 0x1p-52 - 1;
}

double smooth(double t) {
  return t * t * (3 - 2 * t);
}

void add_octave(std::uint64_t seed, std::int32_t octave, std::int32_t spacing, std::int32_t row,
                std::vector<double>& heights) {
  const double amplitude = kRelief_m * std::pow(static_cast<double>(spacing) / kCoarsest, kRoughness);
  const std::int32_t above = row / spacing;
  const double down = smooth(static_cast<double>(row % spacing) / spacing);
  const auto at = [&](std::int32_t column) {
    return amplitude *
           std::lerp(knot(seed, octave, column, above), knot(seed, octave, column, above + 1), down);
  };
  const auto side = static_cast<std::int32_t>(heights.size());
  double left = at(0), right = at(1);
  for (std::int32_t first = 0, column = 0; first < side; first += spacing, ++column) {
    const std::int32_t count = std::min(spacing, side - first);
    for (std::int32_t i = 0; i < count; ++i) {
      heights[static_cast<std::size_t>(first + i)] +=
          left + (right - left) * smooth(static_cast<double>(i) / spacing);
    }
    left = right;
    right = at(column + 2);
  }
}

}  // namespace

void write_fractal(const std::string& path, std::int32_t side, std::uint64_t seed) {
  GDALAllRegister();
  auto* const driver = GetGDALDriverManager()->GetDriverByName("GTiff");
  char* options[] = {const_cast<char*>("TILED=YES"), const_cast<char*>("COMPRESS=DEFLATE"),
                     const_cast<char*>("ZLEVEL=1"), const_cast<char*>("PREDICTOR=2"), nullptr};
  const std::string part = path + ".part.tif";
  Dataset file(driver == nullptr ? nullptr : driver->Create(part.c_str(), side, side, 1, GDT_Int16, options));
  if (!file) throw std::runtime_error("can't write " + part);
  std::array<double, 6> transform{500000, 30, 0, 5000000, 0, -30};
  bool good = file->SetGeoTransform(transform.data()) == CE_None;
  std::vector<double> heights(static_cast<std::size_t>(side));
  std::vector<std::int16_t> row_out(heights.size());
  for (std::int32_t row = 0; row < side && good; ++row) {
    std::fill(heights.begin(), heights.end(), kShift_m);
    for (std::int32_t octave = 0, spacing = kCoarsest; spacing >= kFinest; ++octave, spacing /= 2) {
      add_octave(seed, octave, spacing, row, heights);
    }
    std::transform(heights.begin(), heights.end(), row_out.begin(), [](double z) {
      return static_cast<std::int16_t>(std::lround(std::clamp(z, 0.0, 9000.0)));
    });
    good = file->GetRasterBand(1)->RasterIO(GF_Write, 0, row, side, 1, row_out.data(), side, 1, GDT_Int16, 0,
                                            0) == CE_None;
  }
  file.reset();
  if (!good) throw std::runtime_error("can't write " + part);
  std::filesystem::rename(part, path);
}

}  // namespace bench
