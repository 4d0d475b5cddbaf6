#include "tin/terrain/terrain.h"

#include <gtest/gtest.h>

#include <limits>
#include <map>

#include "tests/support/mesh_view.h"
#include "tests/support/point_sets.h"
#include "tin/mesh/validate.h"

namespace {

using support::Random;
using tin::base::Code;
using tin::exact::kLatticeHalf;
using tin::exact::Point;
using tin::terrain::Change;
using tin::terrain::Duplicates;
using tin::terrain::Edit;
using tin::terrain::Insert;
using tin::terrain::Move;
using tin::terrain::Placement;
using tin::terrain::Remove;
using tin::terrain::SetZ;
using tin::terrain::Terrain;
using tin::terrain::Vertex;
using tin::terrain::VertexId;

std::string broken(const Terrain& t) {
  return tin::mesh::validate(t.mesh()).value_or("");
}

Terrain square() {
  const std::vector<Placement> corners{{{0, 0}, 1}, {{10, 0}, 2}, {{10, 10}, 3}, {{0, 10}, 4}};
  return *Terrain::build({}, corners, Duplicates::kReject);
}

/// All that a client can see of the set: id -> placement.
std::map<std::uint64_t, Placement> contents(const Terrain& t) {
  std::map<std::uint64_t, Placement> out;
  for (auto id = t.ids().first_from(VertexId(0)); id; id = t.ids().first_from(VertexId(id->value() + 1))) {
    const auto vertex = t.vertex(*id);
    out[id->value()] = {vertex->at, vertex->z};
  }
  return out;
}

TEST(TerrainTest, GivesIdsInTheOrderOfThePlacements) {
  const Terrain t = square();
  EXPECT_EQ(t.vertex_count(), 4U);
  EXPECT_EQ(t.triangle_count(), 2U);
  EXPECT_EQ(t.vertex(VertexId(3))->at, (Point{10, 10}));
  EXPECT_EQ(t.vertex(VertexId(3))->z, 3);
  EXPECT_FALSE(t.vertex(VertexId(5)).has_value());
  EXPECT_EQ(broken(t), "");
}

TEST(TerrainTest, AppliesEveryKindOfEditAndUndoesThemAll) {
  Terrain t = square();
  const std::string before = t.digest();
  const std::vector<Edit> edits{Insert{{5, 5}, 9}, SetZ{VertexId(1), 7}, Move{VertexId(5), {4, 6}},
                                Remove{VertexId(2)}};
  const auto applied = t.apply(edits, Duplicates::kReject);
  ASSERT_TRUE(applied.ok());
  EXPECT_EQ(applied->ids, (std::vector<VertexId>{VertexId(5), VertexId(1), VertexId(5), VertexId(2)}));
  EXPECT_EQ(t.vertex(VertexId(5))->at, (Point{4, 6}));
  EXPECT_EQ(t.vertex(VertexId(1))->z, 7);
  EXPECT_FALSE(t.vertex(VertexId(2)).has_value());
  EXPECT_NE(t.digest(), before);
  EXPECT_EQ(broken(t), "");
  ASSERT_TRUE(t.replay(applied->change.inverse()).ok());
  EXPECT_EQ(t.digest(), before);
  EXPECT_EQ(t.vertex(VertexId(2))->at, (Point{10, 0}));
  EXPECT_EQ(broken(t), "");
}

TEST(TerrainTest, ARejectedEditChangesNothing) {
  Terrain t = square();
  const auto before = contents(t);
  const std::string digest = t.digest();
  const auto triangles = support::triangles(t.mesh());
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::vector<std::pair<Edit, Code>> bad{
      {Remove{VertexId(99)}, Code::kUnknownVertex},
      {Move{VertexId(99), {1, 1}}, Code::kUnknownVertex},
      {SetZ{VertexId(99), 1}, Code::kUnknownVertex},
      {SetZ{VertexId(1), nan}, Code::kNotFinite},
      {Insert{{1, 1}, nan}, Code::kNotFinite},
      {Insert{{kLatticeHalf, 0}, 1}, Code::kOutsideLattice},
      {Insert{{0, 0}, 5}, Code::kDuplicatePosition},
      {Move{VertexId(1), {10, 10}}, Code::kDuplicatePosition},
      {Insert{{1, 1}, 1.1e30}, Code::kInvalidValue},
      {SetZ{VertexId(1), -1.1e30}, Code::kInvalidValue},
      {Remove{VertexId(2)}, Code::kUnknownVertex},
      {Move{VertexId(1), {0, -kLatticeHalf - 1}}, Code::kOutsideLattice},
  };
  for (const auto& [edit, code] : bad) {
    const std::vector<Edit> edits{Insert{{3, 4}, 5}, Remove{VertexId(2)}, SetZ{VertexId(4), 40}, edit};
    const auto applied = t.apply(edits, Duplicates::kReject);
    ASSERT_FALSE(applied.ok());
    EXPECT_EQ(applied.error().code, code) << applied.error().message;
    EXPECT_EQ(applied.error().where, "/3");
    EXPECT_EQ(contents(t), before);
    EXPECT_EQ(t.digest(), digest);
    EXPECT_EQ(support::triangles(t.mesh()), triangles);
    EXPECT_EQ(t.next_id(), VertexId(5));
    EXPECT_EQ(broken(t), "");
  }
}

TEST(TerrainTest, DuplicatePoliciesDecideTheElevation) {
  const std::vector<Placement> stacked{{{0, 0}, 4}, {{0, 0}, 10}, {{0, 0}, 1}, {{5, 0}, 0}};
  const auto z = [&](Duplicates policy) {
    const auto t = Terrain::build({}, stacked, policy);
    EXPECT_EQ(t->vertex_count(), 2U);
    return t->vertex(VertexId(1))->z;
  };
  EXPECT_EQ(z(Duplicates::kReplace), 1);
  EXPECT_EQ(z(Duplicates::kKeep), 4);
  EXPECT_EQ(z(Duplicates::kMax), 10);
  EXPECT_EQ(z(Duplicates::kMin), 1);
  EXPECT_EQ(z(Duplicates::kMean), 5);
  const auto rejected = Terrain::build({}, stacked, Duplicates::kReject);
  ASSERT_FALSE(rejected.ok());
  EXPECT_EQ(rejected.error().code, Code::kDuplicatePosition);
  EXPECT_EQ(rejected.error().where, "/1");
}

TEST(TerrainTest, TheMeanOfTheLargestElevationsIsFinite) {
  const std::vector<Placement> stacked{{{0, 0}, -1e30}, {{0, 0}, 1e30}, {{5, 0}, 1e30}};
  EXPECT_EQ(Terrain::build({}, stacked, Duplicates::kMean)->vertex(VertexId(1))->z, 0);
  const std::vector<Placement> beyond{{{0, 0}, -1.7e308}, {{0, 0}, 1.7e308}};
  const auto refused = Terrain::build({}, beyond, Duplicates::kMean);
  ASSERT_FALSE(refused.ok());
  EXPECT_EQ(refused.error().code, Code::kInvalidValue);
}

TEST(TerrainTest, InsertingOnAVertexFollowsThePolicyAndNamesIt) {
  Terrain t = square();
  const std::vector<Edit> edits{Insert{{10, 10}, 30}};
  const auto applied = t.apply(edits, Duplicates::kReplace);
  ASSERT_TRUE(applied.ok());
  EXPECT_EQ(applied->ids[0], VertexId(3));
  EXPECT_EQ(t.vertex(VertexId(3))->z, 30);
  const auto kept = t.apply(edits, Duplicates::kKeep);
  EXPECT_TRUE(kept->change.steps.empty());
  EXPECT_EQ(broken(t), "");
}

TEST(TerrainTest, IdsAreNeverUsedAgain) {
  Terrain t = square();
  const std::vector<Edit> add{Insert{{5, 5}, 1}};
  const auto first = t.apply(add, Duplicates::kReject);
  ASSERT_TRUE(t.apply(std::vector<Edit>{Remove{first->ids[0]}}, Duplicates::kReject).ok());
  const auto second = t.apply(add, Duplicates::kReject);
  EXPECT_NE(first->ids[0], second->ids[0]);
  EXPECT_EQ(broken(t), "");
}

TEST(TerrainTest, DigestDependsOnTheSetAndTheFrameOnly) {
  Random random(support::seed());
  std::vector<Placement> placements;
  for (const Point p : support::random_points(random, 500, 1000))
    placements.push_back({p, double(p.x) - p.y / 3.0});
  const auto one = Terrain::build({}, placements, Duplicates::kReject);
  std::shuffle(placements.begin(), placements.end(), random);
  Terrain other{tin::frame::Frame{}};
  for (const Placement& p : placements)
    ASSERT_TRUE(other.apply(std::vector<Edit>{Insert{p.at, p.z}}, Duplicates::kReject).ok());
  EXPECT_EQ(one->digest(), other.digest());
  EXPECT_EQ(one->digest().size(), 32U);
  tin::frame::Frame elsewhere;
  elsewhere.x.origin = 1;
  EXPECT_NE(Terrain::build(elsewhere, placements, Duplicates::kReject)->digest(), one->digest());
  EXPECT_EQ(broken(other), "");
}

TEST(TerrainTest, RestoreGivesBackIdsAndRefusesNonsense) {
  Terrain t = square();
  ASSERT_TRUE(t.apply(std::vector<Edit>{Remove{VertexId(2)}, Insert{{3, 3}, 8}}, Duplicates::kReject).ok());
  std::vector<Vertex> stored;
  for (const auto& [id, p] : contents(t)) stored.push_back({VertexId(id), p.at, p.z});
  const auto back = Terrain::restore({}, stored, t.next_id());
  ASSERT_TRUE(back.ok());
  EXPECT_EQ(contents(*back), contents(t));
  EXPECT_EQ(back->digest(), t.digest());
  EXPECT_EQ(back->next_id(), t.next_id());
  EXPECT_EQ(broken(*back), "");
  stored.push_back({VertexId(2), {3, 3}, 1});
  EXPECT_FALSE(Terrain::restore({}, stored, t.next_id()).ok());
  stored.back() = {VertexId(1), {4, 4}, 1};
  EXPECT_FALSE(Terrain::restore({}, stored, t.next_id()).ok());
  stored.back() = {t.next_id(), {4, 4}, 1};
  EXPECT_FALSE(Terrain::restore({}, stored, t.next_id()).ok());
}

TEST(TerrainTest, ReplayRefusesAChangeThatDoesNotFit) {
  Terrain t = square();
  const auto before = contents(t);
  Change change;
  change.steps = {{VertexId(9), std::nullopt, Placement{{1, 2}, 3}},
                  {VertexId(1), Placement{{0, 0}, 999}, std::nullopt}};
  const auto result = t.replay(change);
  ASSERT_FALSE(result.ok());
  EXPECT_EQ(result.error().code, Code::kConflict);
  EXPECT_EQ(contents(t), before);
  EXPECT_EQ(broken(t), "");
}

TEST(TerrainTest, RandomHistoriesUndoneStepByStepPassTheSameDigests) {
  Random random(support::seed());
  SCOPED_TRACE("TINSMITH_SEED=" + std::to_string(support::seed()));
  Terrain t = square();
  std::vector<Change> history;
  std::vector<std::string> digests;
  std::uniform_int_distribution<std::int32_t> coordinate(-12, 12);
  for (int round = 0; round < 400; ++round) {
    std::vector<Edit> edits;
    for (int i = 0; i < 4; ++i) {
      const VertexId id(1 + random() % t.next_id().value());
      const Point p{coordinate(random), coordinate(random)};
      switch (random() % 4) {
        case 0:
          edits.push_back(Remove{id});
          break;
        case 1:
          edits.push_back(Move{id, p});
          break;
        case 2:
          edits.push_back(SetZ{id, double(random() % 100)});
          break;
        default:
          edits.push_back(Insert{p, double(random() % 100)});
      }
    }
    const std::string before = t.digest();
    const auto applied = t.apply(edits, Duplicates::kReplace);
    if (!applied.ok()) {
      ASSERT_EQ(t.digest(), before);
      continue;
    }
    digests.push_back(before);
    history.push_back(applied->change);
  }
  ASSERT_GT(history.size(), 20U);
  EXPECT_EQ(broken(t), "");
  while (!history.empty()) {
    ASSERT_TRUE(t.replay(history.back().inverse()).ok());
    ASSERT_EQ(t.digest(), digests.back());
    history.pop_back();
    digests.pop_back();
  }
  EXPECT_EQ(broken(t), "");
}

/// Placements on a grid of side x side, with an elevation of its own for each.
std::vector<Placement> plateau(std::int32_t side) {
  std::vector<Placement> placements;
  for (const Point p : support::grid_points(side, side, 3)) placements.push_back({p, p.x + 0.001 * p.y});
  return placements;
}

TEST(TerrainTest, MassDeletionGivesItsMemoryBackAndKeepsIdsAndElevations) {
  Terrain t = *Terrain::build({}, plateau(160), Duplicates::kReject);
  const std::string before = t.digest();
  std::vector<Edit> edits;
  for (std::uint64_t id = 1; id <= t.vertex_count(); ++id) {
    if (id % 5 != 0) edits.push_back(Remove{VertexId(id)});
  }
  auto expected = contents(t);
  std::erase_if(expected, [](const auto& vertex) { return vertex.first % 5 != 0; });
  const auto applied = t.apply(edits, Duplicates::kReject);
  ASSERT_TRUE(applied.ok());
  EXPECT_EQ(t.mesh().vertex_slots(), t.vertex_count() + 1) << "gaps were left";
  EXPECT_EQ(contents(t), expected);
  EXPECT_EQ(broken(t), "");
  const auto more = t.apply(std::vector<Edit>{Insert{{1, 1}, 5}, SetZ{VertexId(10), 77}}, Duplicates::kReject);
  ASSERT_TRUE(more.ok());
  EXPECT_EQ(t.vertex(VertexId(10))->z, 77);
  t.undo(*more);
  EXPECT_EQ(contents(t), expected);
  t.undo(*applied);
  EXPECT_EQ(t.digest(), before);
  EXPECT_EQ(broken(t), "");
}

TEST(TerrainTest, AnyNumberOfThreadsBuildsTheSameTerrain) {
  const auto placements = plateau(120);
  const Terrain one = *Terrain::build({}, placements, Duplicates::kReject);
  for (const unsigned threads : {2U, 3U}) {
    const Terrain many = *Terrain::build({}, placements, Duplicates::kReject, nullptr, threads);
    EXPECT_EQ(many.digest(), one.digest());
    EXPECT_EQ(contents(many), contents(one));
    const Terrain again = *Terrain::restore({}, one.vertices_by_id(), one.next_id(), threads);
    EXPECT_EQ(contents(again), contents(one));
    EXPECT_EQ(support::triangles(many.mesh()), support::triangles(one.mesh()));
    EXPECT_EQ(broken(many), "");
    EXPECT_EQ(broken(again), "");
  }
}

TEST(SourceGridTest, CellsReachHalfAStepAroundTheirCentres) {
  tin::terrain::SourceGrid grid;
  grid.width = 3;
  grid.height = 2;
  grid.x0 = -10;
  grid.y0 = 10;
  grid.dx = 10;
  grid.dy = -20;
  EXPECT_EQ(grid.cell_at({-15, 20})->column, 0);
  EXPECT_FALSE(grid.cell_at({-16, 20}).has_value());
  EXPECT_EQ(grid.cell_at({-5, 0})->column, 1);
  EXPECT_EQ(grid.cell_at({-6, 0})->row, 1);
  EXPECT_EQ(grid.cell_at({-6, 1})->row, 0);
  EXPECT_FALSE(grid.cell_at({0, -20}).has_value());
  EXPECT_TRUE(grid.cell_centred_at({10, -10}).has_value());
  EXPECT_FALSE(grid.cell_centred_at({10, -9}).has_value());
  grid.valid = {0b101111};
  EXPECT_TRUE(grid.is_valid(0, 1));
  EXPECT_FALSE(grid.is_valid(1, 1));
}

}  // namespace
