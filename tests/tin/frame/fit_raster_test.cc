#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>

#include "tests/tin/frame/scales.h"
#include "tin/frame/frame.h"

namespace tin::frame {
namespace {

using base::Code;

constexpr GroundScale kSurveyFeet{false, 1200.0 / 3937};

/// Every pixel centre (or a sample of rows and columns of large rasters), computed as its file gives it,
/// snaps to the lattice point that column and row give, both ways.
void expect_exact(const RasterShape& raster, const Frame& frame) {
  const std::int64_t step_c = std::max<std::int64_t>(1, raster.width / 500);
  const std::int64_t step_r = std::max<std::int64_t>(1, raster.height / 500);
  for (std::int64_t r = 0; r < raster.height; r += step_r) {
    for (std::int64_t c = 0; c < raster.width; c += step_c) {
      const double x = raster.x0 + static_cast<double>(c) * raster.pixel_x;
      const double y = raster.y0 - static_cast<double>(r) * raster.pixel_y;
      const exact::Point want{static_cast<std::int32_t>((c - raster.width / 2) * frame.x.parts),
                              static_cast<std::int32_t>((raster.height / 2 - r) * frame.y.parts)};
      ASSERT_EQ(frame.to_lattice(x, y).value(), want) << "column " << c << ", row " << r;
      ASSERT_EQ(frame.to_lattice(frame.x.world(want.x), frame.y.world(want.y)).value(), want);
      ASSERT_LE(std::abs(want.x), exact::kLatticeHalf / 2);
      ASSERT_LE(std::abs(want.y), exact::kLatticeHalf / 2);
    }
  }
}

Frame fitted(const RasterShape& raster, const GroundScale& scale) {
  auto frame = fit_raster(raster, scale);
  EXPECT_TRUE(frame.ok()) << frame.error().message;
  expect_exact(raster, frame.value());
  return std::move(frame).value();
}

TEST(FitRasterTest, ProjectedPixelsAreWholeMillimetres) {
  const Frame frame = fitted({557820, 5121990, 30, 30, 327, 468}, kMetres);
  EXPECT_EQ(frame.x.parts, 30000);
  EXPECT_EQ(frame.y.parts, 30000);
  EXPECT_EQ(frame.x.origin, 557820 + 163 * 30.0);
}

TEST(FitRasterTest, PixelsOfUnevenSizeStayExact) {
  const Frame frame = fitted({288776.3, 9120760.8, 89.9940673, 89.9940673, 111, 111}, kMetres);
  EXPECT_NEAR(frame.x.step(), 0.001, 1e-8);
  const Frame oblong = fitted({1.25, 7.5, 25, 10, 40, 60}, kMetres);
  EXPECT_EQ(oblong.x.step(), oblong.y.step());
}

TEST(FitRasterTest, FeetAreMeasuredOnTheGround) {
  const Frame frame = fitted({1'300'000.5, 600'000.5, 3, 3, 1000, 1000}, kSurveyFeet);
  EXPECT_NEAR(frame.x.step() * 1200 / 3937, 0.001, 1e-6);
}

TEST(FitRasterTest, DegreesAreEqualOnTheGround) {
  const double second = 1.0 / 3600;
  const RasterShape srtm{-72, 45, 3 * second, 3 * second, 1201, 1201};
  const Frame frame = fitted(srtm, kDegrees);
  const DegreeLengths degree = degree_lengths(44.5);
  EXPECT_NEAR(frame.x.step() * degree.lon_m, 0.001, 1e-7);
  EXPECT_NEAR(frame.y.step() * degree.lat_m, 0.001, 1e-7);
  EXPECT_LT(frame.x.parts, frame.y.parts);
}

TEST(FitRasterTest, HugeRastersGetCoarserStepsAndStayExact) {
  const double half_minute = 1.0 / 120;
  fitted({-180 + half_minute / 2, 90 - half_minute / 2, half_minute, half_minute, 43200, 21600}, kDegrees);
  fitted({-180, 90, 0.25, 0.25, 1440, 721}, kDegrees);  // centres on both poles
  fitted({0, 0, 1000, 1000, 100'000, 50'000}, kMetres);
  fitted({-9e6, 9e6, 5e8, 5e8, 1, 1}, kMetres);
}

TEST(FitRasterTest, TinyAndThinRastersWork) {
  fitted({0, 0, 1, 1, 1, 1}, kMetres);
  fitted({10, 10, 2, 2, 1, 1000}, kMetres);
  fitted({10, 10, 2, 2, 1000, 1}, kMetres);
  fitted({0.5, 0.5, 1e-5, 1e-5, 300, 300}, kMetres);  // pixels below the lattice's millimetre
  const Frame frame = fitted({0, 0, 0.0004, 0.0004, 50, 2}, kMetres);
  EXPECT_EQ(frame.x.parts, 1);
}

TEST(FitRasterTest, TakesTheResolutionThatIsAskedFor) {
  const RasterShape raster{557820, 5121990, 30, 30, 327, 468};
  const Frame frame = fit_raster(raster, kMetres, 0.01, 0.01).value();
  EXPECT_EQ(frame.x.parts, 3000);
  expect_exact(raster, frame);
  EXPECT_EQ(fit_raster(raster, kMetres, 100, 100).value().x.parts, 1) << "a pixel is the coarsest step";
  EXPECT_EQ(fit_raster(raster, kMetres, 1e-6, 1e-6).error().code, Code::kInvalidValue);
  EXPECT_EQ(fit_raster(raster, kMetres, 0.01, 0).error().code, Code::kInvalidValue);
}

TEST(FitRasterTest, RefusesWhatNoLatticeHolds) {
  const auto code = [](const RasterShape& raster, const GroundScale& scale = kMetres) {
    auto frame = fit_raster(raster, scale);
    return frame.ok() ? Code::kInternal : frame.error().code;
  };
  EXPECT_EQ(code({0, 0, 1, 1, 0, 5}), Code::kInvalidValue);
  EXPECT_EQ(code({0, 0, 0, 1, 5, 5}), Code::kInvalidValue);
  EXPECT_EQ(code({0, 0, 1, std::nan(""), 5, 5}), Code::kInvalidValue);
  EXPECT_EQ(code({std::nan(""), 0, 1, 1, 5, 5}), Code::kNotFinite);
  EXPECT_EQ(code({0, INFINITY, 1, 1, 5, 5}), Code::kNotFinite);
  EXPECT_EQ(code({0, 0, 1, 1, std::int64_t{1} << 40, 1}), Code::kInvalidValue);
  EXPECT_EQ(code({0, 0, 1e-9, 1000, 1000, 1000}), Code::kInvalidValue) << "a billion parts per pixel";
  EXPECT_EQ(code({5e6, 5e6, 1e-12, 1e-12, 10, 10}), Code::kInvalidValue) << "indistinguishable as doubles";
  EXPECT_EQ(code({500000, 5e6, 30, 30, 10, 10}, kDegrees), Code::kInvalidValue) << "metres taken for degrees";
}

}  // namespace
}  // namespace tin::frame
