// Which samples edits put out of force, and what undoing and simplifications do to that.
#include "tin/terrain/amendments.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <optional>
#include <set>
#include <vector>

#include "tests/support/point_sets.h"
#include "tests/tin/terrain/amendments_oracle.h"
#include "tin/mesh/validate.h"
#include "tin/terrain/terrain.h"

namespace {

using support::Random;
using tests::terrain::Oracle;
using tests::terrain::Surface;
using tin::exact::Point;
using namespace tin::terrain;  // NOLINT: nearly all of it is under test here

constexpr int kSize = 14, kStep = 10;

std::shared_ptr<const SourceGrid> grid() {
  auto out = std::make_shared<SourceGrid>();
  out->width = out->height = kSize;
  out->dx = kStep;
  out->dy = -kStep;
  out->x0 = -kSize / 2 * kStep;
  out->y0 = kSize / 2 * kStep;
  return out;
}

std::set<Point> positions(const SourceSamples& source) {
  std::set<Point> out;
  for (std::size_t i = 0; i < source.size(); ++i) {
    if (source.is_sample(i)) out.insert(source.at(i));
  }
  return out;
}

Point any_position(Random& random) {
  const int reach = kSize / 2 * kStep;
  const auto coordinate = [&] {
    const int c = std::uniform_int_distribution(-reach, reach)(random);
    return random() % 2 == 0 ? c / kStep * kStep : c;  // often a pixel's centre
  };
  const int x = coordinate();
  return {x, coordinate()};
}

std::vector<Edit> any_edits(Random& random, const Terrain& terrain, std::size_t count) {
  const auto vertices = terrain.vertices_by_id();
  std::set<std::uint64_t> used;
  std::vector<Edit> edits;
  std::uint64_t next = terrain.next_id().value();
  while (edits.size() < count) {
    const auto& vertex = vertices[random() % vertices.size()];
    const double z = static_cast<double>(random() % 1000000) + 0.5;  // never what it was
    const auto kind = random() % 4;
    if (kind > 0 && !used.insert(vertex.id.value()).second) continue;
    if (kind == 0) {
      edits.emplace_back(Insert{any_position(random), z});
      const VertexId inserted(next++);
      const auto then = random() % 8;
      if (then == 0) edits.emplace_back(Remove{inserted});
      if (then == 1) edits.emplace_back(Move{inserted, any_position(random)});
      if (then == 2) edits.emplace_back(SetZ{inserted, z + 1});
    }
    if (kind == 1) edits.emplace_back(SetZ{vertex.id, z});
    if (kind == 2) edits.emplace_back(Remove{vertex.id});
    if (kind == 3) edits.emplace_back(Move{vertex.id, any_position(random)});
  }
  return edits;
}

struct Case {
  SourceSamples source;
  Terrain terrain;
};

/// A random surface, and a terrain that has some of its samples as vertices, as after a simplification.
Case thinned(Random& random, bool raster) {
  std::vector<Placement> all;
  std::vector<double> heights;
  const auto g = grid();
  for (int row = 0; row < kSize; ++row) {
    for (int column = 0; column < kSize; ++column) {
      heights.push_back(static_cast<double>(random() % 50));
      all.push_back({g->centre(column, row), heights.back()});
    }
  }
  std::vector<Placement> kept{all.front(), all[kSize - 1], all[all.size() - kSize], all.back()};
  for (const Placement& sample : all) {
    if (random() % 8 == 0) kept.push_back(sample);
  }
  Case out{raster ? SourceSamples::raster(g, heights) : SourceSamples::points(all),
           *Terrain::build({}, kept, Duplicates::kKeep)};
  if (raster) out.terrain.set_source_grid(g);
  Amendments amendments(raster ? SourceKind::kRaster : SourceKind::kPoints);
  amendments.set_thinned();
  out.terrain.set_amendments(amendments);
  return out;
}

/// Takes some vertices away, none of them from the outline, and gives others another height.
Change any_simplification(Random& random, const Terrain& terrain) {
  std::vector<tin::mesh::HalfEdge> link;
  terrain.mesh().link(tin::mesh::kInfinite, link);
  std::set<Point> outline;
  for (const auto e : link) outline.insert(terrain.mesh().point(terrain.mesh().origin(e)));
  Change out{{}, Cause::kSimplification};
  for (const Vertex& vertex : terrain.vertices_by_id()) {
    if (outline.contains(vertex.at)) continue;
    const Placement before{vertex.at, vertex.z};
    const auto kind = random() % 8;
    if (kind == 0) out.steps.push_back({vertex.id, before, std::nullopt});
    if (kind == 1) out.steps.push_back({vertex.id, before, Placement{vertex.at, vertex.z + 0.25}});
  }
  return out;
}

/// A terrain without a source, some of whose vertices a simplification took away.
Terrain simplified_without_source(Random& random) {
  std::vector<Placement> all;
  for (int i = 0; i < kSize * kSize; ++i)
    all.push_back({grid()->centre(i % kSize, i / kSize), static_cast<double>(random() % 50)});
  Terrain terrain = *Terrain::build({}, all, Duplicates::kReject);
  const Change simplification = any_simplification(random, terrain);
  EXPECT_TRUE(terrain.replay(simplification).ok());
  terrain.amend(simplification);
  return terrain;
}

/// A thinned terrain, all that happens to it, and what the oracle makes of that.
class Story {
 public:
  explicit Story(std::uint32_t seed) : random_(seed) {
    if (seed % 3 == 0) {
      terrain_.emplace(simplified_without_source(random_));
    } else {
      Case one = thinned(random_, seed % 3 == 1);
      terrain_.emplace(std::move(one.terrain));
      source_.emplace(std::move(one.source));
    }
    start_.emplace(*terrain_);
    std::map<Point, double> nobodys;
    if (source_) {
      for (std::size_t i = 0; i < source_->size(); ++i) nobodys.emplace(source_->at(i), source_->z(i));
    } else {
      for (const Vertex& vertex : terrain_->vertices_by_id()) nobodys.emplace(vertex.at, vertex.z);
      for (const Placement& sample : terrain_->amendments().own_in_force(*terrain_)) nobodys[sample.at] = sample.z;
    }
    oracle_.emplace(std::move(nobodys));
  }

  void go_on() {
    switch (log_.empty() ? 0 : random_() % 8) {
      case 0:
      case 1:
      case 2:
        return edit();
      case 3:
        return perform(any_simplification(random_, *terrain_));
      default:
        return perform(log_[random_() % log_.size()].inverse());
    }
  }

  void expect_right() const {
    const Amendments& amendments = terrain_->amendments();
    const Surface now(*terrain_);
    std::set<Point> nobodys = oracle_->nobodys_in_force(now);
    std::map<Point, double> peoples = oracle_->peoples_in_force(now), own, standing;
    for (const Vertex& vertex : terrain_->vertices_by_id()) standing.emplace(vertex.at, vertex.z);
    for (const Placement& sample : amendments.own_in_force(*terrain_)) {
      ASSERT_TRUE(own.empty() || own.rbegin()->first < sample.at);
      own.emplace(sample.at, sample.z);
    }
    if (source_) {
      const auto found = positions(amendments.in_force(*source_, *terrain_));
      for (const Point p : found) ASSERT_TRUE(nobodys.contains(p)) << p.x << ", " << p.y << " is in force still";
      for (const Point p : nobodys) ASSERT_TRUE(found.contains(p)) << p.x << ", " << p.y << " is not in force";
      for (const auto& [p, z] : own) ASSERT_FALSE(found.contains(p)) << p.x << ", " << p.y << " is a sample twice";
    } else {
      for (const Point p : nobodys) ASSERT_TRUE(own.contains(p) || standing.contains(p)) << p.x << ", " << p.y;
    }
    for (const auto& [p, z] : own) {
      const auto expected = peoples.find(p);
      ASSERT_TRUE(expected != peoples.end() ? expected->second == z : !source_ && nobodys.contains(p))
          << p.x << ", " << p.y << " is " << z;
    }
    for (const auto& [p, z] : peoples) {
      const auto found = own.contains(p) ? own.find(p) : standing.find(p);
      ASSERT_TRUE(found != own.end() && found != standing.end() && found->second == z) << p.x << ", " << p.y << " is not " << z;
    }
  }

  /// Who replays all of it comes to the same, and so does who took it up in between.
  void expect_replayed() {
    Terrain again = *start_;
    for (const Change& change : log_) {
      ASSERT_TRUE(again.replay(change).ok());
      again.amend(change);
      if (random_() % 4 == 0) again.set_amendments(Amendments(again.amendments().parts()));
    }
    EXPECT_EQ(again.amendments(), terrain_->amendments());
    ASSERT_EQ(tin::mesh::validate(terrain_->mesh()).value_or(""), "");
  }

  int undone() const { return undone_; }

 private:
  void edit() {
    Terrain tried = *terrain_;
    const auto applied = tried.apply(any_edits(random_, tried, 1 + random_() % 5), Duplicates::kReplace);
    if (applied) perform(applied->change);  // else a move onto another vertex
  }

  void perform(const Change& change) {
    const Surface before(*terrain_);
    if (!terrain_->replay(change).ok()) return;  // another change came in between
    terrain_->amend(change);
    log_.push_back(change);
    const Surface after(*terrain_);
    if (change.cause == Cause::kEdit) oracle_->edit(before, after, change);
    if (change.cause == Cause::kUndo) oracle_->undo(before, after, change);
    if (change.cause == Cause::kSimplification || change.cause == Cause::kRevert) oracle_->simplification(change);
    undone_ += change.cause == Cause::kUndo ? 1 : 0;
  }

  Random random_;
  std::optional<Terrain> terrain_, start_;
  std::optional<SourceSamples> source_;
  std::optional<Oracle> oracle_;
  std::vector<Change> log_;
  int undone_ = 0;
};

/// Edits, simplifications, and the undoing of any of them, and of any undoing, once or again.
TEST(AmendmentsTest, WhatIsInForceFollowsFromTheEditsThatStand) {
  int undone = 0;
  for (std::uint32_t seed = 1; seed <= 400; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Story story(seed);
    for (int round = 0; round < 30; ++round) {
      story.go_on();
      ASSERT_NO_FATAL_FAILURE(story.expect_right());
    }
    ASSERT_NO_FATAL_FAILURE(story.expect_replayed());
    undone += story.undone();
  }
  EXPECT_GT(undone, 200);
}

TEST(AmendmentsTest, APersonsSampleComesBackOnlyWhenNoEditThatStandsHoldsIt) {
  Terrain terrain = *Terrain::build(
      {}, std::vector<Placement>{{{0, 0}, 1}, {{90, 0}, 1}, {{0, 90}, 1}, {{20, 20}, 1}}, Duplicates::kReject);
  const Change simplification{{{VertexId(4), Placement{{20, 20}, 1}, std::nullopt}}, Cause::kSimplification};
  ASSERT_TRUE(terrain.replay(simplification).ok());
  terrain.amend(simplification);
  std::vector<Change> edits;
  for (const VertexId corner : {VertexId(1), VertexId(2)}) {
    edits.push_back(terrain.apply(std::vector<Edit>{SetZ{corner, 7}}, Duplicates::kReject)->change);
    terrain.amend(edits.back());
    EXPECT_TRUE(terrain.amendments().own_in_force(terrain).empty());
  }
  ASSERT_TRUE(terrain.replay(edits[0].inverse()).ok());
  terrain.amend(edits[0].inverse());
  EXPECT_TRUE(terrain.amendments().own_in_force(terrain).empty()) << "the other edit bends the triangle around it, too";
  ASSERT_TRUE(terrain.replay(edits[1].inverse()).ok());
  terrain.amend(edits[1].inverse());
  ASSERT_EQ(terrain.amendments().own_in_force(terrain).size(), 1U);
  EXPECT_EQ(terrain.amendments().own_in_force(terrain)[0], (Placement{{20, 20}, 1}));
}

TEST(AmendmentsTest, WithoutASourceWhatHoldsUpAnEditedAreaIsKnownToo) {
  Random random(5);
  Terrain terrain = simplified_without_source(random);
  const VertexId some = terrain.vertices_by_id()[40].id;
  const auto edit = terrain.apply(std::vector<Edit>{SetZ{some, 70}}, Duplicates::kReject)->change;
  terrain.amend(edit);
  const auto rim = terrain.amendments().rim(terrain);
  EXPECT_GE(rim.size(), 3U);
  EXPECT_FALSE(std::binary_search(rim.begin(), rim.end(), terrain.vertex(some)->at));
  ASSERT_TRUE(terrain.replay(edit.inverse()).ok());
  terrain.amend(edit.inverse());
  EXPECT_TRUE(terrain.amendments().rim(terrain).empty());
}

TEST(AmendmentsTest, WhatHoldsUpAnEditedAreaIsItsCornersButForWhatWasTouched) {
  Random random(11);
  auto [source, terrain] = thinned(random, true);
  EXPECT_TRUE(terrain.amendments().rim(terrain).empty());
  std::vector<tin::mesh::HalfEdge> link;
  std::vector<Point> around;
  const auto slot = *terrain.slot_of(VertexId(9));
  terrain.mesh().link(slot, link);
  for (const auto e : link) {
    if (terrain.mesh().origin(e) != tin::mesh::kInfinite) around.push_back(terrain.mesh().point(terrain.mesh().origin(e)));
  }
  std::sort(around.begin(), around.end());
  terrain.amend(terrain.apply(std::vector<Edit>{SetZ{VertexId(9), 70}}, Duplicates::kReject)->change);
  EXPECT_EQ(terrain.amendments().rim(terrain), around);
  // A vertex off the pixels is somebody's, and so is one that was touched.
  terrain.amend(terrain.apply(std::vector<Edit>{Insert{{3, 4}, 90}}, Duplicates::kReject)->change);
  for (const Point p : terrain.amendments().rim(terrain)) {
    EXPECT_NE(p, (Point{3, 4}));
    EXPECT_NE(p, terrain.vertex(VertexId(9))->at);
  }
}

TEST(AmendmentsTest, OnATerrainWithAllItsSamplesOnlyWhatWasTouchedGoes) {
  std::vector<double> heights(kSize * kSize, 1.0);
  const auto source = SourceSamples::raster(grid(), heights);
  std::vector<Placement> all;
  for (std::size_t i = 0; i < source.size(); ++i) all.push_back({source.at(i), source.z(i)});
  Terrain terrain = *Terrain::build({}, all, Duplicates::kReject);
  terrain.set_source_grid(grid());
  terrain.set_amendments(Amendments(SourceKind::kRaster));
  const std::vector<Edit> edits{Insert{{3, 4}, 9}, SetZ{VertexId(40), 7}, Remove{VertexId(100)}};
  terrain.amend(terrain.apply(edits, Duplicates::kReject)->change);
  const auto left = terrain.amendments().in_force(source, terrain);
  EXPECT_EQ(left.sample_count(), source.sample_count() - 2);
  EXPECT_FALSE(left.find(source.at(39)).has_value());
  EXPECT_FALSE(left.find(source.at(99)).has_value());
  EXPECT_TRUE(terrain.amendments().areas().empty());
}

TEST(AmendmentsTest, ASimplificationTakesNothingOutOfForceAndPeoplesVerticesStaySamples) {
  Random random(7);
  auto [source, terrain] = thinned(random, true);
  const std::vector<Edit> edits{Insert{{3, 4}, 90}, SetZ{VertexId(1), 70}};
  terrain.amend(terrain.apply(edits, Duplicates::kReject)->change);
  const auto before = positions(terrain.amendments().in_force(source, terrain));
  const VertexId added(terrain.next_id().value() - 1);
  Change simplification;
  simplification.cause = Cause::kSimplification;
  for (const VertexId id : {added, VertexId(9)}) {
    simplification.steps.push_back(
        {id, Placement{terrain.vertex(id)->at, terrain.vertex(id)->z}, std::nullopt});
  }
  ASSERT_TRUE(terrain.replay(simplification).ok());
  terrain.amend(simplification);
  EXPECT_EQ(positions(terrain.amendments().in_force(source, terrain)), before);
  ASSERT_EQ(terrain.amendments().own_in_force(terrain).size(), 1U) << "vertex 9 is the source's, not people's";
  EXPECT_EQ(terrain.amendments().own_in_force(terrain)[0], (Placement{{3, 4}, 90}));
  // Who edits there again has the last word.
  terrain.amend(terrain.apply(std::vector<Edit>{Insert{{4, 4}, 10}}, Duplicates::kReject)->change);
  EXPECT_TRUE(terrain.amendments().own_in_force(terrain).empty());
}

TEST(AmendmentsTest, ASimplificationThatIsDoneAgainLeavesWhatItTakesASample) {
  Random random(7);
  auto [source, terrain] = thinned(random, true);
  const auto perform = [&terrain = terrain](const Change& change) {
    ASSERT_TRUE(terrain.replay(change).ok());
    terrain.amend(change);
  };
  const Change edit = terrain.apply(std::vector<Edit>{Insert{{3, 4}, 90}}, Duplicates::kReject)->change;
  terrain.amend(edit);
  const Change simplification{{{edit.steps[0].id, edit.steps[0].after, std::nullopt}}, Cause::kSimplification};
  perform(simplification);
  perform(simplification.inverse());
  perform(edit.inverse());
  EXPECT_TRUE(terrain.amendments().own_in_force(terrain).empty());
  perform(edit.inverse().inverse());
  perform(simplification.inverse().inverse());
  EXPECT_EQ(terrain.amendments().own_in_force(terrain), (std::vector<Placement>{{{3, 4}, 90}}));
}

TEST(AmendmentsTest, WhoUndoesWhatIsUndoneAlreadyEdits) {
  Random random(7);
  auto [source, terrain] = thinned(random, true);
  const Placement was{terrain.vertex(VertexId(9))->at, terrain.vertex(VertexId(9))->z};
  const auto change = [&, &terrain = terrain](double from, double to, Cause cause) {
    const Change out{{{VertexId(9), Placement{was.at, from}, Placement{was.at, to}}}, cause};
    ASSERT_TRUE(terrain.replay(out).ok());
    terrain.amend(out);
  };
  change(was.z, 20, Cause::kEdit);
  change(20, was.z, Cause::kEdit);
  change(was.z, 20, Cause::kUndo);
  change(20, was.z, Cause::kUndo);
  EXPECT_TRUE(terrain.amendments().touched().empty());
  change(was.z, 20, Cause::kUndo);  // once more
  EXPECT_EQ(terrain.amendments().touched(), std::vector<Point>{was.at});
}

TEST(AmendmentsTest, WithoutASourceEveryVertexThatASimplificationTakesStaysASample) {
  Terrain terrain = *Terrain::build(
      {}, std::vector<Placement>{{{0, 0}, 1}, {{9, 0}, 1}, {{0, 9}, 1}, {{2, 2}, 1}}, Duplicates::kReject);
  Change simplification{{{VertexId(4), Placement{{2, 2}, 1}, std::nullopt}}, Cause::kSimplification};
  ASSERT_TRUE(terrain.replay(simplification).ok());
  terrain.amend(simplification);
  ASSERT_EQ(terrain.amendments().own_in_force(terrain).size(), 1U);
  Change revert = simplification.inverse();
  EXPECT_EQ(revert.cause, Cause::kRevert);
  ASSERT_TRUE(terrain.replay(revert).ok());
  terrain.amend(revert);
  EXPECT_EQ(terrain.amendments().own_in_force(terrain).size(), 1U) << "the same sample, as a vertex";
  EXPECT_EQ(terrain.vertex_count(), 4U);
}

TEST(AmendmentsTest, ManyTouchedPositionsAreListedOnceEachAndOldEditsTakeNoRoom) {
  Amendments amendments(SourceKind::kPoints);
  Terrain terrain{tin::frame::Frame{}};
  std::set<Point> expected;
  Random random(11);
  const auto touch = [&](Point p) {
    amendments.take(terrain, Change{{{VertexId(1), Placement{p, 0}, std::nullopt}}});
    expected.insert(p);
  };
  for (int i = 0; i < 400'000; ++i) touch({static_cast<int>(random() % 60), static_cast<int>(random() % 60)});
  const auto touched = amendments.touched();
  EXPECT_TRUE(std::equal(touched.begin(), touched.end(), expected.begin(), expected.end()));
  EXPECT_LT(amendments.bytes(), 16'000'000U);
  touch({100, 100});
  const Change undo = Change{{{VertexId(1), Placement{{100, 100}, 0}, std::nullopt}}}.inverse();
  amendments.take(terrain, undo);
  EXPECT_EQ(amendments.touched().size(), touched.size());
}

}  // namespace
