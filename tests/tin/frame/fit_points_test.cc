#include <gtest/gtest.h>

#include <cmath>

#include "tests/tin/frame/scales.h"
#include "tin/frame/frame.h"

namespace tin::frame {
namespace {

using base::Code;

constexpr GroundScale kFeet{false, 0.3048};

void expect_holds(const Frame& frame, const Extent& e) {
  const double half = exact::kLatticeHalf / 2.0;
  EXPECT_GE(frame.x.lattice(e.min_x), -half);
  EXPECT_LE(frame.x.lattice(e.max_x), half);
  EXPECT_GE(frame.y.lattice(e.min_y), -half);
  EXPECT_LE(frame.y.lattice(e.max_y), half);
}

TEST(FitPointsTest, MetresGetMillimetres) {
  const Extent extent{637000.5, 849000.25, 638000.5, 850000.75};
  const Frame frame = fit_points(extent, kMetres, 0, 0).value();
  EXPECT_EQ(frame.x.step(), 0.001);
  EXPECT_EQ(frame.y.step(), 0.001);
  EXPECT_EQ(frame.x.origin, std::round(frame.x.origin)) << "so that decimals stay decimals";
  EXPECT_EQ(frame.x.world(frame.to_lattice(637176.34, 849400.84).value().x), 637176.34);
  expect_holds(frame, extent);
}

TEST(FitPointsTest, FeetGetADecimalStepBelowAMillimetre) {
  const Frame frame = fit_points({637000, 849000, 638000, 850000}, kFeet, 0, 0).value();
  EXPECT_EQ(frame.x.step(), 0.001);
  EXPECT_EQ(frame.y.parts, 1000);
}

TEST(FitPointsTest, DegreesAreStretchedToBeEqualOnTheGround) {
  const Frame frame = fit_points({6.0, 53.5, 6.5, 54.5}, kDegrees, 0, 0).value();
  const DegreeLengths degree = degree_lengths(54);
  EXPECT_NEAR(frame.x.step() * degree.lon_m, frame.y.step() * degree.lat_m, 1e-9);
  EXPECT_NEAR(frame.y.step() * degree.lat_m, 0.001, 0.0002);
}

TEST(FitPointsTest, LargeExtentsGetCoarserSteps) {
  const Extent country{0, 0, 1'000'000, 700'000};
  const Frame frame = fit_points(country, kMetres, 0, 0).value();
  EXPECT_EQ(frame.x.step(), 0.002);
  expect_holds(frame, country);
  const Extent earth{-180, -90, 180, 90};
  const Frame global = fit_points(earth, kDegrees, 0, 0).value();
  expect_holds(global, earth);
  const Extent odd{-7e12, 5e12, 9e12, 9e12};
  expect_holds(fit_points(odd, kMetres, 0, 0).value(), odd);
}

TEST(FitPointsTest, OnePointIsEnough) {
  const Frame frame = fit_points({12.5, 90, 12.5, 90}, kDegrees, 0, 0).value();
  EXPECT_TRUE(frame.to_lattice(12.5, 90).ok());
  EXPECT_TRUE(fit_points({0, 0, 0, 0}, kMetres, 0, 0).ok());
}

TEST(FitPointsTest, TakesTheResolutionThatIsAskedFor) {
  const Frame frame = fit_points({0, 0, 1000, 1000}, kMetres, 0.01, 0.25).value();
  EXPECT_EQ(frame.x, (Axis{500, 1, 100}));
  EXPECT_EQ(frame.y, (Axis{500, 1, 4}));
  const Frame whole = fit_points({0, 0, 1000, 1000}, kMetres, 3, 3).value();
  EXPECT_EQ(whole.x.step(), 3);
  EXPECT_EQ(std::fmod(whole.x.origin, 3), 0);
}

TEST(FitPointsTest, RefusesWhatCannotWork) {
  const Extent kilometre{0, 0, 1000, 1000};
  EXPECT_EQ(fit_points(kilometre, kMetres, 1e-9, 1e-9).error().code, Code::kInvalidValue);
  EXPECT_EQ(fit_points(kilometre, kMetres, -1, -1).error().code, Code::kInvalidValue);
  EXPECT_EQ(fit_points(kilometre, kMetres, 1, 0).error().code, Code::kInvalidValue);
  EXPECT_EQ(fit_points(kilometre, kMetres, std::nan(""), 1).error().code, Code::kInvalidValue);
  EXPECT_EQ(fit_points({0, 0, std::nan(""), 1}, kMetres, 0, 0).error().code, Code::kNotFinite);
  EXPECT_EQ(fit_points({0, 0, INFINITY, 1}, kMetres, 0, 0).error().code, Code::kNotFinite);
  EXPECT_EQ(fit_points({0, 0, 1e300, 1}, kMetres, 0, 0).error().code, Code::kInvalidValue);
  EXPECT_EQ(fit_points({500000, 5e6, 500100, 5.1e6}, kDegrees, 0, 0).error().code, Code::kInvalidValue);
  EXPECT_EQ(fit_points({9e12, 9e12, 9e12 + 1, 9e12 + 1}, kMetres, 0, 0).error().code, Code::kInvalidValue)
      << "doubles cannot tell millimetres apart out there";
}

}  // namespace
}  // namespace tin::frame
