#include "server/app/time_budget.h"

#include <gtest/gtest.h>

namespace server::app {
namespace {

using Clock = TimeBudget::Clock;
using tin::base::Progress;

/// A search that goes on until time is up has done little of what it would do; it is nearly over all the same.
TEST(TimeBudgetTest, ProgressIsAtLeastAsFarAsTheClock) {
  Progress progress;
  progress.begin_phase(0.2, 0.6);
  const TimeBudget half(1000.0, Clock::now() - std::chrono::seconds(500));
  EXPECT_FALSE(half.question(&progress)());
  EXPECT_NEAR(progress.fraction(), 0.4, 0.05);
  const double at_half = progress.fraction();
  progress.report(0.1);
  EXPECT_EQ(progress.fraction(), at_half);
  progress.report(0.9);
  EXPECT_FALSE(half.question(&progress)());
  EXPECT_NEAR(progress.fraction(), 0.56, 1e-9) << "the work is ahead of the clock";
  const TimeBudget over(1.0, Clock::now() - std::chrono::seconds(5));
  EXPECT_TRUE(over.question(&progress)());
  EXPECT_TRUE(over.was_spent());
  EXPECT_NEAR(progress.fraction(), 0.6, 1e-9) << "and not further than the phase";
}

TEST(TimeBudgetTest, WithoutALimitThereIsNothingToAsk) {
  Progress progress;
  EXPECT_FALSE(TimeBudget(std::nullopt).question(&progress));
}

}  // namespace
}  // namespace server::app
