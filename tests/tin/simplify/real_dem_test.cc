// Real elevation tiles, where they are at hand: in the folder that TINSMITH_TERRAIN names, else beside the
// repository.
#include <gtest/gtest.h>

#include <cstdlib>
#include <string>

#include "tests/tin/simplify/judge.h"
#include "tests/tin/simplify/terrains.h"
#include "tin/mesh/validate.h"
#include "tin/simplify/simplify.h"

namespace {

using tin::simplify::Effort;
using tin::terrain::Terrain;

/// With the vertices as samples.
auto simplify(const Terrain& terrain, double tolerance, Effort effort = Effort::kFast) {
  tin::simplify::Options options;
  options.tolerance = tolerance;
  options.effort = effort;
  return tin::simplify::simplify(terrain, nullptr, {}, options, nullptr);
}

std::string folder() {
  const char* const named = std::getenv("TINSMITH_TERRAIN");
  return named != nullptr ? named : TINSMITH_DEFAULT_TERRAIN;
}

struct Goal {
  const char* tile;
  double south;
  double tolerance;
  Effort effort;
  std::size_t at_most;  // vertices
};

class RealDemTest : public testing::TestWithParam<Goal> {};

/// What a prototype reached: by insertion and deletion in one piece for `fast`, by ten times the time for
/// `thorough`.
TEST_P(RealDemTest, NeedsNoMoreVerticesThanThePrototype) {
  const auto [tile, south, tolerance, effort, at_most] = GetParam();
  const auto source = support::hgt_terrain(folder() + "/" + tile + ".hgt", south);
  if (!source) GTEST_SKIP() << "no " << tile << ".hgt in " << folder();
  const auto outcome = simplify(*source, tolerance, effort);
  ASSERT_TRUE(outcome.ok());
  EXPECT_LE(outcome->report.vertices_after, at_most);
  EXPECT_LE(outcome->report.max_error, tolerance);
  EXPECT_EQ(outcome->report.vertices_after + outcome->removed.size(), 1201U * 1201U);
}

#ifdef NDEBUG
INSTANTIATE_TEST_SUITE_P(Tiles, RealDemTest,
                         testing::Values(Goal{"N51E001", 51, 10, Effort::kFast, 4925},
                                         Goal{"N44W072", 44, 10, Effort::kFast, 96892},
                                         Goal{"N44W072", 44, 5, Effort::kFast, 226472},
                                         Goal{"N53E027", 53, 10, Effort::kFast, 20330},
                                         Goal{"N51E001", 51, 10, Effort::kThorough, 2800},
                                         Goal{"N53E027", 53, 10, Effort::kThorough, 8600}));
#else
INSTANTIATE_TEST_SUITE_P(Tiles, RealDemTest, testing::Values(Goal{"N51E001", 51, 10, Effort::kFast, 4925}));
#endif

TEST(RealDemCropTest, EverySampleIsWithinTheToleranceOnceTheVerticesAreRemoved) {
  const auto source = support::hgt_terrain(folder() + "/N44W072.hgt", 44, 150);
  if (!source) GTEST_SKIP() << "no N44W072.hgt in " << folder();
  const auto outcome = simplify(*source, 10);
  ASSERT_TRUE(outcome.ok());
  Terrain result = *source;
  std::vector<tin::terrain::Edit> edits;
  for (const auto id : outcome->removed) edits.emplace_back(tin::terrain::Remove{id});
  ASSERT_TRUE(result.apply(edits, tin::terrain::Duplicates::kReject).ok());
  EXPECT_EQ(tin::mesh::validate(result.mesh()).value_or(""), "");
  EXPECT_EQ(result.vertex_count(), outcome->report.vertices_after);
  EXPECT_EQ(support::judge(*source, result, 10).value_or(""), "");
}

}  // namespace
