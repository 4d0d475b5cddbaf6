// At most so many vertices.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/tin/simplify/judge.h"
#include "tests/tin/simplify/runs.h"
#include "tests/tin/simplify/terrains.h"

namespace {

using support::SimplifyTest;
using support::applied;
using support::at_most;
using support::both;
using support::expect_true_report;
using support::heights;
using support::simplify;
using support::to;
using tin::base::Code;
using tin::simplify::Effort;
using tin::terrain::Terrain;

TEST_F(SimplifyTest, ABudgetIsKept) {
  for (const auto& [name, raster] : support::hard_rasters(random_, 24)) {
    SCOPED_TRACE(name);
    const Terrain source = support::raster_terrain(raster);
    for (const std::size_t budget : {30UL, 60UL, 150UL, 1000000UL}) {
      const auto effort = budget == 60 ? Effort::kBalanced : Effort::kFast;
      const auto outcome = simplify(source, at_most(budget, effort), nullptr);
      if (!outcome.ok()) continue;  // a hull of many corners: another test
      EXPECT_LE(outcome->report.vertices_after, budget);
      EXPECT_TRUE(outcome->report.tolerance_met);
      expect_true_report(source, applied(source, *outcome), *outcome);
      if (budget >= source.vertex_count()) {
        EXPECT_EQ(outcome->report.max_error, 0);
      }
    }
  }
}

TEST_F(SimplifyTest, ABudgetWinsOverAToleranceAndTheReportSaysSo) {
  const auto wave = [](auto c, auto r) {
    return std::optional(std::round(30 * std::sin(c * 0.4) * std::cos(r * 0.3)));
  };
  const Terrain source = support::raster_terrain(heights(40, 40, wave));
  const std::size_t needed = simplify(source, to(3), nullptr)->report.vertices_after;
  const auto fits = simplify(source, both(3, needed), nullptr);
  EXPECT_EQ(fits->removed, simplify(source, to(3), nullptr)->removed);
  EXPECT_TRUE(fits->report.tolerance_met);
  for (const std::size_t budget : {needed / 2, needed / 8}) {
    const auto tight = simplify(source, both(3, budget), nullptr);
    EXPECT_LE(tight->report.vertices_after, budget);
    EXPECT_FALSE(tight->report.tolerance_met);
    EXPECT_GT(tight->report.max_error, 3);
    EXPECT_EQ(tight->removed, simplify(source, at_most(budget), nullptr)->removed);
  }
}

TEST_F(SimplifyTest, MoreVerticesNeverMakeALargerError) {
  const Terrain source = support::scattered_terrain(random_, 800, 2000, false);
  const double coarse = simplify(source, at_most(60), nullptr)->report.max_error;
  const double fine = simplify(source, at_most(240), nullptr)->report.max_error;
  EXPECT_LT(fine, coarse);
}

TEST_F(SimplifyTest, TooSmallABudgetSaysWhatIsNeeded) {
  const Terrain source =
      support::raster_terrain(heights(6, 6, [](auto, auto) { return std::optional(1.0); }));
  EXPECT_EQ(simplify(source, at_most(4), nullptr)->report.vertices_after, 4U);
  const auto refused = simplify(source, at_most(3), nullptr);
  ASSERT_FALSE(refused.ok());
  EXPECT_EQ(refused.error().code, Code::kInvalidValue);
  EXPECT_NE(refused.error().message.find("at least 4 vertices"), std::string::npos)
      << refused.error().message;
}

}  // namespace
