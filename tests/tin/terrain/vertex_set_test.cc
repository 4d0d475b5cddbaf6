// What changes make of a set of vertices must be what they make of a terrain.
#include "tin/terrain/vertex_set.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <iostream>
#include <random>

#include "tin/mesh/validate.h"

namespace tin::terrain {
namespace {

std::uint64_t chosen_seed() {
  const char* given = std::getenv("TINSMITH_SEED");
  const std::uint64_t seed = given != nullptr ? std::strtoull(given, nullptr, 10) : std::random_device{}();
  std::cout << "TINSMITH_SEED=" << seed << std::endl;
  return seed;
}

Terrain small_terrain() {
  std::vector<Placement> placements;
  for (int y = 0; y < 12; ++y) {
    for (int x = 0; x < 12; ++x) placements.push_back({{x * 100, y * 100}, double(x * y)});
  }
  return *Terrain::build({}, placements, Duplicates::kReject);
}

TEST(VertexSetTest, FollowsATerrainThroughAnyHistory) {
  std::mt19937_64 random(chosen_seed());
  const auto below = [&](std::uint64_t bound) { return random() % bound; };
  Terrain terrain = small_terrain();
  VertexSet set(terrain.vertices_by_id(), terrain.next_id());
  for (int step = 0; step < 400; ++step) {
    std::vector<Edit> edits;
    for (std::uint64_t i = 0; i <= below(5); ++i) {
      const exact::Point at{static_cast<std::int32_t>(below(1300)), static_cast<std::int32_t>(below(1300))};
      const VertexId id(1 + below(terrain.next_id().value()));
      switch (below(4)) {
        case 0:
          edits.emplace_back(Insert{at, double(below(9))});
          break;
        case 1:
          edits.emplace_back(Remove{id});
          break;
        case 2:
          edits.emplace_back(Move{id, at});
          break;
        default:
          edits.emplace_back(SetZ{id, double(below(9))});
      }
    }
    const auto applied = terrain.apply(edits, Duplicates::kReplace);
    if (!applied) continue;
    ASSERT_TRUE(set.replay(applied->change).ok());
  }
  const auto vertices = set.vertices();
  const auto expected = terrain.vertices_by_id();
  ASSERT_EQ(vertices.size(), expected.size());
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    EXPECT_EQ(vertices[i].id, expected[i].id);
    EXPECT_EQ(vertices[i].at, expected[i].at);
    EXPECT_EQ(vertices[i].z, expected[i].z);
  }
  EXPECT_EQ(set.next_id(), terrain.next_id());
  EXPECT_EQ(digest_of(vertices, terrain.frame()), terrain.digest());
  EXPECT_EQ(mesh::validate(terrain.mesh()), std::nullopt);
}

TEST(VertexSetTest, AChangeThatDoesNotFitIsToldWithItsPlace) {
  const Terrain terrain = small_terrain();
  VertexSet set(terrain.vertices_by_id(), terrain.next_id());
  const Placement there{{0, 0}, 0}, other{{0, 0}, 5};
  const auto wrong = set.replay({{{VertexId(1), there, other}, {VertexId(1), there, std::nullopt}}});
  ASSERT_FALSE(wrong.ok());
  EXPECT_EQ(wrong.error().code, base::Code::kConflict);
  EXPECT_EQ(wrong.error().where, "/1");
}

}  // namespace
}  // namespace tin::terrain
