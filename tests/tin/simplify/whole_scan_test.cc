// The scans of whole heights, four cells at a time where the processor can, in integers, and past whole squares of cells, against
// each other and against a plain search.
#include "tin/simplify/whole_scan.h"

#include <gtest/gtest.h>

#include <array>
#include <cstdlib>
#include <vector>

#include "tests/support/point_sets.h"
#include "tin/simplify/block_scan.h"

namespace {

using support::Random;
using tin::simplify::Blocks;
using tin::simplify::GridPoint;
using tin::simplify::WholeHeights;
using tin::simplify::WholePlane;
using tin::simplify::WorstCell;

constexpr std::int32_t kColumns = 83, kRows = 90;

class WholeScanTest : public testing::Test {
 protected:
  WholeScanTest() : cells_(kColumns * kRows + WholeHeights::kRoom, WholeHeights::kVoid) {}

  void fill(std::int32_t largest, unsigned voids_in_a_hundred) {
    for (std::size_t i = 0; i < kColumns * kRows; ++i) {
      cells_[i] = random_() % 100 < voids_in_a_hundred ? WholeHeights::kVoid : height(largest);
    }
  }
  std::int32_t height(std::int32_t largest) {
    return static_cast<std::int32_t>(random_() % (2U * static_cast<unsigned>(largest) + 1)) - largest;
  }
  GridPoint cell(std::int32_t reach) {
    const auto at = [&](std::int32_t size) {
      const std::int32_t from = static_cast<std::int32_t>(random_() % static_cast<unsigned>(size));
      return std::min(size - 1, from % std::max(1, reach) + (size - reach) / 3);
    };
    return {at(kColumns), at(kRows)};
  }
  WholeHeights heights() const { return {cells_.data(), kColumns}; }
  Blocks blocks() const {
    Blocks out(kColumns, kRows);
    for (std::int32_t i = 0; i < kColumns * kRows; ++i) {
      const std::int32_t z = cells_[static_cast<std::size_t>(i)];
      if (z != WholeHeights::kVoid) out.put(i % kColumns, i / kColumns, z);
    }
    return out;
  }

  /// Over the triangle of these corners and heights.
  static WholePlane plane(GridPoint a, GridPoint b, GridPoint c, std::int64_t za, std::int64_t zb,
                          std::int64_t zc) {
    const std::int64_t bx = b.x - a.x, by = b.y - a.y, cx = c.x - a.x, cy = c.y - a.y,
                       turn = bx * cy - by * cx;
    const std::int64_t sign = turn < 0 ? -1 : 1, rise_b = sign * (zb - za), rise_c = sign * (zc - za);
    return {a, b, c, sign * turn, sign * turn * za, rise_b * cy - rise_c * by, rise_c * bx - rise_b * cx};
  }
  /// Cell by cell.
  WorstCell search(const WholePlane& p) const {
    const auto turn = [](GridPoint u, GridPoint v, std::int32_t x, std::int32_t y) {
      return (std::int64_t{v.x} - u.x) * (std::int64_t{y} - u.y) -
             (std::int64_t{v.y} - u.y) * (std::int64_t{x} - u.x);
    };
    const std::int64_t sign = turn(p.a, p.b, p.c.x, p.c.y) < 0 ? -1 : 1;
    WorstCell worst;
    for (std::int32_t y = 0; y < kRows; ++y) {
      for (std::int32_t x = 0; x < kColumns; ++x) {
        const std::int32_t z = cells_[static_cast<std::size_t>(y) * kColumns + static_cast<std::size_t>(x)];
        if (z == WholeHeights::kVoid || sign * turn(p.a, p.b, x, y) < 0 || sign * turn(p.b, p.c, x, y) < 0 ||
            sign * turn(p.c, p.a, x, y) < 0)
          continue;
        const std::int64_t distance =
            std::abs(p.base + (x - p.a.x) * p.slope_x + (y - p.a.y) * p.slope_y - p.area * z);
        if (distance > worst.distance) worst = {distance, static_cast<std::uint32_t>(y * kColumns + x)};
      }
    }
    return worst;
  }

  Random random_{support::seed()};
  testing::ScopedTrace trace_{__FILE__, __LINE__, "TINSMITH_SEED=" + std::to_string(support::seed())};
  std::vector<std::int32_t> cells_;
};

TEST_F(WholeScanTest, BothFindTheFirstOfTheWorstCells) {
  int tried = 0;
  for (const std::int32_t largest : {1, 9, 4000, 1 << 24}) {
    for (const unsigned voids : {0U, 30U, 97U}) {
      fill(largest, voids);
      for (int round = 0; round < 400; ++round) {
        const std::int32_t reach = 2 + round % 80;
        const auto p =
            plane(cell(reach), cell(reach), cell(reach), height(largest), height(largest), height(largest));
        if (p.area == 0) continue;
        const WorstCell expected = search(p), integers = scan_by_integers(heights(), p, INT64_MAX);
        EXPECT_EQ(integers.distance, expected.distance);
        ASSERT_TRUE(expected.distance == 0 || integers.at == expected.at);
        ASSERT_TRUE(tin::simplify::doubles_suffice(p, largest));
        const WorstCell doubles = scan_by_doubles(heights(), p, INT64_MAX);
        EXPECT_EQ(doubles.distance, expected.distance);
        ASSERT_TRUE(expected.distance == 0 || doubles.at == expected.at);
        ++tried;
      }
    }
  }
  EXPECT_GT(tried, 3000);
}

TEST_F(WholeScanTest, CellsBesideTheCornersOfSmallTrianglesAreFoundWithoutRows) {
  std::array<int, tin::simplify::kSmallArea + 1> tried{};
  for (const unsigned voids : {0U, 40U}) {
    for (const std::int32_t largest : {1, 9, 1 << 24}) {
      fill(largest, voids);
      for (int round = 0; round < 40000; ++round) {
        const GridPoint a = cell(5), b = cell(5), c = cell(5);
        const auto z = [this](GridPoint p) -> std::int32_t& {
          return cells_[static_cast<std::size_t>(p.y * kColumns + p.x)];
        };
        for (const GridPoint corner : {a, b, c}) {
          if (z(corner) == WholeHeights::kVoid) z(corner) = height(largest);
        }
        const auto p = plane(a, b, c, z(a), z(b), z(c));
        if (p.area == 0 || p.area > tin::simplify::kSmallArea) continue;
        const WorstCell expected = search(p), found = scan_beside_corners(heights(), p);
        ASSERT_EQ(found.distance, expected.distance);
        ASSERT_EQ(found.at, expected.at);
        ++tried[static_cast<std::size_t>(p.area)];
      }
    }
  }
  for (std::size_t area = 1; area < tried.size(); ++area) EXPECT_GT(tried[area], 500);
}

TEST_F(WholeScanTest, SquaresThatArePassedOverHoldNoWorseCell) {
  for (const std::int32_t largest : {0, 1, 30, (1 << 30) - 1}) {
    for (const unsigned voids : {0U, 50U, 99U}) {
      fill(largest, voids);
      for (int islands = static_cast<int>(random_() % 3); islands > 0; --islands) {
        cells_[random_() % (kColumns * kRows)] = height(std::max(largest, 3));
      }
      const Blocks squares = blocks();
      for (int round = 0; round < 300; ++round) {
        // Level as the ground is in most, so that there is much to pass over.
        const std::int32_t tilt = round % 3 == 0 ? largest : 0;
        const auto p = plane(cell(80), cell(80), cell(80), height(tilt), height(tilt), height(tilt));
        if (p.area == 0) continue;
        const WorstCell expected = search(p), found = scan_by_blocks(heights(), squares, p, INT64_MAX);
        EXPECT_EQ(found.distance, expected.distance);
        ASSERT_TRUE(expected.distance == 0 || found.at == expected.at);
      }
    }
  }
}

TEST_F(WholeScanTest, AllMayStopOnlyAboveTheLimit) {
  fill(300, 10);
  const Blocks squares = blocks();
  for (int round = 0; round < 2000; ++round) {
    const auto p = plane(cell(60), cell(60), cell(60), height(300), height(300), height(300));
    if (p.area == 0) continue;
    const std::int64_t limit = p.area * static_cast<std::int64_t>(random_() % 500);
    const bool is_over = search(p).distance > limit;
    EXPECT_EQ(scan_by_integers(heights(), p, limit).distance > limit, is_over);
    EXPECT_EQ(scan_by_doubles(heights(), p, limit).distance > limit, is_over);
    EXPECT_EQ(scan_by_blocks(heights(), squares, p, limit).distance > limit, is_over);
  }
}

TEST_F(WholeScanTest, LargeNumbersAreLeftToIntegers) {
  constexpr std::int32_t kLargest = (1 << 30) - 1;
  EXPECT_FALSE(tin::simplify::doubles_suffice(plane({0, 0}, {1200, 0}, {0, 1200}, 1, 2, 3), kLargest));
  fill(kLargest, 5);
  for (int round = 0; round < 300; ++round) {
    const auto p = plane(cell(80), cell(80), cell(80), height(kLargest), height(kLargest), height(kLargest));
    if (p.area == 0) continue;
    const WorstCell expected = search(p), integers = scan_by_integers(heights(), p, INT64_MAX);
    EXPECT_EQ(integers.distance, expected.distance);
    ASSERT_TRUE(expected.distance == 0 || integers.at == expected.at);
  }
}

}  // namespace
