#include <gtest/gtest.h>

#include "tests/tin/exact/hard_points.h"
#include "tin/exact/predicates.h"

namespace {

using support::Random;
using tin::exact::in_circle;
using tin::exact::in_circle_determinant;
using tin::exact::kLatticeHalf;
using tin::exact::orientation;
using tin::exact::Point;
using exact_tests::hard_points;
using exact_tests::to_mpz;

mpz_class exact_in_circle(Point a, Point b, Point c, Point p) {
  const auto row = [p](Point q) { return std::array<mpz_class, 2>{mpz_class(q.x) - p.x, mpz_class(q.y) - p.y}; };
  const auto [ax, ay] = row(a);
  const auto [bx, by] = row(b);
  const auto [cx, cy] = row(c);
  return (ax * ax + ay * ay) * (bx * cy - by * cx) - (bx * bx + by * by) * (ax * cy - ay * cx) +
         (cx * cx + cy * cy) * (ax * by - ay * bx);
}

class PredicatesTest : public testing::Test {
 protected:
  PredicatesTest() { RecordProperty("seed", std::to_string(support::seed())); }
  Random random_{support::seed()};
  testing::ScopedTrace trace_{__FILE__, __LINE__, "TINSMITH_SEED=" + std::to_string(support::seed())};
};

TEST_F(PredicatesTest, OrientationIsAntisymmetricAndCyclic) {
  for (int i = 0; i < 100000; ++i) {
    const auto [a, b, c, d] = hard_points(random_);
    EXPECT_EQ(orientation(a, b, c), orientation(b, c, a));
    EXPECT_EQ(orientation(a, b, c), -orientation(b, a, c));
    EXPECT_EQ(orientation(a, b, c), orientation(a, b, d) + orientation(b, c, d) + orientation(c, a, d));
  }
}

TEST_F(PredicatesTest, InCircleDeterminantEqualsGmps) {
  for (int i = 0; i < 100000; ++i) {
    const auto [a, b, c, d] = hard_points(random_);
    EXPECT_EQ(to_mpz(in_circle_determinant(a, b, c, d)), exact_in_circle(a, b, c, d));
  }
}

TEST_F(PredicatesTest, InCircleHoldsAtTheLatticesCorners) {
  const std::int32_t low = -kLatticeHalf, high = kLatticeHalf - 1;
  EXPECT_EQ(in_circle_determinant({low, low}, {high, low}, {high, high}, {low, high}), 0);
  EXPECT_GT(in_circle_determinant({low, low}, {high, low}, {high, high}, {low + 1, high - 1}), 0);
  EXPECT_EQ(to_mpz(in_circle_determinant({low, low}, {high, low}, {low, high}, {high, low + 1})),
            exact_in_circle({low, low}, {high, low}, {low, high}, {high, low + 1}));
}

TEST_F(PredicatesTest, ExactlyOneDiagonalOfAConvexQuadrilateralIsDelaunay) {
  int co_circular = 0;
  for (int i = 0; i < 100000; ++i) {
    const auto [a, b, c, d] = hard_points(random_);
    if (orientation(a, b, c) <= 0 || orientation(a, c, d) <= 0 || orientation(b, c, d) <= 0 || orientation(a, b, d) <= 0) continue;
    co_circular += in_circle_determinant(a, b, c, d) == 0;
    EXPECT_EQ(in_circle(a, b, c, d), in_circle(c, d, a, b));
    EXPECT_NE(in_circle(a, b, c, d), in_circle(b, c, d, a));
    EXPECT_EQ(in_circle(a, b, c, d), in_circle(b, c, a, d));
  }
  EXPECT_GT(co_circular, 100) << "the points met no ties";
}

TEST_F(PredicatesTest, LargestOfFourCocircularPointsCountsAsOutside) {
  EXPECT_FALSE(in_circle({0, 0}, {1, 0}, {0, 1}, {1, 1}));
  EXPECT_TRUE(in_circle({0, 0}, {1, 0}, {1, 1}, {0, 1}));
}

}  // namespace
