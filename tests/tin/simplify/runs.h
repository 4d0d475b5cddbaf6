// Simplifications of small terrains, and what must be true of them.
#pragma once

#include <gtest/gtest.h>

#include <string>

#include "tests/support/point_sets.h"
#include "tin/simplify/simplify.h"

namespace support {

/// Whether everything takes ten times as long.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
inline constexpr bool kSanitized = true;
#else
inline constexpr bool kSanitized = false;
#endif

tin::simplify::Options to(double tolerance, tin::simplify::Effort effort = tin::simplify::Effort::kFast);
tin::simplify::Options at_most(std::size_t vertices,
                               tin::simplify::Effort effort = tin::simplify::Effort::kFast);
tin::simplify::Options both(double tolerance, std::size_t vertices);

/// With the vertices as samples.
tin::base::Result<tin::simplify::Outcome> simplify(const tin::terrain::Terrain& terrain,
                                                   const tin::simplify::Options& options,
                                                   tin::base::Progress* progress);

/// What becomes of the terrain.
tin::terrain::Terrain applied(const tin::terrain::Terrain& source, const tin::simplify::Outcome& outcome);

/// All that a report says, against the terrain that comes of it.
void expect_true_report(const tin::terrain::Terrain& source, const tin::terrain::Terrain& result,
                        const tin::simplify::Outcome& outcome);

/// Simplifies and expects all that is promised; the result.
tin::terrain::Terrain expect_kept(const tin::terrain::Terrain& source, const tin::simplify::Options& options);
/// The same by a tolerance alone; the number of vertices.
std::size_t expect_within(const tin::terrain::Terrain& source, double tolerance,
                          tin::simplify::Effort effort = tin::simplify::Effort::kFast);

/// A terrain's own raster as the source that it was made of.
tin::terrain::SourceSamples raster_source(const tin::terrain::Terrain& terrain);

class SimplifyTest : public testing::Test {
 protected:
  Random random_{seed()};
  testing::ScopedTrace trace_{__FILE__, __LINE__, "TINSMITH_SEED=" + std::to_string(seed())};
};

}  // namespace support
