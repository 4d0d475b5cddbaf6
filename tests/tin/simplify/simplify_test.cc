#include "tin/simplify/simplify.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <numeric>
#include <thread>

#include "tests/tin/simplify/judge.h"
#include "tests/tin/simplify/terrains.h"
#include "tin/mesh/validate.h"

namespace {

using support::heights;
using support::Random;
using tin::base::Code;
using tin::base::Progress;
using tin::exact::Point;
using tin::simplify::Options;
using tin::simplify::Outcome;
using tin::simplify::Effort;
using tin::terrain::SourceSamples;
using tin::terrain::Duplicates;
using tin::terrain::Edit;
using tin::terrain::Placement;
using tin::terrain::Terrain;
using tin::terrain::VertexId;

Options to(double tolerance, Effort effort = Effort::kFast) {
  Options options;
  options.tolerance = tolerance;
  options.effort = effort;
  return options;
}
Options at_most(std::size_t vertices, Effort effort = Effort::kFast) {
  Options options;
  options.max_vertices = vertices;
  options.effort = effort;
  return options;
}
Options both(double tolerance, std::size_t vertices) {
  Options options = to(tolerance);
  options.max_vertices = vertices;
  return options;
}

/// With the vertices as samples.
auto simplify(const Terrain& terrain, const Options& options, Progress* progress) {
  return tin::simplify::simplify(terrain, nullptr, {}, options, progress);
}

/// What becomes of the terrain.
Terrain applied(const Terrain& source, const Outcome& outcome) {
  Terrain result = source;
  std::vector<Edit> edits;
  for (const VertexId id : outcome.removed) edits.emplace_back(tin::terrain::Remove{id});
  for (const Placement& vertex : outcome.inserted) edits.emplace_back(tin::terrain::Insert{vertex.at, vertex.z});
  EXPECT_TRUE(result.apply(edits, Duplicates::kReject).ok());
  return result;
}

/// All that a report says, against the terrain that comes of it.
void expect_true_report(const Terrain& source, const Terrain& result, const Outcome& outcome) {
  const auto& report = outcome.report;
  EXPECT_TRUE(std::is_sorted(outcome.removed.begin(), outcome.removed.end()));
  EXPECT_EQ(report.vertices_before, source.vertex_count());
  EXPECT_EQ(report.vertices_after, result.vertex_count());
  EXPECT_EQ(tin::mesh::validate(result.mesh()).value_or(""), "");
  const double above = report.max_error + std::abs(report.max_error) * 1e-9 + 1e-9;
  EXPECT_EQ(support::judge(source, result, above).value_or(""), "");
  EXPECT_LE(report.rmse, report.max_error);
  EXPECT_EQ(report.samples, source.vertex_count());
  EXPECT_EQ(std::accumulate(report.histogram.begin(), report.histogram.end(), std::size_t{0}), report.samples);
  ASSERT_EQ(report.worst.has_value(), report.max_error > 0);
  if (!report.worst) return;
  EXPECT_EQ(report.worst->error, report.max_error);
  EXPECT_FALSE(report.worst->source_index.has_value());
  if (report.max_error > 1e-6 && report.max_error < 1e100) {
    EXPECT_NE(support::judge(source, result, report.max_error * (1 - 1e-9)).value_or(""), "");
  }
}

std::size_t expect_within(const Terrain& source, double tolerance, Effort effort = Effort::kFast) {
  const auto outcome = simplify(source, to(tolerance, effort), nullptr);
  EXPECT_TRUE(outcome.ok());
  const Terrain result = applied(source, *outcome);
  EXPECT_EQ(support::judge(source, result, tolerance).value_or(""), "") << "tolerance " << tolerance;
  EXPECT_TRUE(outcome->report.tolerance_met);
  EXPECT_LE(outcome->report.max_error, tolerance);
  expect_true_report(source, result, *outcome);
  return result.vertex_count();
}

class SimplifyTest : public testing::Test {
 protected:
  Random random_{support::seed()};
  testing::ScopedTrace trace_{__FILE__, __LINE__, "TINSMITH_SEED=" + std::to_string(support::seed())};
};

TEST_F(SimplifyTest, KeepsEverySampleOfHardRastersWithinTheTolerance) {
  for (const auto& [name, raster] : support::hard_rasters(random_, 24)) {
    SCOPED_TRACE(name);
    const Terrain source = support::raster_terrain(raster);
    for (const double tolerance : {0.0, 1e-9, 0.25, 1.0, 3.0, 20.0, 1e9}) expect_within(source, tolerance);
  }
}

TEST_F(SimplifyTest, LocalSearchKeepsEverySampleWithinTheToleranceAndNeedsFewer) {
  for (const auto& [name, raster] : support::hard_rasters(random_, 30)) {
    SCOPED_TRACE(name);
    const Terrain source = support::raster_terrain(raster);
    for (const double tolerance : {0.0, 1.0, 20.0}) {
      const std::size_t fast = expect_within(source, tolerance);
      const std::size_t balanced = expect_within(source, tolerance, Effort::kBalanced);
      const std::size_t thorough = expect_within(source, tolerance, Effort::kThorough);
      EXPECT_LE(balanced, fast);
      EXPECT_LE(thorough, fast);
    }
  }
}

TEST_F(SimplifyTest, ScatteredSamplesStayWithinTheToleranceInLocalSearch) {
  for (const std::int32_t extent : {60, 3000, tin::exact::kLatticeHalf - 1}) {
    const Terrain source = support::scattered_terrain(random_, 600, extent, extent == 3000);
    for (const double tolerance : {0.0, 2.0, 10.0}) {
      EXPECT_LE(expect_within(source, tolerance, Effort::kThorough), expect_within(source, tolerance));
    }
  }
}

TEST_F(SimplifyTest, KeepsRastersOfAnyStepWithinTheTolerance) {
  for (const auto& [name, raster] : support::hard_rasters(random_, 18)) {
    SCOPED_TRACE(name);
    for (const std::int32_t dy : {92663, -92663, 1})
      expect_within(support::raster_terrain(raster, 66091, dy), 2);
  }
}

TEST_F(SimplifyTest, KeepsScatteredSamplesWithinTheTolerance) {
  for (const std::int32_t extent : {40, 3000, tin::exact::kLatticeHalf - 1}) {
    for (const bool whole : {true, false}) {
      const Terrain source = support::scattered_terrain(random_, 500, extent, whole);
      for (const double tolerance : {0.0, 0.5, 2.0, 10.0, 1000.0}) expect_within(source, tolerance);
    }
  }
}

TEST_F(SimplifyTest, KeepsClustersFarApartWithinTheTolerance) {
  std::vector<Placement> placements;
  for (const Point p : support::corner_clusters(random_, 120))
    placements.push_back({p, static_cast<double>(random_() % 50)});
  const Terrain source = *Terrain::build({}, placements, Duplicates::kKeep);
  for (const double tolerance : {0.0, 5.0, 30.0}) expect_within(source, tolerance);
}

TEST_F(SimplifyTest, KeepsEditedRastersWithinTheTolerance) {
  for (const auto& [name, raster] : support::hard_rasters(random_, 20)) {
    SCOPED_TRACE(name);
    Terrain source = support::raster_terrain(raster);
    std::vector<Edit> edits;
    for (std::uint64_t i = 0; i < source.vertex_count() / 12; ++i) {
      edits.emplace_back(tin::terrain::Remove{VertexId(1 + 12 * i)});
      edits.emplace_back(tin::terrain::SetZ{VertexId(3 + 12 * i), 7.0 + static_cast<double>(i)});
      edits.emplace_back(tin::terrain::Insert{
          {static_cast<std::int32_t>(random_() % 150) - 75, static_cast<std::int32_t>(random_() % 150) - 75},
          9.5});
    }
    ASSERT_TRUE(source.apply(edits, Duplicates::kReplace).ok());
    for (const double tolerance : {0.0, 1.0, 6.0}) expect_within(source, tolerance);
  }
}

TEST_F(SimplifyTest, SimplifiesWhatWasSimplifiedBefore) {
  for (const auto& [name, raster] : support::hard_rasters(random_, 40)) {
    SCOPED_TRACE(name);
    Terrain source = support::raster_terrain(raster);
    for (const double tolerance : {3.0, 9.0, 30.0}) {
      const auto outcome = simplify(source, to(tolerance), nullptr);
      ASSERT_TRUE(outcome.ok());
      const Terrain result = applied(source, *outcome);
      EXPECT_EQ(support::judge(source, result, tolerance).value_or(""), "");
      source = result;
    }
  }
}

TEST_F(SimplifyTest, AtToleranceZeroOnlyWhatLiesOnTheSurfaceGoes) {
  const Terrain noisy = support::raster_terrain(
      heights(15, 15, [&](auto, auto) { return std::optional<double>(random_() % 1000); }));
  const auto kept = simplify(noisy, to(0), nullptr);
  EXPECT_EQ(kept->report.max_error, 0);
  EXPECT_FALSE(kept->report.worst.has_value());
  const Terrain slope = support::raster_terrain(
      heights(15, 15, [](auto c, auto r) { return std::optional(3.0 * c - 2.0 * r); }));
  EXPECT_EQ(expect_within(slope, 0), 4U);
  const Terrain roof = support::raster_terrain(
      heights(15, 15, [](auto c, auto) { return std::optional(c < 7 ? c : 14.0 - c); }));
  EXPECT_EQ(expect_within(roof, 0), 6U);
}

TEST_F(SimplifyTest, AnErrorThatEqualsTheToleranceIsWithinIt) {
  // A spike of 2 over a plane: without it the error is 2, exactly.
  const Terrain spike = support::raster_terrain(
      heights(5, 5, [](auto c, auto r) { return std::optional(c == 2 && r == 1 ? 2.0 : 0.0); }));
  EXPECT_EQ(simplify(spike, to(2), nullptr)->report.vertices_after, 4U);
  EXPECT_EQ(simplify(spike, to(2), nullptr)->report.max_error, 2);
  EXPECT_GT(simplify(spike, to(std::nextafter(2.0, 0.0)), nullptr)->report.vertices_after, 4U);
}

TEST_F(SimplifyTest, AnInterpolatedThirdIsComparedExactly) {
  // A triangle of 0, 0 and 1 with one sample at its centroid: interpolated 1/3, which no double equals.
  const std::vector<Placement> placements{{{0, 0}, 0}, {{3, 0}, 0}, {{0, 3}, 1}, {{1, 1}, 0}};
  const Terrain source = *Terrain::build({}, placements, Duplicates::kReject);
  const double below = 1.0 / 3;  // rounded down
  EXPECT_EQ(simplify(source, to(below), nullptr)->report.vertices_after, 4U);
  EXPECT_EQ(simplify(source, to(std::nextafter(below, 1.0)), nullptr)->report.vertices_after, 3U);
}

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
  for (Options options : {to(2), to(3, Effort::kBalanced), at_most(4000, Effort::kBalanced)}) {
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

TEST_F(SimplifyTest, ASecondSimplificationIsHeldAgainstTheFirstSamples) {
  for (const auto& [name, raster] : support::hard_rasters(random_, 30)) {
    SCOPED_TRACE(name);
    const Terrain full = support::raster_terrain(raster);
    std::vector<double> z;
    for (const auto& height : raster.z) z.push_back(height.value_or(std::numeric_limits<double>::quiet_NaN()));
    const auto source = SourceSamples::raster(full.shared_source_grid(), z);
    Terrain terrain = full;
    for (const double tolerance : {9.0, 2.0, 30.0, 0.0}) {
      const auto outcome = tin::simplify::simplify(terrain, &source, {}, to(tolerance), nullptr);
      ASSERT_TRUE(outcome.ok());
      terrain = applied(terrain, *outcome);
      EXPECT_EQ(support::judge(full, terrain, tolerance).value_or(""), "");
      EXPECT_EQ(terrain.vertex_count(), outcome->report.vertices_after);
      EXPECT_EQ(outcome->report.samples, full.vertex_count());
      const auto directly = simplify(full, to(tolerance), nullptr);
      EXPECT_EQ(outcome->report.max_error, directly->report.max_error);
      EXPECT_EQ(applied(full, *directly).digest(), terrain.digest());
      const auto& worst = outcome->report.worst;
      if (!worst) continue;
      EXPECT_EQ(source.at(worst->source_index.value()), worst->at);
      EXPECT_EQ(source.z(worst->source_index.value()), worst->z);
    }
  }
}

TEST_F(SimplifyTest, SamplesNeedNoTerrain) {
  for (const auto& [name, raster] : support::hard_rasters(random_, 30)) {
    SCOPED_TRACE(name);
    const Terrain full = support::raster_terrain(raster);
    std::vector<double> z;
    for (const auto& height : raster.z) z.push_back(height.value_or(std::numeric_limits<double>::quiet_NaN()));
    const auto source = SourceSamples::raster(full.shared_source_grid(), z);
    const auto chosen = tin::simplify::simplify_samples(source, to(3), nullptr);
    ASSERT_TRUE(chosen.ok());
    const Terrain built = *Terrain::build({}, chosen->vertices, Duplicates::kReject);
    EXPECT_EQ(built.digest(), applied(full, *simplify(full, to(3), nullptr)).digest());
    EXPECT_EQ(chosen->report.vertices_before, full.vertex_count());
    EXPECT_EQ(chosen->report.vertices_after, built.vertex_count());
  }
  const Terrain scattered = support::scattered_terrain(random_, 400, 900, true);
  std::vector<Placement> points;
  for (const auto& vertex : scattered.vertices_by_id()) points.push_back({vertex.at, vertex.z});
  const auto chosen = tin::simplify::simplify_samples(SourceSamples::points(points), to(4), nullptr);
  EXPECT_EQ(Terrain::build({}, chosen->vertices, Duplicates::kReject)->digest(),
            applied(scattered, *simplify(scattered, to(4), nullptr)).digest());
}

TEST_F(SimplifyTest, OwnSamplesOfPeopleCountBesideTheSource) {
  const Terrain full = support::raster_terrain(heights(12, 12, [](auto c, auto) { return std::optional<double>(c % 5); }));
  std::vector<double> z;
  for (int i = 0; i < 144; ++i) z.push_back(i % 12 % 5);
  const auto source = SourceSamples::raster(full.shared_source_grid(), z);
  // One that stands as a vertex, one that does not, both between the pixels.
  Terrain terrain = applied(full, *simplify(full, to(2), nullptr));
  ASSERT_TRUE(terrain.apply(std::vector<Edit>{tin::terrain::Insert{{3, 4}, 60}}, Duplicates::kReject).ok());
  const std::vector<Placement> own{{{10, -3}, -50}};
  const auto outcome = tin::simplify::simplify(terrain, &source, own, to(1), nullptr);
  ASSERT_TRUE(outcome.ok());
  EXPECT_EQ(outcome->report.samples, 146U);
  const Terrain result = applied(terrain, *outcome);
  const std::vector<Edit> both{tin::terrain::Insert{{3, 4}, 60}, tin::terrain::Insert{{10, -3}, -50}};
  Terrain all = full;
  ASSERT_TRUE(all.apply(both, Duplicates::kReject).ok());
  EXPECT_EQ(support::judge(all, result, 1).value_or(""), "");
}

TEST_F(SimplifyTest, WhatIsProtectedStays) {
  for (const auto& [name, raster] : support::hard_rasters(random_, 30)) {
    SCOPED_TRACE(name);
    const Terrain source = support::raster_terrain(raster);
    for (Options options : {to(5), to(5, Effort::kBalanced), at_most(120, Effort::kBalanced)}) {
      for (std::uint64_t i = 1; i <= 20 && i <= source.vertex_count(); ++i) {
        options.protect.push_back(source.vertex(VertexId(1 + i * 7919 % source.vertex_count()))->at);
      }
      options.protect.push_back({1 << 28, 3});  // no sample
      const auto outcome = simplify(source, options, nullptr);
      if (!outcome.ok()) continue;  // a hull of many corners
      const Terrain result = applied(source, *outcome);
      expect_true_report(source, result, *outcome);
      for (const Point p : options.protect) {
        const auto where = result.triangulation().locate(p);
        EXPECT_EQ(where.kind == tin::delaunay::Location::Kind::kOnVertex, p.x != 1 << 28);
      }
    }
  }
}

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

TEST_F(SimplifyTest, TheHullKeepsItsShape) {
  const Terrain source = support::raster_terrain(
      heights(20, 20, [&](auto, auto) { return std::optional<double>(random_() % 3); }));
  const Terrain result = applied(source, *simplify(source, to(100), nullptr));
  EXPECT_EQ(result.vertex_count(), 4U);
  EXPECT_EQ(result.bounds()->min, source.bounds()->min);
  EXPECT_EQ(result.bounds()->max, source.bounds()->max);
  for (const auto& set : support::hard_sets(random_, 200)) {
    SCOPED_TRACE(set.name);
    std::vector<Placement> placements;
    for (const Point p : set.points) placements.push_back({p, static_cast<double>(random_() % 9)});
    const Terrain terrain = *Terrain::build({}, placements, Duplicates::kKeep);
    if (terrain.mesh().dimension() == 2) expect_within(terrain, 4);
  }
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

TEST_F(SimplifyTest, RefusesImpossibleOptions) {
  const Terrain source =
      support::raster_terrain(heights(3, 3, [](auto, auto) { return std::optional(1.0); }));
  const double nan = std::numeric_limits<double>::quiet_NaN(),
               infinity = std::numeric_limits<double>::infinity();
  for (const Options& options : {Options{}, to(-1), to(nan), to(infinity), to(-infinity)}) {
    const auto refused = simplify(source, options, nullptr);
    ASSERT_FALSE(refused.ok());
    EXPECT_EQ(refused.error().code, Code::kInvalidValue);
  }
  EXPECT_TRUE(simplify(source, to(std::numeric_limits<double>::max()), nullptr).ok());
  EXPECT_TRUE(simplify(source, to(std::numeric_limits<double>::denorm_min()), nullptr).ok());
}

TEST_F(SimplifyTest, ALineOfSamplesStaysAsItIs) {
  for (const std::size_t count : {0UL, 1UL, 2UL, 3UL, 40UL}) {
    std::vector<Placement> placements;
    for (const Point p : support::line_points(count, 3, -2)) placements.push_back({p, 1.0});
    const Terrain source = *Terrain::build({}, placements, Duplicates::kReject);
    const auto outcome = simplify(source, to(10), nullptr);
    ASSERT_TRUE(outcome.ok());
    EXPECT_TRUE(outcome->removed.empty());
    EXPECT_EQ(outcome->report.vertices_after, count);
    EXPECT_EQ(outcome->report.max_error, 0);
    EXPECT_TRUE(simplify(source, at_most(count), nullptr).ok());
    if (count > 0) {
      EXPECT_FALSE(simplify(source, at_most(count - 1), nullptr).ok());
    }
  }
  const Terrain row =
      support::raster_terrain(heights(30, 1, [](auto c, auto) { return std::optional<double>(c % 7); }));
  EXPECT_TRUE(simplify(row, to(1), nullptr)->removed.empty());
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

}  // namespace
