#include "tin/simplify/spans.h"

#include <gtest/gtest.h>

#include <set>
#include <utility>

#include "tests/support/point_sets.h"

namespace {

using tin::simplify::GridPoint;
using tin::simplify::visit_spans;

std::int64_t turn(GridPoint a, GridPoint b, GridPoint c) {
  return (std::int64_t{b.x} - a.x) * (std::int64_t{c.y} - a.y) -
         (std::int64_t{b.y} - a.y) * (std::int64_t{c.x} - a.x);
}

bool holds(GridPoint a, GridPoint b, GridPoint c, GridPoint p) {
  if (turn(a, b, c) < 0) std::swap(b, c);
  return turn(a, b, p) >= 0 && turn(b, c, p) >= 0 && turn(c, a, p) >= 0;
}

TEST(SpansTest, VisitTheCellsOfTheClosedTriangleOnceInOrder) {
  SCOPED_TRACE("TINSMITH_SEED=" + std::to_string(support::seed()));
  support::Random random(support::seed());
  for (int round = 0; round < 3000; ++round) {
    const int size = 2 + round % 17;
    const auto draw = [&] {
      return GridPoint{static_cast<std::int32_t>(random() % static_cast<unsigned>(size)) - 5,
                       static_cast<std::int32_t>(random() % static_cast<unsigned>(size)) - 5};
    };
    const GridPoint a = draw(), b = draw(), c = draw();
    if (turn(a, b, c) == 0) continue;
    std::set<std::pair<int, int>> seen, expected;
    std::int32_t last_row = -100;
    visit_spans(a, b, c, [&](std::int32_t row, std::int32_t first, std::int32_t last) {
      EXPECT_GT(row, last_row);
      EXPECT_LE(first, last);
      last_row = row;
      for (std::int32_t column = first; column <= last; ++column) seen.insert({column, row});
      return true;
    });
    for (std::int32_t x = -6; x < 20; ++x) {
      for (std::int32_t y = -6; y < 20; ++y) {
        if (holds(a, b, c, {x, y})) expected.insert({x, y});
      }
    }
    ASSERT_EQ(seen, expected) << a.x << "," << a.y << " " << b.x << "," << b.y << " " << c.x << "," << c.y;
  }
}

TEST(SpansTest, StopWhenTold) {
  int rows = 0;
  visit_spans({0, 0}, {9, 0}, {0, 9}, [&](auto, auto, auto) { return ++rows < 3; });
  EXPECT_EQ(rows, 3);
}

}  // namespace
