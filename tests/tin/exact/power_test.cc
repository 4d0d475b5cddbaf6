// Powers and their order, stage by stage, against GMP.
#include "tin/exact/power.h"

#include <gtest/gtest.h>

#include <functional>
#include <map>

#include "tests/tin/exact/hard_points.h"

namespace {

using exact_tests::hard_points;
using exact_tests::to_mpz;
using tin::exact::compare_by_gmp;
using tin::exact::compare_in_128_bits;
using tin::exact::compare_filtered;
using tin::exact::compare_perturbed;
using tin::exact::Corners;
using tin::exact::lift;
using tin::exact::Lifted;
using tin::exact::make_power;
using tin::exact::orientation;
using tin::exact::Point;
using tin::exact::Power;

class PowerTest : public testing::Test {
 protected:
  /// Two ears whose circles hold p or pass through it; false when the draw was none.
  bool draw() {
    const auto [a, b, c, p] = hard_points(random_);
    const auto [d, e, f, unused] = hard_points(random_);
    left_ = {lift(a, p), lift(b, p), lift(c, p)};
    right_ = {lift(d, p), lift(e, p), lift(f, p)};
    return is_ear(left_) && is_ear(right_);
  }
  static bool is_ear(const Corners& ear) {
    return orientation(ear[0], ear[1], ear[2]) > 0 && in_circle_determinant(ear[0], ear[1], ear[2]) >= 0;
  }

  support::Random random_{support::seed()};
  testing::ScopedTrace trace_{__FILE__, __LINE__, "TINSMITH_SEED=" + std::to_string(support::seed())};
  Corners left_, right_;
};

/// The sign of the difference of two powers, by rational arithmetic.
int gmp_sign(const Power& a, const Power& b) {
  const mpq_class l(to_mpz(a.in_circle), mpz_class(static_cast<long>(a.orientation)));
  const mpq_class r(to_mpz(b.in_circle), mpz_class(static_cast<long>(b.orientation)));
  return cmp(l, r) < 0 ? -1 : cmp(l, r) > 0;
}

/// The sign of the difference of two powers once each lift is raised by its infinitesimal, weights written out.
int gmp_perturbed_sign(const Corners& a, const Corners& b) {
  std::map<std::pair<std::int64_t, std::int64_t>, mpq_class, std::greater<>> weights;
  for (const auto& [ear, factor] : {std::pair{a, 1}, std::pair{b, -1}}) {
    for (std::size_t i = 0; i < 3; ++i) {
      const Lifted &next = ear[(i + 1) % 3], &last = ear[(i + 2) % 3];
      const mpz_class share = factor * (mpz_class(next.x) * last.y - mpz_class(next.y) * last.x);
      mpq_class weight(share, mpz_class(static_cast<long>(orientation(ear[0], ear[1], ear[2]))));
      weight.canonicalize();
      weights[{ear[i].x, ear[i].y}] += weight;
    }
  }
  for (const auto& [corner, weight] : weights) {
    if (weight != 0) return sgn(weight);
  }
  return 0;
}

TEST_F(PowerTest, EachStageAgreesWithGmpOrPassesOn) {
  int filtered = 0, narrow = 0, wide = 0, ties = 0;
  for (int i = 0; i < 400000; ++i) {
    if (!draw()) continue;
    const Power l = power(left_), r = power(right_);
    const int expected = gmp_sign(l, r);
    if (const int sign = compare_filtered(l.approximate, r.approximate); sign != 0) {
      ++filtered;
      ASSERT_EQ(sign, expected);
    }
    if (const auto sign = compare_in_128_bits(l, r)) {
      ++narrow;
      ASSERT_EQ(*sign, expected);
    } else {
      ++wide;
    }
    ASSERT_EQ(compare_by_gmp(l, r), expected);
    if (expected != 0) continue;
    ++ties;
    const int perturbed = compare_perturbed(left_, l.orientation, right_, r.orientation);
    ASSERT_EQ(perturbed, gmp_perturbed_sign(left_, right_));
    ASSERT_EQ(perturbed, -compare_perturbed(right_, r.orientation, left_, l.orientation));
  }
  EXPECT_GT(filtered, 1000);
  EXPECT_GT(narrow, 1000);
  EXPECT_GT(wide, 1000) << "no product needed GMP";
  EXPECT_GT(ties, 10) << "the points met no ties";
}

TEST_F(PowerTest, FilterPassesOnPowersThatDifferInTheLastBit) {
  const Power a = make_power((tin::exact::Int128{1} << 100) + 1, 3), b = make_power(tin::exact::Int128{1} << 100, 3);
  EXPECT_EQ(compare_filtered(a.approximate, b.approximate), 0);
  EXPECT_EQ(compare_in_128_bits(a, b), 1);
  EXPECT_EQ(compare_in_128_bits(b, a), -1);
  EXPECT_EQ(compare_by_gmp(a, b), 1);
  EXPECT_EQ(compare_by_gmp(b, a), -1);
}

TEST_F(PowerTest, ProductsOf185BitsAreComparedByGmp) {
  const tin::exact::Int128 big = (tin::exact::Int128{1} << 124) - 1;
  const std::int64_t wide = (std::int64_t{1} << 61) - 1;
  EXPECT_EQ(compare_in_128_bits(make_power(big, wide), make_power(big - 1, wide)), std::nullopt);
  EXPECT_EQ(compare_by_gmp(make_power(big, wide), make_power(big - 1, wide)), 1);
  EXPECT_EQ(compare_by_gmp(make_power(big, wide), make_power(big, wide - 1)), -1);
  EXPECT_EQ(compare_by_gmp(make_power(big, wide), make_power(big, wide)), 0);
}

TEST_F(PowerTest, The128BitStageAnswersUpToItsLimitAndPassesOnOnePast) {
  using tin::exact::Int128;
  const Int128 wide = (Int128{1} << 66) - 1;  // 66 bits
  const std::int64_t narrow = (std::int64_t{1} << 61) - 1, at_limit = (std::int64_t{1} << 62) - 1;
  EXPECT_EQ(compare_in_128_bits(make_power(wide, narrow), make_power(wide, at_limit)), 1);
  EXPECT_EQ(compare_in_128_bits(make_power(wide + 1, narrow), make_power(wide, at_limit)), std::nullopt);
  EXPECT_EQ(compare_in_128_bits(make_power(wide, at_limit), make_power(wide + 1, narrow)), std::nullopt);
  EXPECT_EQ(compare_by_gmp(make_power(wide + 1, narrow), make_power(wide, at_limit)), 1);
}

/// The stages, each with the sign it gives, 0 where it passes on.
TEST_F(PowerTest, EachStageIsAntisymmetricAndTransitiveOnNearlyEqualPowers) {
  const std::array stages{
      std::function([](const Power& a, const Power& b) { return compare_filtered(a.approximate, b.approximate); }),
      std::function([](const Power& a, const Power& b) { return compare_in_128_bits(a, b).value_or(0); }),
      std::function([](const Power& a, const Power& b) { return compare_by_gmp(a, b); })};
  std::array<int, 3> answers{};
  std::uniform_int_distribution<int> shift(0, 60), nudge(-2, 2);
  for (int i = 0; i < 100000; ++i) {
    const int in_circle_shift = shift(random_), orientation_shift = shift(random_) / 2;
    const auto near = [&] {
      const tin::exact::Int128 in_circle = (tin::exact::Int128{3} << (in_circle_shift + 2)) + nudge(random_);
      return make_power(in_circle, (std::int64_t{5} << (orientation_shift + 2)) + nudge(random_));
    };
    const Power a = near(), b = near(), c = near();
    for (std::size_t s = 0; s < stages.size(); ++s) {
      const auto& sign = stages[s];
      ASSERT_EQ(sign(a, b), -sign(b, a)) << "stage " << s;
      ASSERT_EQ(sign(a, a), 0) << "stage " << s;
      answers[s] += sign(a, b) != 0;
      if (sign(a, b) < 0 && sign(b, c) < 0) {
        ASSERT_NE(sign(a, c), 1) << "stage " << s;
      }
    }
    // Where an earlier stage answers, a later one says the same.
    for (const std::size_t earlier : {0U, 1U}) {
      if (const int sign = stages[earlier](a, b); sign != 0) {
        ASSERT_EQ(sign, compare_by_gmp(a, b));
      }
    }
  }
  for (const int count : answers) EXPECT_GT(count, 1000);
}

TEST_F(PowerTest, MinorsGiveTheSameDeterminantForEveryThirdCorner) {
  for (int i = 0; i < 200000; ++i) {
    const auto [a, b, c, p] = hard_points(random_);
    const Lifted u = lift(a, p), v = lift(b, p), w = lift(c, p);
    EXPECT_EQ(to_mpz(in_circle_determinant(power_minors(u, v), w)), to_mpz(in_circle_determinant(u, v, w)));
  }
}

TEST_F(PowerTest, TheOrderIsTransitive) {
  const auto compare = [](const Corners& a, const Corners& b) {
    const Power l = power(a), r = power(b);
    const int sign = compare_by_gmp(l, r);
    return sign != 0 ? sign : compare_perturbed(a, l.orientation, b, r.orientation);
  };
  std::uniform_int_distribution<std::int32_t> small(-2, 2);
  int chains = 0;
  for (int i = 0; i < 400000; ++i) {
    std::array<Corners, 3> ears;
    for (auto& ear : ears) {
      for (auto& corner : ear) corner = lift({small(random_), small(random_)}, {0, 0});
    }
    if (!is_ear(ears[0]) || !is_ear(ears[1]) || !is_ear(ears[2])) continue;
    if (compare(ears[0], ears[1]) > 0 || compare(ears[1], ears[2]) > 0) continue;
    ++chains;
    EXPECT_LE(compare(ears[0], ears[2]), 0);
  }
  EXPECT_GT(chains, 1000);
}

}  // namespace
