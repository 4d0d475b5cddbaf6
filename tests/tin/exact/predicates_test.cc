#include <gmpxx.h>
#include <gtest/gtest.h>

#include "tests/support/point_sets.h"
#include "tin/exact/power.h"
#include "tin/exact/predicates.h"

namespace {

using support::Random;
using tin::exact::ear_power;
using tin::exact::in_circle;
using tin::exact::in_circle_determinant;
using tin::exact::kLatticeHalf;
using tin::exact::orientation;
using tin::exact::Point;

/// Four points, often nearly or exactly co-circular or collinear, at every scale of the lattice.
std::array<Point, 4> hard_points(Random& random) {
  std::uniform_int_distribution<std::int32_t> pick(0, 3), wide(-kLatticeHalf, kLatticeHalf - 1), small(-3, 3);
  std::array<Point, 4> p;
  switch (pick(random)) {
    case 0:
      for (Point& q : p) q = {wide(random), wide(random)};
      break;
    case 1:
      for (Point& q : p) q = {small(random), small(random)};
      break;
    case 2: {  // corners of a square at the lattice's limits, nudged
      const std::int32_t h = kLatticeHalf - 4;
      p = {Point{-h, -h}, Point{h, -h}, Point{h, h}, Point{-h, h}};
      for (Point& q : p) q = {q.x + small(random), q.y + small(random)};
      break;
    }
    default:
      for (std::int32_t i = 0; i < 4; ++i) p[static_cast<std::size_t>(i)] = {i * 1000003 + small(random), i * 999983 + small(random)};
  }
  return p;
}

mpz_class exact_in_circle(Point a, Point b, Point c, Point p) {
  const auto row = [p](Point q) { return std::array<mpz_class, 2>{mpz_class(q.x) - p.x, mpz_class(q.y) - p.y}; };
  const auto [ax, ay] = row(a);
  const auto [bx, by] = row(b);
  const auto [cx, cy] = row(c);
  return (ax * ax + ay * ay) * (bx * cy - by * cx) - (bx * bx + by * by) * (ax * cy - ay * cx) +
         (cx * cx + cy * cy) * (ax * by - ay * bx);
}

mpz_class to_mpz(tin::exact::Int128 value) {
  const bool negative = value < 0;
  const auto magnitude = negative ? -static_cast<tin::exact::Uint128>(value) : static_cast<tin::exact::Uint128>(value);
  mpz_class out = (mpz_class(static_cast<unsigned long>(magnitude >> 64)) << 64) + static_cast<unsigned long>(magnitude);
  return negative ? mpz_class(-out) : out;
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

/// Ears of random convex polygons around p: the power comparison at each stage against GMP.
TEST_F(PredicatesTest, PowerComparisonAgreesWithGmpAtEveryStage) {
  int ties = 0;
  for (int i = 0; i < 400000; ++i) {
    const auto [a, b, c, p] = hard_points(random_);
    const auto [d, e, f, unused] = hard_points(random_);
    if (orientation(a, b, c) <= 0 || orientation(d, e, f) <= 0) continue;
    if (in_circle_determinant(a, b, c, p) < 0 || in_circle_determinant(d, e, f, p) < 0) continue;
    const auto left = ear_power(a, b, c, p), right = ear_power(d, e, f, p);
    const mpz_class l = to_mpz(left.in_circle) * mpz_class(static_cast<long>(right.orientation));
    const mpz_class r = to_mpz(right.in_circle) * mpz_class(static_cast<long>(left.orientation));
    EXPECT_EQ(tin::exact::internal::compare_exact(left, right), cmp(l, r) < 0 ? -1 : cmp(l, r) > 0);
    if (l != r) {
      EXPECT_EQ(comes_before(left, right, p), l < r);
    }
    if (l == r && left.corners != right.corners) {
      ++ties;
      EXPECT_EQ(tin::exact::internal::compare_perturbed(left, right, p), -tin::exact::internal::compare_perturbed(right, left, p));
    }
  }
  EXPECT_GT(ties, 10) << "the points met no ties";
}

}  // namespace
