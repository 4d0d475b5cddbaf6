#include "tests/tin/removal/heller.h"

#include <iostream>

#include "tests/tin/removal/fixture.h"

namespace {

using removal_tests::heller_fill;
using removal_tests::RemovalTest;
using removal_tests::triples;
using tin::delaunay::Triangulation;
using tin::exact::Point;

/// The situation of the paper's figure 2, found by the search below and written down: five points around the origin.
TEST_F(RemovalTest, SmallestCircleIsNotADelaunayEarAsInFigure2) {
  const std::array<Point, 5> ring{Point{-9, 6}, {-8, 4}, {-12, 1}, {7, -5}, {5, -3}};
  Triangulation t;
  for (const Point p : ring) t.insert(p);
  star_.gather(t.mesh(), t.insert({0, 0}).vertex);
  ASSERT_EQ(star_.degree(), 5U);
  const auto wrong = heller_fill(star_);
  const auto right = methods_.front()->fill(star_);
  EXPECT_NE(triples(wrong), triples(right));
  // Its first ear has the smallest circle of all, and a fourth point in it.
  const auto [a, b, c] = wrong.front();
  int inside = 0;
  for (std::uint32_t i = 0; i < star_.degree(); ++i) {
    if (i != a && i != b && i != c) {
      inside += tin::exact::in_circle_determinant(star_.at(a), star_.at(b), star_.at(c), star_.at(i)) > 0;
    }
  }
  EXPECT_GT(inside, 0);
  ASSERT_NO_FATAL_FAILURE(expect_all_agree(t.mesh(), vertex_at(t, {0, 0})));
  EXPECT_EQ(removal_tests::broken(t.mesh()), "");
}

TEST_F(RemovalTest, HellersRuleGoesWrongOnRandomStarsAndOursDoesNot) {
  int stars = 0, wrong = 0;
  Triangulation t;
  std::vector<tin::mesh::VertexSlot> slots;
  t.insert_many(support::random_points(random_, 20000, 1 << 24), slots);
  for (const auto v : slots) {
    star_.gather(t.mesh(), v);
    if (star_.is_on_hull()) continue;
    ++stars;
    wrong += triples(heller_fill(star_)) != triples(methods_.front()->fill(star_));
  }
  std::cout << "Heller's rule is wrong on " << wrong << " of " << stars << " random stars\n";
  EXPECT_GT(wrong, stars / 1000);
  EXPECT_LT(wrong, stars / 5);
}

}  // namespace
