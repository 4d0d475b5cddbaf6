#include "tin/simplify/facet.h"

#include <gmpxx.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/support/point_sets.h"

namespace {

using support::Random;
using tin::exact::Int128;
using tin::exact::kLatticeHalf;
using tin::exact::Point;
using tin::simplify::Facet;
using tin::simplify::floor_product;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

TEST(FloorProductTest, IsTheFloorOfTheExactProduct) {
  Random random(support::seed());
  for (int round = 0; round < 20000; ++round) {
    const double value =
        std::ldexp(static_cast<double>(random() >> 11), static_cast<int>(random() % 120) - 90);
    const auto area = static_cast<std::int64_t>(random() >> (2 + random() % 60));
    const int shift = static_cast<int>(random() % 17);
    const mpq_class exact = mpq_class(value) * mpz_class(static_cast<long>(area)) * (1 << shift);
    mpz_class floor;
    mpz_fdiv_q(floor.get_mpz_t(), exact.get_num_mpz_t(), exact.get_den_mpz_t());
    const Int128 got = floor_product(value, shift, area);
    const mpz_class as_mpz = mpz_class(static_cast<long>(got >> 62)) * (mpz_class(1) << 62) +
                             static_cast<long>(got & ((Int128{1} << 62) - 1));
    EXPECT_EQ(as_mpz, floor > (mpz_class(1) << 120) ? (mpz_class(1) << 120) : floor) << value << " " << area;
  }
  EXPECT_TRUE(floor_product(0, 10, 1234) == 0);
  EXPECT_TRUE(floor_product(std::numeric_limits<double>::max(), 10, 1) == Int128{1} << 120);
  EXPECT_TRUE(floor_product(std::numeric_limits<double>::denorm_min(), 10, 1 << 30) == 0);
}

class FacetTest : public testing::Test {
 protected:
  std::int32_t coordinate(std::int32_t extent) {
    return static_cast<std::int32_t>(random_() % (2 * static_cast<std::uint64_t>(extent))) - extent;
  }
  Random random_{support::seed()};
  testing::ScopedTrace trace_{__FILE__, __LINE__, "TINSMITH_SEED=" + std::to_string(support::seed())};
};

mpq_class exact_error(const Facet::Corner& a, const Facet::Corner& b, const Facet::Corner& c, Point p,
                      double z) {
  const auto cross = [](Point u, Point v, Point w) {
    return mpq_class((mpz_class(v.x) - u.x) * (mpz_class(w.y) - u.y) -
                     (mpz_class(v.y) - u.y) * (mpz_class(w.x) - u.x));
  };
  const mpq_class wa = cross(b.at, c.at, p), wb = cross(c.at, a.at, p), wc = cross(a.at, b.at, p);
  return abs((wa * mpq_class(a.z) + wb * mpq_class(b.z) + wc * mpq_class(c.z)) / (wa + wb + wc) -
             mpq_class(z));
}

TEST_F(FacetTest, JudgesAtTheToleranceAndOneStepBelowExactly) {
  int judged = 0;
  for (int round = 0; round < 60000; ++round) {
    const std::int32_t extent = round % 2 == 0 ? 12 : kLatticeHalf;
    const auto height = [&]() -> double {
      const auto whole = static_cast<double>(random_() % 4000);
      return round % 3 == 0   ? whole
             : round % 3 == 1 ? whole / 10
                              : std::ldexp(whole, static_cast<int>(random_() % 200) - 100);
    };
    const Facet::Corner a{{coordinate(extent), coordinate(extent)}, height()};
    const Facet::Corner b{{coordinate(extent), coordinate(extent)}, height()};
    const Facet::Corner c{{coordinate(extent), coordinate(extent)}, height()};
    if (tin::exact::orientation(a.at, b.at, c.at) == 0) continue;
    const Facet facet(a, b, c);
    const Point p{coordinate(extent), coordinate(extent)};
    const auto weights = facet.weights(p);
    if (!weights) continue;
    const double z = height();
    const mpq_class error = exact_error(a, b, c, p, z);
    const double near = error.get_d();
    for (const double tolerance :
         {near, std::nextafter(near, kInfinity), std::nextafter(near, 0.0), near / 2, near * 2, 0.0}) {
      const auto quick = facet.judge(*weights, z, tolerance),
                 exactly = facet.judge_exactly(*weights, z, tolerance);
      ASSERT_EQ(quick.within, error <= mpq_class(tolerance)) << near << " against " << tolerance;
      ASSERT_EQ(exactly.within, quick.within);
      if (quick.within) {
        ASSERT_LE(quick.error, tolerance);
      }
      ++judged;
    }
  }
  EXPECT_GT(judged, 20000);
}

TEST_F(FacetTest, SurvivesTheLargestAndTheSmallestHeights) {
  const double big = std::numeric_limits<double>::max(), tiny = std::numeric_limits<double>::denorm_min();
  const Facet tall({{0, 0}, big}, {{kLatticeHalf - 1, 0}, -big}, {{0, kLatticeHalf - 1}, big});
  EXPECT_FALSE(tall.judge(*tall.weights({kLatticeHalf - 1, 0}), big, big).within);
  EXPECT_TRUE(tall.judge(*tall.weights({0, 7}), big, 0).within);
  EXPECT_TRUE(std::isfinite(tall.judge(*tall.weights({kLatticeHalf - 1, 0}), big, 0).error));
  const Facet flat({{0, 0}, tiny}, {{2, 0}, 2 * tiny}, {{0, 2}, tiny});
  EXPECT_FALSE(flat.judge(*flat.weights({1, 0}), tiny, 0).within);
  EXPECT_TRUE(flat.judge(*flat.weights({1, 0}), tiny, tiny).within);
}

TEST_F(FacetTest, KnowsTheClosedTriangleForEitherTurn) {
  for (const bool swapped : {false, true}) {
    const Facet::Corner a{{0, 0}, 0}, b{{4, 0}, 0}, c{{0, 4}, 0};
    const Facet facet(a, swapped ? c : b, swapped ? b : c);
    for (std::int32_t x = -1; x <= 5; ++x) {
      for (std::int32_t y = -1; y <= 5; ++y) {
        EXPECT_EQ(facet.weights({x, y}).has_value(), x >= 0 && y >= 0 && x + y <= 4) << x << " " << y;
      }
    }
  }
}

}  // namespace
