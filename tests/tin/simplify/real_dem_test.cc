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

using tin::simplify::simplify;
using tin::terrain::Terrain;

std::string folder() {
  const char* const named = std::getenv("TINSMITH_TERRAIN");
  return named != nullptr ? named : TINSMITH_DEFAULT_TERRAIN;
}

struct Goal {
  const char* tile;
  double south;
  double tolerance;
  std::size_t fewer_than;  // vertices that greedy insertion alone needs (fogleman/hmm)
};

class RealDemTest : public testing::TestWithParam<Goal> {};

TEST_P(RealDemTest, NeedsFewerVerticesThanGreedyInsertion) {
  const auto [tile, south, tolerance, fewer_than] = GetParam();
  const auto source = support::hgt_terrain(folder() + "/" + tile + ".hgt", south);
  if (!source) GTEST_SKIP() << "no " << tile << ".hgt in " << folder();
  const auto outcome = simplify(*source, {.tolerance = tolerance, .max_vertices = {}}, nullptr);
  ASSERT_TRUE(outcome.ok());
  EXPECT_LT(outcome->report.vertices_after, fewer_than);
  EXPECT_LE(outcome->report.max_error, tolerance);
  EXPECT_EQ(outcome->report.vertices_after + outcome->removed.size(), 1201U * 1201U);
}

#ifdef NDEBUG
INSTANTIATE_TEST_SUITE_P(Tiles, RealDemTest,
                         testing::Values(Goal{"N51E001", 51, 10, 6368}, Goal{"N44W072", 44, 10, 118851},
                                         Goal{"N44W072", 44, 5, 272022}, Goal{"N53E027", 53, 10, 26059}));
#else
INSTANTIATE_TEST_SUITE_P(Tiles, RealDemTest, testing::Values(Goal{"N51E001", 51, 10, 6368}));
#endif

TEST(RealDemCropTest, EverySampleIsWithinTheToleranceOnceTheVerticesAreRemoved) {
  const auto source = support::hgt_terrain(folder() + "/N44W072.hgt", 44, 150);
  if (!source) GTEST_SKIP() << "no N44W072.hgt in " << folder();
  const auto outcome = simplify(*source, {.tolerance = 10, .max_vertices = {}}, nullptr);
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
