// What simplifications are held against: sources, with or without a terrain, and people's own samples.
#include <gtest/gtest.h>

#include <limits>

#include "tests/tin/simplify/judge.h"
#include "tests/tin/simplify/runs.h"
#include "tests/tin/simplify/terrains.h"

namespace {

using support::SimplifyTest;
using support::applied;
using support::heights;
using support::simplify;
using support::to;
using tin::terrain::Duplicates;
using tin::terrain::Edit;
using tin::terrain::Placement;
using tin::terrain::SourceSamples;
using tin::terrain::Terrain;

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

/// Spikes and holes that came while vertices were chosen for the terrain without them.
TEST_F(SimplifyTest, AChoiceForAnEarlierStateIsMendedForALaterOne) {
  std::size_t put_back = 0;
  for (const auto& [name, raster] : support::hard_rasters(random_, 30)) {
    SCOPED_TRACE(name);
    const Terrain seen = support::raster_terrain(raster);
    if (seen.mesh().dimension() < 2) continue;
    for (const double tolerance : {0.0, 3.0, 30.0}) {
      const auto chosen = simplify(seen, to(tolerance), nullptr);
      ASSERT_TRUE(chosen.ok());
      Terrain now = seen;
      const auto vertices = now.vertices_by_id();
      for (int i = 0; i < 4; ++i) {
        const auto id = vertices[random_() % vertices.size()].id;
        if (!now.vertex(id)) continue;
        const Edit edit = i % 2 == 0 ? Edit(tin::terrain::SetZ{id, 700}) : Edit(tin::terrain::Remove{id});
        ASSERT_TRUE(now.apply({&edit, 1}, Duplicates::kReject).ok());
      }
      if (now.mesh().dimension() < 2) continue;
      const auto outcome = tin::simplify::mend(now, nullptr, {}, applied(seen, *chosen), to(tolerance), nullptr);
      ASSERT_TRUE(outcome.ok());
      const Terrain result = applied(now, *outcome);
      EXPECT_EQ(support::judge(now, result, tolerance).value_or(""), "");
      EXPECT_TRUE(outcome->report.tolerance_met);
      support::expect_true_report(now, result, *outcome);
      put_back += result.vertex_count();
      put_back -= std::min(put_back, applied(seen, *chosen).vertex_count());
    }
  }
  EXPECT_GT(put_back, 0U);
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

}  // namespace
