#include "tin/query/contour.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "tests/tin/query/analytic.h"
#include "tin/mesh/validate.h"
#include "tin/query/elevation.h"

namespace {

using tin::base::Code;
using tin::exact::Point;
using tin::frame::Place;
using tin::query::contour_levels;
using tin::query::ContourLine;
using tin::query::ContourOptions;
using tin::query::ContourTracer;
using tin::query::PlaceBox;
using tin::query::Voids;
using tin::terrain::Duplicates;
using tin::terrain::Edit;
using tin::terrain::Insert;
using tin::terrain::Terrain;

std::vector<ContourLine> contours(const Terrain& terrain, const std::vector<double>& levels,
                                  const ContourOptions& options = {}) {
  ContourTracer tracer(terrain, levels, options);
  std::vector<ContourLine> out;
  for (ContourLine line; tracer.next(line);) out.push_back(line);
  EXPECT_EQ(tracer.fraction(), 1);
  return out;
}

/// Segments as (from, to), rounded so that both sides of the comparison agree on a key.
using Segments = std::multiset<std::array<std::int64_t, 4>>;
std::array<std::int64_t, 4> key(Place a, Place b) {
  const auto round = [](double v) { return static_cast<std::int64_t>(std::llround(v * 1024)); };
  return {round(a.x), round(a.y), round(b.x), round(b.y)};
}

Segments segments_of(const std::vector<ContourLine>& lines) {
  Segments out;
  for (const ContourLine& line : lines) {
    for (std::size_t i = 1; i < line.places.size(); ++i) {
      const auto k = key(line.places[i - 1], line.places[i]);
      if (k[0] != k[2] || k[1] != k[3]) out.insert(k);
    }
  }
  return out;
}

/// What each triangle has of a level, found from its corners alone: from the edge that rises on the right to
/// that on the left.
Segments expected_segments(const Terrain& terrain, double level) {
  Segments out;
  const auto& mesh = terrain.mesh();
  for (std::uint32_t i = 0; i < mesh.triangle_slots(); ++i) {
    const tin::mesh::TriangleSlot t(i);
    if (mesh.dimension() < 2 || !mesh.is_alive(t) || mesh.is_infinite(t)) continue;
    std::optional<Place> in, out_at;
    for (int k = 0; k < 3; ++k) {
      const auto u = mesh.vertex(t, k), v = mesh.vertex(t, (k + 1) % 3);
      const double zu = terrain.z(u), zv = terrain.z(v);
      if ((zu >= level) == (zv >= level)) continue;
      const double part = (level - zu) / (zv - zu);
      const Point p = mesh.point(u), q = mesh.point(v);
      const Place at{p.x + part * (double(q.x) - p.x), p.y + part * (double(q.y) - p.y)};
      (zu >= level ? in : out_at) = at;
    }
    if (!in || !out_at) continue;
    const auto k = key(*in, *out_at);
    if (k[0] != k[2] || k[1] != k[3]) out.insert(k);
  }
  return out;
}

void expect_complete(const Terrain& terrain, double level, const std::string& name) {
  const auto lines = contours(terrain, {level});
  const Segments found = segments_of(lines), expected = expected_segments(terrain, level);
  EXPECT_EQ(found.size(), expected.size()) << name;
  // Rounding may differ by one part in 1024 of a step.
  std::size_t missing = 0;
  for (const auto& k : expected) {
    missing += std::none_of(
        found.lower_bound({k[0] - 1, INT64_MIN, 0, 0}),
        found.upper_bound({k[0] + 1, INT64_MAX, INT64_MAX, INT64_MAX}), [&](const auto& f) {
          return std::abs(f[1] - k[1]) <= 1 && std::abs(f[2] - k[2]) <= 1 && std::abs(f[3] - k[3]) <= 1;
        });
  }
  EXPECT_EQ(missing, 0U) << name;
  // Joined: the lines are maximal, so no two of them meet end to start, unless at a vertex on the level.
  for (const ContourLine& line : lines) {
    ASSERT_GE(line.places.size(), 2U);
    EXPECT_EQ(line.closed, line.places.front() == line.places.back()) << name;
  }
}

TEST(ContourTest, HasTheSegmentOfEveryTriangleOnHardSets) {
  support::Random random(support::seed());
  SCOPED_TRACE("TINSMITH_SEED=" + std::to_string(support::seed()));
  std::uniform_real_distribution<double> height(0, 50);
  std::uniform_int_distribution<int> whole(0, 6);
  for (const auto& set : support::hard_sets(random, 200)) {
    if (set.name.find("corner") != std::string::npos) continue;  // beyond what the keys resolve
    const Terrain rough = support::terrain_of(set.points, [&](Point) { return height(random); });
    expect_complete(rough, 25, set.name);
    // Many vertices exactly on the level, and level triangles.
    const Terrain steps = support::terrain_of(set.points, [&](Point) { return double(whole(random)); });
    for (const double level : {1.0, 3.0, 6.0}) expect_complete(steps, level, set.name + " in steps");
  }
}

TEST(ContourTest, OfAPlaneAreStraightAndEndAtTheHull) {
  const Terrain terrain =
      support::terrain_of(support::grid_points(11, 11, 10), [](Point p) { return double(p.x); });
  const auto lines = contours(terrain, {5, 30, 99.5});
  ASSERT_EQ(lines.size(), 3U);
  for (const ContourLine& line : lines) {
    EXPECT_FALSE(line.closed);
    for (const Place& p : line.places) EXPECT_NEAR(p.x, line.level, 1e-12);
    // East is higher, so the line runs south, with it on the left.
    EXPECT_EQ(line.places.front().y, 100);
    EXPECT_EQ(line.places.back().y, 0);
  }
}

TEST(ContourTest, OfAConeAreRingsAroundItsTip) {
  const Terrain terrain = support::terrain_of(support::grid_points(41, 41, 10, {-200, -200}),
                                              [](Point p) { return 200 - std::hypot(p.x, p.y); });
  const auto lines = contours(terrain, {50, 100, 150});
  ASSERT_EQ(lines.size(), 3U);
  for (const ContourLine& line : lines) {
    EXPECT_TRUE(line.closed);
    EXPECT_EQ(line.places.front(), line.places.back());
    double twice = 0;
    for (std::size_t i = 1; i < line.places.size(); ++i) {
      const Place a = line.places[i - 1], b = line.places[i];
      twice += a.x * b.y - a.y * b.x;
      EXPECT_NEAR(std::hypot(a.x, a.y), 200 - line.level, 0.5);
    }
    EXPECT_NEAR(twice / 2, M_PI * (200 - line.level) * (200 - line.level), 100)
        << "counter-clockwise: the tip is on the left";
  }
  // A pit has them clockwise.
  const Terrain pit = support::terrain_of(support::grid_points(21, 21, 10, {-100, -100}),
                                          [](Point p) { return std::hypot(p.x, p.y); });
  const auto ring = contours(pit, {55});
  ASSERT_EQ(ring.size(), 1U);
  double twice = 0;
  for (std::size_t i = 1; i < ring[0].places.size(); ++i)
    twice += ring[0].places[i - 1].x * ring[0].places[i].y - ring[0].places[i - 1].y * ring[0].places[i].x;
  EXPECT_LT(twice, 0);
}

TEST(ContourTest, RunsAlongTheLowerBorderOfLevelGroundAtItsLevel) {
  // A plateau of height 10 on a plain of 0: at 10 the line is the plateau's rim, at 0 there is none (all is
  // above).
  const Terrain terrain = support::terrain_of(support::grid_points(10, 10, 10), [](Point p) {
    return p.x >= 30 && p.x <= 60 && p.y >= 30 && p.y <= 60 ? 10.0 : 0.0;
  });
  const auto rim = contours(terrain, {10});
  ASSERT_EQ(rim.size(), 1U);
  EXPECT_TRUE(rim[0].closed);
  for (const Place& p : rim[0].places)
    EXPECT_TRUE(p.x == 30 || p.x == 60 || p.y == 30 || p.y == 60) << p.x << ' ' << p.y;
  EXPECT_TRUE(contours(terrain, {0}).empty());
  EXPECT_TRUE(contours(terrain, {10.5}).empty());
  // A single vertex at the level is a ring without length: nothing.
  EXPECT_TRUE(contours(support::terrain_of(support::grid_points(3, 3, 10),
                                           [](Point p) {
                                             return p == Point{10, 10} ? 1.0 : 0.0;
                                           }),
                       {1})
                  .empty());
}

TEST(ContourTest, StopsAtVoidsAndGoesOnBehindThem) {
  const auto heights = support::heights(9, 9, [](std::int32_t c, std::int32_t r) -> std::optional<double> {
    if (c >= 3 && c < 6 && r >= 3 && r < 6) return std::nullopt;
    return 10.0 * c;
  });
  const Terrain terrain = support::voided_terrain(heights, 10, 10);
  const auto parts = contours(terrain, {41}), whole = contours(terrain, {41}, {Voids::kFill, {}});
  ASSERT_EQ(whole.size(), 1U);
  ASSERT_EQ(parts.size(), 2U);
  const auto length = [](const ContourLine& line) {
    double sum = 0;
    for (std::size_t i = 1; i < line.places.size(); ++i)
      sum += std::hypot(line.places[i].x - line.places[i - 1].x, line.places[i].y - line.places[i - 1].y);
    return sum;
  };
  EXPECT_NEAR(length(whole[0]), 80, 1e-9);
  EXPECT_NEAR(length(parts[0]) + length(parts[1]), 50, 1e-9) << "30 of void cells";
  // A ring that a void cuts twice is two lines, wherever it begins.
  const auto cone = support::heights(21, 21, [](std::int32_t c, std::int32_t r) -> std::optional<double> {
    if (r == 10) return std::nullopt;
    return 100 - 10 * std::hypot(c - 10, r - 10);
  });
  EXPECT_EQ(contours(support::voided_terrain(cone, 10, 10), {45}).size(), 2U);
}

TEST(ContourTest, IsCutByABox) {
  const Terrain terrain = support::terrain_of(support::grid_points(41, 41, 10, {-200, -200}),
                                              [](Point p) { return 200 - std::hypot(p.x, p.y); });
  ContourOptions half;
  half.box = PlaceBox{{0, -300}, {300, 300}};
  const auto lines = contours(terrain, {100}, half);
  ASSERT_EQ(lines.size(), 1U);
  EXPECT_FALSE(lines[0].closed);
  EXPECT_NEAR(lines[0].places.front().x, 0, 1e-9);
  EXPECT_NEAR(lines[0].places.back().x, 0, 1e-9);
  for (const Place& p : lines[0].places) EXPECT_GE(p.x, 0);
  ContourOptions around;
  around.box = PlaceBox{{-150, -150}, {150, 150}};
  EXPECT_TRUE(contours(terrain, {100}, around)[0].closed);
  ContourOptions beside;
  beside.box = PlaceBox{{-20, -20}, {20, 20}};
  EXPECT_TRUE(contours(terrain, {100}, beside).empty());
  ContourOptions cross;
  cross.box = PlaceBox{{-300, -50}, {300, 50}};
  EXPECT_EQ(contours(terrain, {100}, cross).size(), 2U);
}

TEST(ContourTest, DoesNotDependOnTheHistoryIfIdsAreTheSame) {
  support::Random random(support::seed());
  SCOPED_TRACE("TINSMITH_SEED=" + std::to_string(support::seed()));
  std::uniform_int_distribution<int> whole(0, 9);
  const Terrain built =
      support::terrain_of(support::random_points(random, 300, 1000), [&](Point) { return whole(random); });
  Terrain edited = built;
  const auto applied =
      edited.apply(std::vector<Edit>{Insert{{7, 2000}, 50}, tin::terrain::Remove{tin::terrain::VertexId(3)},
                                     Insert{{3, 3}, 4}},
                   Duplicates::kReplace);
  ASSERT_TRUE(applied.ok());
  EXPECT_EQ(contours(edited, {4.5}).empty(), false);
  ASSERT_TRUE(edited.replay(applied->change.inverse()).ok());
  ASSERT_EQ(tin::mesh::validate(edited.mesh()), std::nullopt);
  const auto again = *Terrain::restore(built.frame(), built.vertices_by_id(), built.next_id());
  const std::vector<double> levels{1, 2.5, 3, 4, 7.25};
  for (const Terrain* other : {static_cast<const Terrain*>(&edited), &again}) {
    const auto a = contours(built, levels), b = contours(*other, levels);
    ASSERT_EQ(a.size(), b.size());
    for (std::size_t i = 0; i < a.size(); ++i) {
      EXPECT_EQ(a[i].places, b[i].places);
      EXPECT_EQ(a[i].closed, b[i].closed);
    }
  }
}

TEST(ContourTest, OfDegenerateTerrainsIsNothing) {
  for (const auto& [name, terrain] : support::degenerate_terrains())
    EXPECT_TRUE(contours(terrain, {-5, 0, 1, 5}).empty()) << name;
  EXPECT_TRUE(contours(support::terrain_of(support::grid_points(3, 3, 10), support::plane), {}).empty());
}

TEST(ContourLevelsTest, AreMultiplesWithinTheRange) {
  const Terrain terrain = support::terrain_of({{0, 0}, {10, 0}, {0, 10}}, [](Point p) {
    return p.x == 10 ? 25.0 : p.y == 10 ? 9.5 : 12;
  });
  EXPECT_EQ(*contour_levels(terrain, 5, 0, 10), (std::vector<double>{10, 15, 20, 25}));
  EXPECT_EQ(*contour_levels(terrain, 10, 2, 10), (std::vector<double>{12, 22}));
  EXPECT_EQ(contour_levels(terrain, 5, 0, 4)->size(), 4U);
  EXPECT_EQ(contour_levels(terrain, 5, 0, 3).error().code, Code::kTooLarge);
  EXPECT_EQ(contour_levels(terrain, 0, 0, 3).error().code, Code::kInvalidValue);
  EXPECT_EQ(contour_levels(terrain, -1, 0, 3).error().code, Code::kInvalidValue);
  EXPECT_EQ(contour_levels(terrain, 1e-300, 0, 3).error().code, Code::kTooLarge);
  EXPECT_TRUE(contour_levels(support::terrain_of({}, support::plane), 1, 0, 3)->empty());
}

}  // namespace
