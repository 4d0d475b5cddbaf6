#include "tin/query/profile.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "tests/tin/query/analytic.h"
#include "tin/exact/predicates.h"
#include "tin/mesh/validate.h"
#include "tin/query/elevation.h"

namespace {

using tin::base::Code;
using tin::exact::orientation;
using tin::exact::Point;
using tin::query::ElevationQuery;
using tin::query::profile;
using tin::query::ProfilePoint;
using tin::query::Voids;
using tin::terrain::Terrain;

constexpr std::size_t kMany = 1'000'000;

std::vector<ProfilePoint> profile_of(const Terrain& terrain, const std::vector<Point>& line,
                                     Voids voids = Voids::kKeep) {
  const auto found = profile(terrain, support::metre_ground(), line, voids, kMany);
  EXPECT_TRUE(found.ok());
  return *found;
}

/// Distances at which the line p, q meets an edge of the mesh in one point, or an edge's end: by trying all
/// edges.
std::set<double> crossings(const Terrain& terrain, Point p, Point q) {
  const auto& mesh = terrain.mesh();
  const double length = std::hypot(double(q.x) - p.x, double(q.y) - p.y);
  std::set<double> out;
  const auto add_if_on_line = [&](Point v) {
    const double along =
        (double(v.x) - p.x) * (double(q.x) - p.x) + (double(v.y) - p.y) * (double(q.y) - p.y);
    if (orientation(p, q, v) == 0 && along >= 0 && along <= length * length) out.insert(along / length);
  };
  for (std::uint32_t i = 0; i < mesh.triangle_slots(); ++i) {
    const tin::mesh::TriangleSlot t(i);
    if (!mesh.is_alive(t) || mesh.is_infinite(t)) continue;
    for (int k = 0; k < 3; ++k) {
      const Point a = mesh.point(mesh.vertex(t, k)), b = mesh.point(mesh.vertex(t, (k + 1) % 3));
      add_if_on_line(a);
      const auto a_side = orientation(p, q, a), b_side = orientation(p, q, b);
      const auto p_side = orientation(a, b, p), q_side = orientation(a, b, q);
      if ((a_side > 0) == (b_side > 0) || a_side == 0 || b_side == 0) continue;
      if ((p_side > 0 && q_side > 0) || (p_side < 0 && q_side < 0)) continue;
      out.insert(double(p_side) / (double(p_side) - double(q_side)) * length);
    }
  }
  return out;
}

/// Equal up to rounding: every crossing is a point of the profile, and every point but the ends is a
/// crossing.
void expect_all_crossings(const Terrain& terrain, Point p, Point q, const std::string& name) {
  const auto found = profile_of(terrain, {p, q});
  const double length = std::hypot(double(q.x) - p.x, double(q.y) - p.y),
               near = std::max(1e-9 * length, 1e-6);
  const auto expected = crossings(terrain, p, q);
  for (const double d : expected) {
    EXPECT_TRUE(std::any_of(found.begin(), found.end(),
                            [&](const ProfilePoint& f) { return f.z && std::abs(f.distance - d) <= near; }))
        << name << ": no point at " << d << " from " << p.x << ' ' << p.y << " to " << q.x << ' ' << q.y;
  }
  ElevationQuery query(terrain, Voids::kFill);
  for (const ProfilePoint& f : found) {
    const bool end = f.distance <= near || f.distance >= length - near;
    const bool crossing = std::any_of(expected.begin(), expected.end(),
                                      [&](double d) { return std::abs(f.distance - d) <= near; });
    EXPECT_TRUE(end || crossing) << name << ": " << f.distance << " is no crossing";
  }
  for (std::size_t i = 1; i < found.size(); ++i) EXPECT_LE(found[i - 1].distance, found[i].distance);
  ASSERT_FALSE(found.empty());
  EXPECT_EQ(found.front().z.has_value(), query.at(p).has_value()) << name;
  EXPECT_EQ(found.back().z.has_value(), query.at(q).has_value()) << name;
}

TEST(ProfileTest, HasEveryCrossingOfHardSets) {
  support::Random random(support::seed());
  SCOPED_TRACE("TINSMITH_SEED=" + std::to_string(support::seed()));
  for (const auto& set : support::hard_sets(random, 80)) {
    const Terrain terrain = support::terrain_of(set.points, support::plane);
    if (terrain.mesh().dimension() < 2) continue;
    const auto box = *terrain.bounds();
    // Some lines begin or end outside; many run from vertex to vertex, and so along edges and through
    // vertices.
    const auto clamp = [](std::int64_t v) {
      return static_cast<std::int32_t>(
          std::clamp<std::int64_t>(v, -tin::exact::kLatticeHalf, tin::exact::kLatticeHalf - 1));
    };
    const std::int64_t margin = (std::int64_t{box.max.x} - box.min.x) / 8 + 2;
    std::uniform_int_distribution<std::int64_t> x(box.min.x - margin, box.max.x + margin),
        y(box.min.y - margin, box.max.y + margin);
    std::uniform_int_distribution<std::size_t> pick(0, set.points.size() - 1);
    for (int i = 0; i < 60; ++i) {
      const Point p = i % 3 == 0 ? Point{clamp(x(random)), clamp(y(random))} : set.points[pick(random)];
      const Point q = i % 2 == 0 ? Point{clamp(x(random)), clamp(y(random))} : set.points[pick(random)];
      if (p != q) expect_all_crossings(terrain, p, q, set.name);
    }
  }
}

TEST(ProfileTest, RunsAlongTheRowsAndDiagonalsOfAGrid) {
  const Terrain terrain = support::terrain_of(support::grid_points(6, 6, 10), support::plane);
  for (const auto& [p, q] : std::vector<std::pair<Point, Point>>{{{0, 0}, {50, 0}},
                                                                 {{-20, 0}, {70, 0}},
                                                                 {{0, 0}, {50, 50}},
                                                                 {{50, 0}, {0, 50}},
                                                                 {{-10, -10}, {60, 60}},
                                                                 {{60, -10}, {-10, 60}},
                                                                 {{10, 3}, {10, 44}},
                                                                 {{25, 60}, {25, -10}},
                                                                 {{5, 5}, {45, 5}},
                                                                 {{3, 0}, {47, 0}},
                                                                 {{-5, 50}, {55, 50}},
                                                                 {{50, 60}, {50, -7}}}) {
    expect_all_crossings(terrain, p, q, "grid");
    expect_all_crossings(terrain, q, p, "grid, backwards");
  }
}

TEST(ProfileTest, IsStraightBetweenItsPoints) {
  support::Random random(support::seed());
  SCOPED_TRACE("TINSMITH_SEED=" + std::to_string(support::seed()));
  std::uniform_real_distribution<double> height(0, 50);
  const Terrain terrain = support::terrain_of(support::random_points(random, 400, 100'000),
                                              [&](Point) { return height(random); });
  ElevationQuery query(terrain, Voids::kKeep);
  const auto found = profile_of(terrain, {{-80'000, -70'000}, {10'000, 80'000}, {90'000, -3'000}});
  ASSERT_GT(found.size(), 20U);
  for (std::size_t i = 1; i < found.size(); ++i) {
    if (!found[i - 1].z || !found[i].z) continue;
    const Point middle{static_cast<std::int32_t>(std::lround((found[i - 1].at.x + found[i].at.x) / 2)),
                       static_cast<std::int32_t>(std::lround((found[i - 1].at.y + found[i].at.y) / 2))};
    const auto there = query.at(middle);
    if (there) {
      EXPECT_NEAR(there->z, (*found[i - 1].z + *found[i].z) / 2, 0.1);
    }
  }
}

TEST(ProfileTest, BeginsWithAGapOutsideTheHullAndEndsWithOne) {
  const Terrain terrain =
      support::terrain_of({{0, 0}, {10, 0}, {10, 10}, {0, 10}}, [](Point p) { return double(p.x); });
  const auto found = profile_of(terrain, {{-10, 3}, {30, 3}});
  ASSERT_GE(found.size(), 4U);
  EXPECT_EQ(found[0], (ProfilePoint{0, {-10, 3}, std::nullopt}));
  EXPECT_EQ(found[1], (ProfilePoint{10, {0, 3}, 0}));
  EXPECT_EQ(found[found.size() - 3], (ProfilePoint{20, {10, 3}, 10}));
  EXPECT_EQ(found[found.size() - 2], (ProfilePoint{20, {10, 3}, std::nullopt}));
  EXPECT_EQ(found[found.size() - 1], (ProfilePoint{40, {30, 3}, std::nullopt}));
  const auto beside = profile_of(terrain, {{-10, 13}, {30, 13}});
  EXPECT_EQ(beside.size(), 2U);
}

TEST(ProfileTest, HasGapsOverVoidsWhereElevationsHave) {
  support::Random random(support::seed());
  SCOPED_TRACE("TINSMITH_SEED=" + std::to_string(support::seed()));
  // 9 x 9 cells of 100 lattice steps, a block of 5 x 3 of them void.
  const auto heights = support::heights(9, 9, [](std::int32_t c, std::int32_t r) -> std::optional<double> {
    if (c >= 2 && c < 7 && r >= 3 && r < 6) return std::nullopt;
    return c + 2.0 * r;
  });
  const Terrain terrain = support::voided_terrain(heights, 100, 100);
  const auto box = *terrain.bounds();
  std::uniform_int_distribution<std::int32_t> x(box.min.x - 50, box.max.x + 50),
      y(box.min.y - 50, box.max.y + 50);
  ElevationQuery query(terrain, Voids::kKeep);
  int gaps = 0;
  for (int i = 0; i < 200; ++i) {
    const Point p{x(random), y(random)}, q{x(random), y(random)};
    const auto found = profile_of(terrain, {p, q});
    for (std::size_t k = 1; k < found.size(); ++k) {
      const ProfilePoint &a = found[k - 1], &b = found[k];
      if (b.distance - a.distance < 8) continue;  // the query's position is rounded to the lattice
      const Point middle{static_cast<std::int32_t>(std::lround((a.at.x + b.at.x) / 2)),
                         static_cast<std::int32_t>(std::lround((a.at.y + b.at.y) / 2))};
      const auto near_border = [](std::int32_t v) {
        return (v + 100'052) % 100 <= 4;
      };  // cells meet at 50, 150 ...
      if (near_border(middle.x) || near_border(middle.y)) continue;
      EXPECT_EQ(a.z.has_value(), query.at(middle).has_value()) << middle.x << ' ' << middle.y;
      if (!a.z) ++gaps;
      if (a.z) {
        ASSERT_TRUE(b.z.has_value()) << "the surface reaches up to the gap's edge";
      }
    }
  }
  EXPECT_GT(gaps, 20);
  for (const ProfilePoint& f :
       profile_of(terrain, {{box.min.x, box.min.y}, {box.max.x, box.max.y}}, Voids::kFill))
    EXPECT_TRUE(f.z.has_value());
}

TEST(ProfileTest, MeasuresGeodesicsOnTheEllipsoid) {
  tin::frame::Frame frame;
  frame.x = frame.y = {0, 1, 1'000'000};
  std::vector<tin::terrain::Placement> placements;
  for (const Point p : support::grid_points(3, 3, 2'000'000)) placements.push_back({p, 0});
  const Terrain terrain = *Terrain::build(frame, placements, tin::terrain::Duplicates::kReject);
  const tin::frame::Ground ground(frame, {.geographic = true});
  const std::vector<Point> equator{{0, 0}, {4'000'000, 0}}, meridian{{0, 0}, {0, 4'000'000}};
  // One degree of the equator is 111319.4908 m; the meridian's arc from 0 to 4 degrees is 442304.312 m
  // (WGS84).
  EXPECT_NEAR(profile(terrain, ground, equator, Voids::kKeep, kMany)->back().distance, 4 * 111319.4908, 0.01);
  EXPECT_NEAR(profile(terrain, ground, meridian, Voids::kKeep, kMany)->back().distance, 442304.312, 0.1);
}

TEST(ProfileTest, DoesNotDependOnTheHistory) {
  support::Random random(support::seed());
  auto points = support::grid_points(12, 12, 50);
  const auto wave = [](Point p) { return std::sin(p.x) + std::cos(p.y); };
  const Terrain built = support::terrain_of(points, wave);
  std::shuffle(points.begin(), points.end(), random);
  Terrain edited = support::terrain_of({}, wave);
  for (const Point p : points)
    ASSERT_TRUE(edited
                    .apply(std::vector<tin::terrain::Edit>{tin::terrain::Insert{p, wave(p)}},
                           tin::terrain::Duplicates::kReject)
                    .ok());
  ASSERT_EQ(tin::mesh::validate(edited.mesh()), std::nullopt);
  for (const auto& line : {std::vector<Point>{{0, 0}, {550, 550}, {3, 500}},
                           {{-9, 100}, {600, 100}},
                           {{50, 50}, {50, 400}, {500, 450}}}) {
    EXPECT_EQ(profile_of(built, line), profile_of(edited, line));
  }
}

TEST(ProfileTest, RefusesMoreThanItsLimitAndAnEmptyLine) {
  const Terrain terrain = support::terrain_of(support::grid_points(6, 6, 10), support::plane);
  const std::vector<Point> line{{0, 5}, {50, 5}};
  const std::size_t size = profile_of(terrain, line).size();
  EXPECT_TRUE(profile(terrain, support::metre_ground(), line, Voids::kKeep, size).ok());
  EXPECT_EQ(profile(terrain, support::metre_ground(), line, Voids::kKeep, size - 1).error().code,
            Code::kTooLarge);
  EXPECT_EQ(profile(terrain, support::metre_ground(), {}, Voids::kKeep, kMany).error().code,
            Code::kInvalidValue);
}

TEST(ProfileTest, OfDegenerateTerrainsHasTheirVertices) {
  for (const auto& [name, terrain] : support::degenerate_terrains()) {
    for (const auto& line : {std::vector<Point>{{0, 0}, {24, 0}},
                             {{24, -16}, {0, 0}},
                             {{4, 7}, {4, 7}},
                             {{0, 0}, {10, 20}},
                             {{-5, 5}, {9, 9}}}) {
      for (const ProfilePoint& f : profile_of(terrain, line)) {
        if (f.z) {
          EXPECT_NEAR(*f.z, 3 + 0.25 * f.at.x - 0.5 * f.at.y, 1e-9) << name;
        }
      }
    }
  }
  const Terrain row = support::terrain_of(support::line_points(9, 3, 0), support::plane);
  const auto box = *row.bounds();
  const auto along = profile_of(row, {box.min, box.max});
  EXPECT_EQ(along.size(), 9U);
}

}  // namespace
