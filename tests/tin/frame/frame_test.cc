#include "tin/frame/frame.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace tin::frame {
namespace {

TEST(FrameTest, SnapsToTheNearestLatticePoint) {
  Frame frame;
  frame.x.origin = 500000;
  const auto at = frame.to_lattice(500001.2345, -12.0004);
  ASSERT_TRUE(at.ok());
  EXPECT_EQ(at->x, 1235);
  EXPECT_EQ(at->y, -12000);
  EXPECT_EQ(frame.x.world(at->x), 500001.235);
  EXPECT_EQ(frame.y.world(at->y), -12.0);
}

TEST(FrameTest, RefusesWhatIsNotFinite) {
  const Frame frame;
  for (const double bad : {std::nan(""), std::numeric_limits<double>::infinity()}) {
    EXPECT_EQ(frame.to_lattice(bad, 0).error().code, base::Code::kNotFinite);
    EXPECT_EQ(frame.to_lattice(0, -bad).error().code, base::Code::kNotFinite);
  }
}

TEST(FrameTest, HoldsTheWholeLatticeAndNothingOutside) {
  Frame frame;
  frame.x = frame.y = {0, 1, 1};
  const double half = exact::kLatticeHalf;
  EXPECT_EQ(frame.to_lattice(-half, half - 1).value(),
            (exact::Point{-exact::kLatticeHalf, exact::kLatticeHalf - 1}));
  EXPECT_EQ(frame.to_lattice(half - 0.6, 0).value().x, exact::kLatticeHalf - 1);
  EXPECT_EQ(frame.to_lattice(half - 0.4, 0).error().code, base::Code::kOutsideLattice);
  EXPECT_EQ(frame.to_lattice(0, half).error().code, base::Code::kOutsideLattice);
  EXPECT_EQ(frame.to_lattice(0, -half - 0.6).error().code, base::Code::kOutsideLattice);
  EXPECT_EQ(frame.to_lattice(1e308, -1e308).error().code, base::Code::kOutsideLattice);
}

TEST(GeodesyTest, DegreeLengthsAreThoseOfTheEllipsoid) {
  const DegreeLengths equator = degree_lengths(0);
  EXPECT_NEAR(equator.lon_m, 111319.4908, 1e-4);
  EXPECT_NEAR(equator.lat_m, 110574.2758, 1e-4);
  const DegreeLengths north = degree_lengths(54);
  EXPECT_NEAR(north.lon_m, 65575.77, 0.01);  // by the usual cosine series
  EXPECT_NEAR(north.lat_m, 111305.0, 0.01);
  EXPECT_EQ(degree_lengths(90).lon_m, degree_lengths(89).lon_m);
  EXPECT_GT(degree_lengths(-90).lon_m, 1000);
}

}  // namespace
}  // namespace tin::frame
