// The side of a plane through lifted points: equal to the in-circle test where that is defined, and lawful beyond.
#include "tin/exact/lifted.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <span>

#include "tests/tin/exact/hard_points.h"

namespace {

using exact_tests::hard_points;
using exact_tests::to_mpz;
using tin::exact::in_circle;
using tin::exact::in_circle_determinant;
using tin::exact::kLatticeHalf;
using tin::exact::lift;
using tin::exact::Lifted;
using tin::exact::lifted_sign;
using tin::exact::orientation;
using tin::exact::Point;

class LiftedTest : public testing::Test {
 protected:
  support::Random random_{support::seed()};
  testing::ScopedTrace trace_{__FILE__, __LINE__, "TINSMITH_SEED=" + std::to_string(support::seed())};
};

bool are_distinct(std::span<const Point> points) {
  return std::set<Point>(points.begin(), points.end()).size() == points.size();
}

TEST_F(LiftedTest, DeterminantDoesNotDependOnTheOrigin) {
  for (int i = 0; i < 100000; ++i) {
    const auto [a, b, c, d] = hard_points(random_);
    const auto [o, unused, unused_too, unused_as_well] = hard_points(random_);
    EXPECT_EQ(to_mpz(in_circle_determinant(lift(a, o), lift(b, o), lift(c, o), lift(d, o))),
              to_mpz(in_circle_determinant(a, b, c, d)));
    EXPECT_EQ(orientation(lift(a, o), lift(b, o), lift(c, o)), orientation(a, b, c));
  }
}

TEST_F(LiftedTest, DeterminantHoldsAtTheLatticesCorners) {
  const std::int32_t low = -kLatticeHalf, high = kLatticeHalf - 1;
  const std::array<Point, 5> corners{Point{low, low}, {high, low}, {high, high}, {low, high}, {high, low + 1}};
  for (const Point a : corners) {
    for (const Point b : corners) {
      for (const Point c : corners) {
        for (const Point o : corners) {
          EXPECT_EQ(to_mpz(in_circle_determinant(lift(a, o), lift(b, o), lift(c, o), lift({0, 0}, o))),
                    to_mpz(in_circle_determinant(a, b, c, {0, 0})));
        }
      }
    }
  }
}

TEST_F(LiftedTest, EqualsTheInCircleTestForCounterClockwiseTriples) {
  int ties = 0;
  for (int i = 0; i < 300000; ++i) {
    const auto p = hard_points(random_);
    const auto [a, b, c, d] = p;
    if (orientation(a, b, c) <= 0 || !are_distinct(p)) continue;
    ties += in_circle_determinant(a, b, c, d) == 0;
    EXPECT_EQ(lifted_sign(lift(a, c), lift(b, c), lift(c, c), lift(d, c)) > 0, in_circle(a, b, c, d));
  }
  EXPECT_GT(ties, 100) << "the points met no ties";
}

TEST_F(LiftedTest, AlternatesInAllArguments) {
  for (int i = 0; i < 100000; ++i) {
    const auto p = hard_points(random_);
    if (!are_distinct(p)) continue;
    const Lifted a = lift(p[0], p[1]), b = lift(p[1], p[1]), c = lift(p[2], p[1]), d = lift(p[3], p[1]);
    EXPECT_EQ(lifted_sign(a, b, c, d), -lifted_sign(b, a, c, d));
    EXPECT_EQ(lifted_sign(a, b, c, d), -lifted_sign(a, c, b, d));
    EXPECT_EQ(lifted_sign(a, b, c, d), -lifted_sign(a, b, d, c));
  }
}

/// Signs that come from points in space obey the Grassmann-Pluecker relations: of three products whose sum is zero not all
/// have one sign. So the tie rule, four collinear points included, is that of some motion of the points, and what is
/// true of points in general position is true of ours.
TEST_F(LiftedTest, TiesAreBrokenAsIfThePointsHadMoved) {
  std::uniform_int_distribution<std::int32_t> small(0, 4);
  int collinear = 0;
  for (int i = 0; i < 300000; ++i) {
    std::array<Point, 6> p;
    for (Point& q : p) q = {small(random_), i % 3 == 0 ? q.x : small(random_) / (1 + i % 3)};
    if (!are_distinct(p)) continue;
    std::array<Lifted, 6> l;
    for (std::size_t j = 0; j < 6; ++j) l[j] = lift(p[j], p[0]);
    const auto sign = [&l](int a, int b, int c, int d) {
      const auto at = [&l](int k) { return l[static_cast<std::size_t>(k)]; };
      return lifted_sign(at(a), at(b), at(c), at(d));
    };
    collinear += orientation(p[0], p[1], p[2]) == 0 && orientation(p[0], p[1], p[3]) == 0;
    const int first = sign(0, 1, 2, 3) * sign(0, 1, 4, 5);
    const int second = -sign(0, 1, 2, 4) * sign(0, 1, 3, 5);
    const int third = sign(0, 1, 2, 5) * sign(0, 1, 3, 4);
    EXPECT_FALSE(first == second && second == third);
  }
  EXPECT_GT(collinear, 1000) << "the points met no lines";
}

}  // namespace
