// How a simplification goes: the same result for the same request, progress, time, cancelling.
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <cmath>
#include <ctime>
#include <thread>

#include "tests/tin/simplify/judge.h"
#include "tests/tin/simplify/runs.h"
#include "tests/tin/simplify/terrains.h"
#include "tin/mesh/validate.h"
#include "tin/simplify/source_mesh.h"
#include "tin/simplify/wrapped_samples.h"

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
using tin::base::Progress;
using tin::simplify::Effort;
using tin::simplify::Options;
using tin::terrain::Duplicates;
using tin::terrain::Edit;
using tin::terrain::Terrain;
using tin::terrain::VertexId;

TEST_F(SimplifyTest, TwoRunsAndTwoHistoriesGiveTheSame) {
  for (const auto& [name, raster] : support::hard_rasters(random_, 30)) {
    SCOPED_TRACE(name);
    const Terrain source = support::raster_terrain(raster);
    Terrain detour = source;
    std::vector<Edit> there, back;
    for (std::uint64_t i = 1; i <= 3 && i < source.vertex_count(); ++i) {
      const auto vertex = *source.vertex(VertexId(i));
      there.emplace_back(tin::terrain::Move{vertex.id, {10000 + static_cast<std::int32_t>(i * i), -5}});
      back.emplace_back(tin::terrain::Move{vertex.id, vertex.at});
    }
    ASSERT_TRUE(detour.apply(there, Duplicates::kReject).ok());
    ASSERT_TRUE(detour.apply(back, Duplicates::kReject).ok());
    for (const Options& options : {to(2), at_most(source.vertex_count() / 5 + 12)}) {
      const auto first = simplify(source, options, nullptr), second = simplify(source, options, nullptr);
      const auto other = simplify(detour, options, nullptr);
      ASSERT_EQ(first.ok(), second.ok());
      if (!first.ok()) continue;
      EXPECT_EQ(first->removed, second->removed);
      EXPECT_EQ(first->removed, other->removed);
      EXPECT_EQ(first->report.max_error, second->report.max_error);
      EXPECT_EQ(first->report.rmse, second->report.rmse);
    }
  }
}

TEST_F(SimplifyTest, ThreadsDoNotChangeTheResult) {
  const auto wave = [&](auto c, auto r) {
    return std::optional(std::round(200 * std::sin(c * 0.05) * std::cos(r * 0.03) + static_cast<double>(random_() % 9)));
  };
  // Several tiles, and several patches.
  const Terrain source = support::raster_terrain(heights(460, 330, wave));
  const double noise = support::kSanitized ? 3.5 : 2;
  for (Options options : {to(noise), to(noise + 1, Effort::kBalanced), at_most(4000, Effort::kBalanced)}) {
    const auto one = simplify(source, options, nullptr);
    for (const unsigned threads : {2U, 3U}) {
      options.threads = threads;
      const auto more = simplify(source, options, nullptr);
      EXPECT_EQ(one->removed, more->removed);
      EXPECT_EQ(one->report.max_error, more->report.max_error);
      EXPECT_EQ(one->report.rmse, more->report.rmse);
      EXPECT_EQ(one->report.histogram, more->report.histogram);
    }
    EXPECT_EQ(tin::mesh::validate(applied(source, *one).mesh()).value_or(""), "");
  }
}

TEST_F(SimplifyTest, AnotherSeedGivesAnotherResultWithinTheSameTolerance) {
  const Terrain source = support::raster_terrain(support::hard_rasters(random_, 60)[0].raster);
  Options options = to(4, Effort::kBalanced);
  const auto first = simplify(source, options, nullptr);
  options.seed = 2;
  const auto second = simplify(source, options, nullptr);
  EXPECT_NE(first->removed, second->removed);
  EXPECT_EQ(support::judge(source, applied(source, *second), 4).value_or(""), "");
}

TEST_F(SimplifyTest, WhenTimeIsUpTheStateReachedIsReturned) {
  const Terrain source = support::raster_terrain(support::hard_rasters(random_, 60)[0].raster);
  for (Options options : {to(4, Effort::kBest), at_most(1200, Effort::kBest)}) {
    std::atomic<int> questions{0};
    options.out_of_time = [&] { return ++questions > 40; };
    const auto stopped = simplify(source, options, nullptr);
    ASSERT_TRUE(stopped.ok());
    EXPECT_TRUE(stopped->report.tolerance_met);
    expect_true_report(source, applied(source, *stopped), *stopped);
    EXPECT_LT(questions, 400);
    options.out_of_time = [] { return true; };
    const auto at_once = simplify(source, options, nullptr);
    ASSERT_TRUE(at_once.ok());
    expect_true_report(source, applied(source, *at_once), *at_once);
    options.effort = Effort::kFast;
    EXPECT_EQ(at_once->report.max_error, simplify(source, options, nullptr)->report.max_error);
  }
}

TEST_F(SimplifyTest, ProgressRisesToTheEnd) {
  const Terrain source = support::raster_terrain(support::hard_rasters(random_, 150)[0].raster);
  for (const Options& options : {to(2), at_most(3000), both(2, 3000)}) {
    Progress progress;
    bool falls = false;
    std::jthread watcher([&](const std::stop_token& done) {
      for (double last = 0; !done.stop_requested(); std::this_thread::yield()) {
        const double now = progress.fraction();
        falls = falls || now < last;
        last = now;
      }
    });
    ASSERT_TRUE(simplify(source, options, &progress).ok());
    watcher.request_stop();
    watcher.join();
    EXPECT_FALSE(falls);
    EXPECT_EQ(progress.fraction(), 1.0);
  }
}

TEST_F(SimplifyTest, StopsWhenCancelledAndLeavesTheSourceAlone) {
  const auto wave = [](auto c, auto r) {
    return std::optional(std::round(80 * std::sin(c * 0.1) * std::cos(r * 0.13)) / 2);
  };
  const Terrain source = support::raster_terrain(heights(120, 120, wave));
  const std::string before = source.digest();
  int stopped = 0;
  for (const Options& options : {to(0.5), at_most(900)}) {
    Progress at_once;
    at_once.cancel();
    const auto none = simplify(source, options, &at_once);
    ASSERT_FALSE(none.ok());
    EXPECT_EQ(none.error().code, Code::kCancelled);
    for (int round = 0; round < 12; ++round) {
      Progress progress;
      const double moment = static_cast<double>(random_() % 1000) / 1000;
      std::jthread canceller([&](const std::stop_token& done) {
        while (progress.fraction() < moment && !done.stop_requested()) std::this_thread::yield();
        progress.cancel();
      });
      const auto outcome = simplify(source, options, &progress);
      if (outcome.ok()) continue;  // too late
      EXPECT_EQ(outcome.error().code, Code::kCancelled);
      ++stopped;
    }
  }
  EXPECT_GT(stopped, 0);
  EXPECT_EQ(source.digest(), before);
  EXPECT_EQ(tin::mesh::validate(source.mesh()).value_or(""), "");
}

TEST_F(SimplifyTest, ACancelledSimplificationEndsWithinASecond) {
  const auto wave = [&](auto c, auto r) {
    return std::optional(std::round(300 * std::sin(c * 0.03) * std::cos(r * 0.02) + static_cast<double>(random_() % 12)));
  };
  const Terrain source =
      support::raster_terrain(support::kSanitized ? heights(200, 160, wave) : heights(480, 400, wave));
  Options all = to(2, Effort::kThorough);
  all.elevations = tin::simplify::Elevations::kFit;
  all.against = tin::simplify::Against::kSurface;
  all.keep_flat = 9;
  int stopped = 0;
  for (const Options& options : {to(2), to(2, Effort::kThorough), at_most(9000, Effort::kBalanced), all}) {
    for (const double moment : {0.0, 0.03, 0.3}) {
      Progress progress;
      std::clock_t asked = 0;
      std::jthread canceller([&](const std::stop_token& done) {
        while (progress.fraction() < moment && !done.stop_requested()) std::this_thread::sleep_for(std::chrono::milliseconds(1));
        asked = std::clock();
        progress.cancel();
      });
      const auto outcome = simplify(source, options, &progress);
      const std::clock_t ended = std::clock();
      canceller.request_stop();
      canceller.join();
      if (outcome.ok()) continue;  // too late
      ++stopped;
      // Of processor time: others may be at work on the machine.
      EXPECT_LT(static_cast<double>(ended - asked) / CLOCKS_PER_SEC, 1) << moment;
    }
  }
  EXPECT_GT(stopped, 4);
}

/// Asks to stop as soon as its sites are read.
class CancellingSamples : public tin::simplify::WrappedSamples {
 public:
  CancellingSamples(std::unique_ptr<tin::simplify::Samples> samples, Progress& progress)
      : WrappedSamples(std::move(samples)), progress_(progress) {}
  void sites(tin::simplify::SampleIndex begin, tin::simplify::SampleIndex end,
             std::vector<tin::simplify::Site>& out) const override {
    WrappedSamples::sites(begin, end, out);
    progress_.cancel();
  }

 private:
  Progress& progress_;
};

TEST_F(SimplifyTest, TheTriangulationOfTheSamplesCanBeCancelledAndReportsNothing) {
  const Terrain source = support::raster_terrain(
      heights(60, 60, [](auto c, auto r) { return std::optional(double(c * r % 7)); }));
  const auto samples = [&] { return tin::simplify::make_samples(&source, nullptr, {}, {}, nullptr); };
  Progress progress;
  EXPECT_NE(tin::simplify::SourceMesh::of(*samples(), 2, &progress), nullptr);
  EXPECT_EQ(progress.fraction(), 0);
  EXPECT_EQ(tin::simplify::SourceMesh::of(CancellingSamples(samples(), progress), 2, &progress), nullptr);
  EXPECT_EQ(tin::simplify::SourceMesh::of(*samples(), 2, &progress), nullptr) << "cancelled before";
  EXPECT_NE(tin::simplify::SourceMesh::of(*samples(), 2, nullptr), nullptr);
}

TEST(Progress, NeverFalls) {
  Progress progress;
  progress.begin_phase(0.25, 0.75);
  progress.report(0.5);
  progress.report(0.25);
  EXPECT_EQ(progress.fraction(), 0.5);
  progress.begin_phase(0.25, 0.75);
  EXPECT_EQ(progress.fraction(), 0.5);
  progress.begin_phase(0.75, 1);
  EXPECT_EQ(progress.fraction(), 0.75);
}

TEST(Progress, APartThatReportsToNobodyIsCancelledWithTheWhole) {
  Progress whole, part(&whole);
  part.report(0.5);
  EXPECT_EQ(whole.fraction(), 0);
  EXPECT_FALSE(part.cancelled());
  whole.cancel();
  EXPECT_TRUE(part.cancelled());
  Progress alone(nullptr);
  EXPECT_FALSE(alone.cancelled());
  alone.cancel();
  EXPECT_TRUE(alone.cancelled());
}

}  // namespace
