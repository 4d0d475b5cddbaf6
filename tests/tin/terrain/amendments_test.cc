// Which samples an edit puts out of force, against an oracle that compares the surface before and after,
// triangle by triangle.
#include "tin/terrain/amendments.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <map>
#include <set>
#include <vector>

#include "tests/support/point_sets.h"
#include "tin/exact/predicates.h"
#include "tin/mesh/validate.h"
#include "tin/terrain/terrain.h"

namespace {

using support::Random;
using tin::exact::orientation;
using tin::exact::Point;
using tin::mesh::TriangleSlot;
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

using Corner = std::pair<Point, double>;
using Facet = std::array<Corner, 3>;   // sorted
using Border = std::array<Corner, 2>;  // sorted

struct Surface {
  std::set<Facet> facets;
  std::set<Border> borders;

  explicit Surface(const Terrain& t) {
    const auto& mesh = t.mesh();
    if (mesh.dimension() < 2) return;
    for (std::uint32_t i = 0; i < mesh.triangle_slots(); ++i) {
      if (!mesh.is_alive(TriangleSlot(i))) continue;
      std::vector<Corner> corners;
      for (const auto v : mesh.triangle(TriangleSlot(i)).vertices) {
        if (v != tin::mesh::kInfinite) corners.emplace_back(mesh.point(v), t.z(v));
      }
      std::sort(corners.begin(), corners.end());
      if (corners.size() == 3) {
        facets.insert({corners[0], corners[1], corners[2]});
      } else {
        borders.insert({corners[0], corners[1]});
      }
    }
  }
};

bool holds(const Facet& f, Point p) {
  std::array<Point, 3> c{f[0].first, f[1].first, f[2].first};
  if (orientation(c[0], c[1], c[2]) < 0) std::swap(c[1], c[2]);
  return orientation(c[0], c[1], p) >= 0 && orientation(c[1], c[2], p) >= 0 &&
         orientation(c[2], c[0], p) >= 0;
}

bool holds(const Border& b, Point p) {
  return orientation(b[0].first, b[1].first, p) == 0 && b[0].first < p && p < b[1].first;
}

/// Follows edits by the words of the rule.
class Oracle {
 public:
  explicit Oracle(const SourceSamples& source) {
    for (std::size_t i = 0; i < source.size(); ++i) {
      if (source.is_sample(i)) in_force_.insert(source.at(i));
    }
  }

  void follow(const Surface& before, const Surface& after, const Change& change) {
    std::set<Point> corners, touched;
    for (const Facet& f : after.facets) {
      for (const Corner& c : f) corners.insert(c.first);
    }
    for (const Step& step : change.steps) {
      if (step.before) touched.insert(step.before->at);
      if (step.after) touched.insert(step.after->at);
    }
    std::erase_if(in_force_, [&](Point p) {
      if (touched.contains(p)) return true;
      bool covered = false;
      for (const Facet& f : after.facets) {
        if (!holds(f, p)) continue;
        if (corners.contains(p) || before.facets.contains(f)) return false;
        covered = true;
      }
      return covered && std::none_of(after.borders.begin(), after.borders.end(), [&](const Border& b) {
               return holds(b, p) && before.borders.contains(b);
             });
    });
  }

  std::set<Point> in_force(const Surface& now, bool edited) const {
    std::set<Point> out;
    for (const Point p : in_force_) {
      const bool covered =
          std::any_of(now.facets.begin(), now.facets.end(), [p](const Facet& f) { return holds(f, p); });
      if (covered || !edited) out.insert(p);
    }
    return out;
  }

 private:
  std::set<Point> in_force_;
};

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
  while (edits.size() < count) {
    const auto& vertex = vertices[random() % vertices.size()];
    const double z = static_cast<double>(random() % 1000000) + 0.5;  // never what it was
    const auto kind = random() % 4;
    if (kind > 0 && !used.insert(vertex.id.value()).second) continue;
    if (kind == 0) edits.emplace_back(Insert{any_position(random), z});
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

TEST(AmendmentsTest, EditsPutOutOfForceWhatTheirAreaHoldsAndNothingElse) {
  for (std::uint32_t seed = 1; seed <= 120; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(seed);
    auto [source, terrain] = thinned(random, seed % 2 == 0);
    Oracle oracle(source);
    bool edited = false;
    for (int round = 0; round < 6; ++round) {
      const Surface before(terrain);
      const auto applied = terrain.apply(any_edits(random, terrain, 1 + random() % 5), Duplicates::kReplace);
      if (!applied) continue;  // a move onto another vertex
      terrain.amend(applied->change);
      edited = true;
      const Surface after(terrain);
      oracle.follow(before, after, applied->change);
      const auto found = positions(terrain.amendments().in_force(source, terrain));
      const auto expected = oracle.in_force(after, edited);
      for (const Point p : found) ASSERT_TRUE(expected.contains(p)) << p.x << ", " << p.y << " is in force still";
      for (const Point p : expected) ASSERT_TRUE(found.contains(p)) << p.x << ", " << p.y << " is not in force";
    }
    ASSERT_EQ(tin::mesh::validate(terrain.mesh()).value_or(""), "");
  }
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
  ASSERT_EQ(terrain.amendments().own().size(), 1U) << "vertex 9 is the source's, not people's";
  EXPECT_EQ(terrain.amendments().own()[0], (Placement{{3, 4}, 90}));
  // Who edits there again has the last word.
  terrain.amend(terrain.apply(std::vector<Edit>{Insert{{4, 4}, 10}}, Duplicates::kReject)->change);
  EXPECT_TRUE(terrain.amendments().own().empty());
}

TEST(AmendmentsTest, WithoutASourceEveryVertexThatASimplificationTakesStaysASample) {
  Terrain terrain = *Terrain::build(
      {}, std::vector<Placement>{{{0, 0}, 1}, {{9, 0}, 1}, {{0, 9}, 1}, {{2, 2}, 1}}, Duplicates::kReject);
  Change simplification{{{VertexId(4), Placement{{2, 2}, 1}, std::nullopt}}, Cause::kSimplification};
  ASSERT_TRUE(terrain.replay(simplification).ok());
  terrain.amend(simplification);
  ASSERT_EQ(terrain.amendments().own().size(), 1U);
  Change revert = simplification.inverse();
  EXPECT_EQ(revert.cause, Cause::kRevert);
  ASSERT_TRUE(terrain.replay(revert).ok());
  terrain.amend(revert);
  EXPECT_EQ(terrain.amendments().own().size(), 1U) << "the same sample, as a vertex";
  EXPECT_EQ(terrain.vertex_count(), 4U);
}

TEST(AmendmentsTest, ManyTouchedPositionsAreListedOnceEach) {
  Amendments amendments(SourceKind::kPoints);
  Terrain terrain{tin::frame::Frame{}};
  std::set<Point> expected;
  Random random(11);
  for (int i = 0; i < 6000; ++i) {
    const Point p{static_cast<int>(random() % 60), static_cast<int>(random() % 60)};
    amendments.take(terrain, Change{{{VertexId(1), Placement{p, 0}, std::nullopt}}});
    expected.insert(p);
  }
  const auto touched = amendments.touched();
  EXPECT_TRUE(std::equal(touched.begin(), touched.end(), expected.begin(), expected.end()));
  EXPECT_LT(amendments.bytes(), 100'000U);
}

}  // namespace
