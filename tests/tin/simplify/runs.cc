#include "tests/tin/simplify/runs.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

#include "tests/tin/simplify/judge.h"
#include "tin/mesh/validate.h"

namespace support {

using tin::simplify::Effort;
using tin::simplify::Options;
using tin::simplify::Outcome;
using tin::terrain::Edit;
using tin::terrain::Terrain;

Options to(double tolerance, Effort effort) {
  Options options;
  options.tolerance = tolerance;
  options.effort = effort;
  return options;
}

Options at_most(std::size_t vertices, Effort effort) {
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

tin::base::Result<Outcome> simplify(const Terrain& terrain, const Options& options,
                                    tin::base::Progress* progress) {
  return tin::simplify::simplify(terrain, nullptr, {}, options, progress);
}

Terrain applied(const Terrain& source, const Outcome& outcome) {
  Terrain result = source;
  std::vector<Edit> edits;
  for (const auto id : outcome.removed) edits.emplace_back(tin::terrain::Remove{id});
  for (const auto& vertex : outcome.inserted) edits.emplace_back(tin::terrain::Insert{vertex.at, vertex.z});
  for (const auto& vertex : outcome.reset) edits.emplace_back(tin::terrain::SetZ{vertex.id, vertex.z});
  EXPECT_TRUE(result.apply(edits, tin::terrain::Duplicates::kReject).ok());
  return result;
}

void expect_true_report(const Terrain& source, const Terrain& result, const Outcome& outcome) {
  const auto& report = outcome.report;
  EXPECT_TRUE(std::is_sorted(outcome.removed.begin(), outcome.removed.end()));
  EXPECT_EQ(report.vertices_before, source.vertex_count());
  EXPECT_EQ(report.vertices_after, result.vertex_count());
  EXPECT_EQ(tin::mesh::validate(result.mesh()).value_or(""), "");
  const double above = report.max_error + std::abs(report.max_error) * 1e-9 + 1e-9;
  EXPECT_EQ(judge(source, result, above).value_or(""), "");
  EXPECT_LE(report.rmse, report.max_error);
  EXPECT_EQ(report.samples, source.vertex_count());
  EXPECT_EQ(std::accumulate(report.histogram.begin(), report.histogram.end(), std::size_t{0}),
            report.samples);
  ASSERT_EQ(report.worst.has_value(), report.max_error > 0);
  if (!report.worst) return;
  EXPECT_EQ(report.worst->error, report.max_error);
  EXPECT_FALSE(report.worst->source_index.has_value());
  if (report.max_error > 1e-6 && report.max_error < 1e100 && !report.worst->between) {
    EXPECT_NE(judge(source, result, report.max_error * (1 - 1e-9)).value_or(""), "");
  }
}

Terrain expect_kept(const Terrain& source, const Options& options) {
  const auto outcome = simplify(source, options, nullptr);
  EXPECT_TRUE(outcome.ok());
  Terrain result = applied(source, *outcome);
  EXPECT_EQ(judge(source, result, *options.tolerance).value_or(""), "") << "tolerance " << *options.tolerance;
  EXPECT_TRUE(outcome->report.tolerance_met);
  EXPECT_LE(outcome->report.max_error, *options.tolerance);
  expect_true_report(source, result, *outcome);
  return result;
}

std::size_t expect_within(const Terrain& source, double tolerance, Effort effort) {
  return expect_kept(source, to(tolerance, effort)).vertex_count();
}

tin::terrain::SourceSamples raster_source(const Terrain& terrain) {
  const auto grid = terrain.shared_source_grid();
  std::vector<double> z(static_cast<std::size_t>(grid->width) * static_cast<std::size_t>(grid->height),
                        std::numeric_limits<double>::quiet_NaN());
  for (const auto& vertex : terrain.vertices_by_id()) {
    if (const auto cell = grid->cell_centred_at(vertex.at))
      z[static_cast<std::size_t>(cell->row) * static_cast<std::size_t>(grid->width) +
        static_cast<std::size_t>(cell->column)] = vertex.z;
  }
  return tin::terrain::SourceSamples::raster(grid, z);
}

}  // namespace support
