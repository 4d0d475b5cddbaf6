#include "tin/query/volume.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/tin/query/analytic.h"
#include "tin/exact/predicates.h"
#include "tin/mesh/validate.h"
#include "tin/query/elevation.h"
#include "tin/query/measure.h"

namespace {

using tin::base::Code;
using tin::exact::Point;
using tin::frame::Frame;
using tin::frame::Ground;
using tin::query::CutFill;
using tin::query::ElevationQuery;
using tin::query::FixedSum;
using tin::query::LevelVolumes;
using tin::query::Region;
using tin::query::Ring;
using tin::query::Voids;
using tin::query::Where;
using tin::terrain::Duplicates;
using tin::terrain::Edit;
using tin::terrain::Insert;
using tin::terrain::Placement;
using tin::terrain::Remove;
using tin::terrain::Terrain;
using tin::terrain::VertexId;

LevelVolumes volumes(const Terrain& terrain, double level, const Where& where = {}) {
  return *tin::query::volumes_at(terrain, support::metre_ground(), level, where);
}
CutFill between(const Terrain& before, const Terrain& after, const Where& where = {}) {
  return *tin::query::cut_fill(before, after, support::metre_ground(), where);
}
Region region(const std::vector<Ring>& rings) {
  return *Region::make(rings);
}

TEST(FixedSumTest, DoesNotDependOnTheOrder) {
  support::Random random(support::seed());
  std::uniform_real_distribution<double> exponent(-60, 20);
  std::vector<double> terms;
  for (int i = 0; i < 2000; ++i) terms.push_back((i % 3 == 0 ? -1 : 1) * std::exp2(exponent(random)));
  FixedSum forwards(1e12), backwards(1e12);
  long double exact = 0;
  for (const double t : terms) {
    forwards.add(t);
    exact += t;
  }
  for (auto t = terms.rbegin(); t != terms.rend(); ++t) backwards.add(*t);
  EXPECT_EQ(forwards.value(), backwards.value());
  EXPECT_NEAR(forwards.value(), static_cast<double>(exact), std::abs(static_cast<double>(exact)) * 1e-15);
  forwards.add(0);
  EXPECT_EQ(forwards.value(), backwards.value());
}

TEST(LevelVolumesTest, OfAPlaneAreThoseOfItsWedges) {
  // z = x over 100 x 100: above the level 30 a wedge of 70 x 70 / 2, below one of 30 x 30 / 2, each 100 long.
  support::Random random(support::seed());
  auto points = support::random_points(random, 200, 49);
  for (Point& p : points) p = {p.x + 50, p.y + 50};
  for (const Point corner : {Point{0, 0}, Point{100, 0}, Point{100, 100}, Point{0, 100}})
    points.push_back(corner);
  const Terrain terrain = support::terrain_of(points, [](Point p) { return double(p.x); });
  const LevelVolumes v = volumes(terrain, 30);
  EXPECT_NEAR(v.volume_above, 245'000, 1e-6);
  EXPECT_NEAR(v.volume_below, 45'000, 1e-6);
  EXPECT_NEAR(v.area_above, 7000, 1e-9);
  EXPECT_NEAR(v.area_below, 3000, 1e-9);
  EXPECT_EQ(volumes(terrain, 0).area_below, 0);
  EXPECT_EQ(volumes(terrain, 100.5).area_above, 0);
  const auto area = *tin::query::surface_area(terrain, support::metre_ground(), {});
  EXPECT_NEAR(area.planar, 10'000, 1e-9);
  EXPECT_NEAR(area.surface, 10'000 * std::numbers::sqrt2, 1e-8);
}

TEST(LevelVolumesTest, OfAConeApproachTheCones) {
  // A cone of radius 1000 and height 500 by rings of 720 vertices: the polygon inside is smaller by (1 -
  // sin(x)/x).
  std::vector<Point> points{{0, 0}};
  const int n = 720;
  for (int ring = 1; ring <= 10; ++ring) {
    for (int i = 0; i < n; ++i) {
      const double angle = 2 * std::numbers::pi * i / n;
      points.push_back({static_cast<std::int32_t>(std::lround(100'000.0 * ring * std::cos(angle))),
                        static_cast<std::int32_t>(std::lround(100'000.0 * ring * std::sin(angle)))});
    }
  }
  const double radius = 1e6, height = 500;
  const Terrain terrain =
      support::terrain_of(points, [&](Point p) { return height * (1 - std::hypot(p.x, p.y) / radius); });
  const auto part = [](double v, double expected) { return v / expected; };
  const double pi = std::numbers::pi;
  EXPECT_NEAR(part(volumes(terrain, 0).volume_above, pi * radius * radius * height / 3), 1, 1e-4);
  // Above half its height stands a cone of half its size: an eighth of the volume.
  const LevelVolumes half = volumes(terrain, height / 2);
  EXPECT_NEAR(part(half.volume_above, pi * radius * radius * height / 24), 1, 1e-4);
  EXPECT_NEAR(part(half.area_above, pi * radius * radius / 4), 1, 1e-4);
  EXPECT_NEAR(part(half.area_above + half.area_below, pi * radius * radius), 1, 1e-4);
}

TEST(LevelVolumesTest, OfAParaboloidConvergeWithTheSquareOfTheCells) {
  // z = (x^2 + y^2) / 1000 over 1000 x 1000: the trapezoidal rule's error falls by four as cells halve.
  const double exact = 2e9 / 3;
  double last = 0;
  for (const std::int32_t cells : {5, 10, 20, 40}) {
    const Terrain terrain =
        support::terrain_of(support::grid_points(cells + 1, cells + 1, 1000 / cells),
                            [](Point p) { return (double(p.x) * p.x + double(p.y) * p.y) / 1000; });
    const double off = volumes(terrain, 0).volume_above - exact;
    EXPECT_GT(off, 0);
    if (last > 0) {
      EXPECT_NEAR(last / off, 4, 0.2);
    }
    last = off;
  }
}

TEST(LevelVolumesTest, WithinAPolygonAreThoseOfThePolygon) {
  support::Random random(support::seed());
  SCOPED_TRACE("TINSMITH_SEED=" + std::to_string(support::seed()));
  const Terrain terrain = support::terrain_of(support::random_points(random, 500, 1000),
                                              [](Point p) { return 40 + 0.01 * p.x - 0.02 * p.y; });
  // The integral of a plane over a polygon is its value at the centroid times the area.
  const Region square = region({{{-100, -200}, {300, -200}, {300, 200}, {-100, 200}}});
  const LevelVolumes v = volumes(terrain, 0, {&square, Voids::kKeep});
  EXPECT_NEAR(v.area_above, 160'000, 1e-6);
  EXPECT_NEAR(v.volume_above, 160'000 * (40 + 0.01 * 100), 1e-4);
  const Region holed = region(
      {{{-100, -200}, {300, -200}, {300, 200}, {-100, 200}}, {{0, 0}, {100, 0}, {100, 100}, {0, 100}}});
  const LevelVolumes w = volumes(terrain, 0, {&holed, Voids::kKeep});
  EXPECT_NEAR(w.area_above, 150'000, 1e-6);
  EXPECT_NEAR(w.volume_above, v.volume_above - 10'000 * (40 + 0.5 - 1), 1e-4);
  const Region notched = region({{{-300, -300}, {300, -300}, {300, 300}, {0, -200}, {-300, 300}}});
  EXPECT_NEAR(volumes(terrain, 0, {&notched, Voids::kKeep}).area_above, 210'000, 1e-6);
}

TEST(LevelVolumesTest, AreTheSumOfThoseOfTheParts) {
  support::Random random(support::seed());
  SCOPED_TRACE("TINSMITH_SEED=" + std::to_string(support::seed()));
  std::uniform_real_distribution<double> height(0, 50);
  for (const auto& set : support::hard_sets(random, 100)) {
    const Terrain terrain = support::terrain_of(set.points, [&](Point) { return height(random); });
    if (terrain.mesh().dimension() < 2) continue;
    const auto box = *terrain.bounds();
    const auto at = [](std::int32_t a, std::int32_t b, double u) {
      return static_cast<std::int32_t>(std::floor(a + u * (double(b) - a)));
    };
    const std::int32_t x = at(box.min.x, box.max.x, 0.37), y = at(box.min.y, box.max.y, 0.61);
    const LevelVolumes whole = volumes(terrain, 20);
    LevelVolumes sum;
    for (const auto& [x0, x1] : {std::pair{box.min.x, x}, {x, box.max.x}}) {
      for (const auto& [y0, y1] : {std::pair{box.min.y, y}, {y, box.max.y}}) {
        if (x0 == x1 || y0 == y1) continue;
        const Region part = region({{{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}}});
        const LevelVolumes v = volumes(terrain, 20, {&part, Voids::kKeep});
        sum.area_above += v.area_above;
        sum.area_below += v.area_below;
        sum.volume_above += v.volume_above;
        sum.volume_below += v.volume_below;
      }
    }
    const double area = whole.area_above + whole.area_below;
    EXPECT_NEAR(sum.area_above, whole.area_above, 1e-9 * area) << set.name;
    EXPECT_NEAR(sum.area_below, whole.area_below, 1e-9 * area) << set.name;
    EXPECT_NEAR(sum.volume_above, whole.volume_above, 1e-7 * area) << set.name;
    EXPECT_NEAR(sum.volume_below, whole.volume_below, 1e-7 * area) << set.name;
  }
}

TEST(LevelVolumesTest, HoldForRegionsAroundAcrossAndBesideTheHull) {
  const Terrain terrain =
      support::terrain_of({{0, 0}, {100, 0}, {100, 100}, {0, 100}}, [](Point) { return 2.0; });
  const auto area = [&](const Ring& ring) {
    const Region where = region({ring});
    return volumes(terrain, 0, {&where, Voids::kKeep}).area_above;
  };
  EXPECT_DOUBLE_EQ(area({{-100, -100}, {200, -100}, {200, 200}, {-100, 200}}), 10'000) << "around";
  EXPECT_DOUBLE_EQ(area({{-100, 40}, {200, 40}, {200, 60}, {-100, 60}}), 2000)
      << "across, all corners outside";
  EXPECT_DOUBLE_EQ(area({{50, 50}, {300, 50}, {300, 300}, {50, 300}}), 2500) << "over a corner";
  EXPECT_DOUBLE_EQ(area({{150, 50}, {300, 50}, {300, 300}, {150, 300}}), 0) << "beside";
  EXPECT_DOUBLE_EQ(area({{150, -100}, {160, 300}, {-500, 260}, {-400, 240}, {140, 240}}), 0)
      << "around a corner";
  EXPECT_DOUBLE_EQ(area({{100, 0}, {200, 0}, {200, 100}, {100, 100}}), 0) << "touching";
}

TEST(LevelVolumesTest, LeaveVoidsOut) {
  // 6 x 6 cells of 10 x 10, the middle 2 x 2 void: the hull is 50 x 50, the voids 20 x 20.
  const auto heights = support::heights(6, 6, [](std::int32_t c, std::int32_t r) -> std::optional<double> {
    if (c >= 2 && c < 4 && r >= 2 && r < 4) return std::nullopt;
    return 3.0;
  });
  Terrain terrain = support::voided_terrain(heights, 10, 10);
  EXPECT_NEAR(volumes(terrain, 1).area_above, 2500 - 400, 1e-9);
  EXPECT_NEAR(volumes(terrain, 1).volume_above, 2 * (2500 - 400), 1e-9);
  EXPECT_NEAR(volumes(terrain, 1, {nullptr, Voids::kFill}).area_above, 2500, 1e-9);
  const auto box = *terrain.bounds();
  const Region left = region({{box.min,
                               {(box.min.x + box.max.x) / 2, box.min.y},
                               {(box.min.x + box.max.x) / 2, box.max.y},
                               {box.min.x, box.max.y}}});
  EXPECT_NEAR(volumes(terrain, 1, {&left, Voids::kKeep}).area_above, (2500 - 400) / 2.0, 1e-9);
}

TEST(LevelVolumesTest, OnTheEllipsoidAreThoseOfTheBand) {
  // Between 0 and 1 degree of longitude and 50 and 51 of latitude the ellipsoid has 7,915,553,000 m2, about;
  // by the exact formula for the area between the equator and a latitude.
  const auto up_to = [](double degrees) {
    const double a = 6378137, f = 1 / 298.257223563, e = std::sqrt(f * (2 - f)), b2 = a * a * (1 - e * e);
    const double s = std::sin(degrees * std::numbers::pi / 180);
    return b2 / 2 * (s / (1 - e * e * s * s) + std::log((1 + e * s) / (1 - e * s)) / (2 * e)) *
           std::numbers::pi / 180;
  };
  Frame frame;
  frame.x = {0, 1, 1'000'000};
  frame.y = {50, 1, 1'000'000};
  for (const std::int32_t cells : {1, 10}) {
    std::vector<Placement> placements;
    for (const Point p : support::grid_points(cells + 1, cells + 1, 1'000'000 / cells))
      placements.push_back({p, 10});
    const Terrain terrain = *Terrain::build(frame, placements, Duplicates::kReject);
    const Ground ground(frame, {.geographic = true});
    const auto v = *tin::query::volumes_at(terrain, ground, 7, {});
    const double expected = up_to(51) - up_to(50);
    EXPECT_NEAR(v.area_above / expected, 1, 1e-10);
    EXPECT_NEAR(v.volume_above / (3 * expected), 1, 1e-10);
    EXPECT_NEAR(tin::query::surface_area(terrain, ground, {})->surface / expected, 1, 1e-10);
  }
}

TEST(LevelVolumesTest, DoNotDependOnTheHistory) {
  support::Random random(support::seed());
  SCOPED_TRACE("TINSMITH_SEED=" + std::to_string(support::seed()));
  const auto wave = [](Point p) { return 20 * std::sin(p.x / 50.0) + 10 * std::cos(p.y / 70.0); };
  auto points = support::random_points(random, 300, 300);
  const Terrain built = support::terrain_of(points, wave);
  std::shuffle(points.begin(), points.end(), random);
  Terrain edited = support::terrain_of({{900, 900}}, wave);
  for (const Point p : points)
    ASSERT_TRUE(edited.apply(std::vector<Edit>{Insert{p, wave(p)}}, Duplicates::kReject).ok());
  ASSERT_TRUE(edited.apply(std::vector<Edit>{Remove{VertexId(1)}}, Duplicates::kReject).ok());
  ASSERT_EQ(tin::mesh::validate(edited.mesh()), std::nullopt);
  const Region where = region({{{-200, -150}, {100, -210}, {190, 140}, {-50, 30}}});
  for (const Region* r : {static_cast<const Region*>(nullptr), &where}) {
    const LevelVolumes a = volumes(built, 3.3, {r, Voids::kKeep}),
                       b = volumes(edited, 3.3, {r, Voids::kKeep});
    EXPECT_EQ(a.volume_above, b.volume_above);
    EXPECT_EQ(a.volume_below, b.volume_below);
    EXPECT_EQ(a.area_above, b.area_above);
  }
  EXPECT_EQ(between(built, edited).equal_area, between(edited, built).equal_area);
}

TEST(LevelVolumesTest, OfDegenerateTerrainsAreZeroAndStopWhenAsked) {
  for (const auto& [name, terrain] : support::degenerate_terrains()) {
    EXPECT_EQ(volumes(terrain, 1).area_above, 0) << name;
    const Region where = region({{{-9, -9}, {9, -9}, {9, 9}}});
    EXPECT_EQ(volumes(terrain, 1, {&where, Voids::kKeep}).area_above, 0) << name;
    EXPECT_EQ(
        between(terrain, support::terrain_of(support::grid_points(3, 3, 10), support::plane)).fill_volume, 0)
        << name;
    EXPECT_EQ(
        between(support::terrain_of(support::grid_points(3, 3, 10), support::plane), terrain).fill_volume, 0)
        << name;
  }
  const Terrain terrain = support::terrain_of(support::grid_points(30, 30, 10), support::plane);
  tin::base::Progress progress;
  progress.cancel();
  EXPECT_EQ(tin::query::volumes_at(terrain, support::metre_ground(), 0, {}, &progress).error().code,
            Code::kCancelled);
  EXPECT_EQ(tin::query::cut_fill(terrain, terrain, support::metre_ground(), {}, &progress).error().code,
            Code::kCancelled);
}

TEST(CutFillTest, OfATerrainWithItselfIsNothing) {
  support::Random random(support::seed());
  std::uniform_real_distribution<double> height(0, 50);
  const Terrain terrain =
      support::terrain_of(support::random_points(random, 400, 1000), [&](Point) { return height(random); });
  const CutFill c = between(terrain, terrain);
  EXPECT_EQ(c.cut_volume, 0);
  EXPECT_EQ(c.fill_volume, 0);
  EXPECT_NEAR(c.equal_area, tin::query::surface_area(terrain, support::metre_ground(), {})->planar, 1e-6);
}

TEST(CutFillTest, OfAPyramidOnLevelGroundIsThePyramid) {
  const auto level = [](Point) { return 5.0; };
  const Terrain before = support::terrain_of(support::grid_points(11, 11, 10), level);
  Terrain after = support::terrain_of(support::grid_points(11, 11, 10), level);
  // A vertex 12 higher: with level ground around it a pyramid over its star.
  ASSERT_TRUE(after.apply(std::vector<Edit>{Insert{{50, 50}, 17}}, Duplicates::kReplace).ok());
  const CutFill c = between(before, after);
  EXPECT_NEAR(c.fill_area, 300, 1e-9) << "six half cells of a regular grid";
  EXPECT_NEAR(c.fill_volume, 300 * 12 / 3.0, 1e-9);
  EXPECT_EQ(c.cut_volume, 0);
  EXPECT_NEAR(c.equal_area, 10'000 - 300, 1e-9);
  const CutFill back = between(after, before);
  EXPECT_NEAR(back.cut_volume, c.fill_volume, 1e-9);
  EXPECT_EQ(back.fill_volume, 0);
}

TEST(CutFillTest, OfTwoPlanesIsTheWedgesBetweenThem) {
  // z = x against z = 100 - x over the square 0..100: they meet at x = 50; each wedge is 50 x 100 / 2 x 100.
  support::Random random(support::seed());
  SCOPED_TRACE("TINSMITH_SEED=" + std::to_string(support::seed()));
  const auto square = [&] {
    auto points = support::random_points(random, 150, 49);
    for (Point& p : points) p = {p.x + 50, p.y + 50};
    for (const Point corner : {Point{0, 0}, Point{100, 0}, Point{100, 100}, Point{0, 100}})
      points.push_back(corner);
    return points;
  };
  const Terrain before = support::terrain_of(square(), [](Point p) { return double(p.x); });
  const Terrain after = support::terrain_of(square(), [](Point p) { return 100.0 - p.x; });
  const CutFill c = between(before, after);
  EXPECT_NEAR(c.fill_volume, 250'000, 1e-6);
  EXPECT_NEAR(c.cut_volume, 250'000, 1e-6);
  EXPECT_NEAR(c.fill_area, 5000, 1e-8);
  EXPECT_NEAR(c.cut_area, 5000, 1e-8);
}

TEST(CutFillTest, IsTheDifferenceOfTheVolumesWhereOneIsAboveTheOther) {
  support::Random random(support::seed());
  SCOPED_TRACE("TINSMITH_SEED=" + std::to_string(support::seed()));
  std::uniform_real_distribution<double> height(0, 50);
  const Region where = region({{{-500, -400}, {520, -450}, {480, 430}, {-20, 100}, {-470, 510}}});
  for (int i = 0; i < 5; ++i) {
    const Terrain before =
        support::terrain_of(support::random_points(random, 300, 1000), [&](Point) { return height(random); });
    const Terrain after =
        support::terrain_of(support::random_points(random, 300, 1000), [&](Point) { return height(random); });
    const Where here{&where, Voids::kKeep};
    const CutFill c = between(before, after, here);
    const double expected = volumes(after, -10, here).volume_above - volumes(before, -10, here).volume_above;
    EXPECT_NEAR(c.fill_volume - c.cut_volume, expected, 1e-9 * volumes(after, -10, here).volume_above);
    EXPECT_NEAR(c.fill_area + c.cut_area + c.equal_area, volumes(after, -10, here).area_above, 1e-6);
    // Against sampling, within its error.
    ElevationQuery from(before, Voids::kKeep), to(after, Voids::kKeep);
    double fill = 0;
    for (std::int32_t x = -520; x < 530; x += 4) {
      for (std::int32_t y = -460; y < 520; y += 4) {
        bool inside = false;
        for (const auto& t : where.outline()) {
          inside = inside || (tin::exact::orientation(t[0], t[1], {x, y}) > 0 &&
                              tin::exact::orientation(t[1], t[2], {x, y}) > 0 &&
                              tin::exact::orientation(t[2], t[0], {x, y}) > 0);
        }
        if (inside) fill += 16 * std::max(0.0, to.at({x, y})->z - from.at({x, y})->z);
      }
    }
    EXPECT_NEAR(c.fill_volume / fill, 1, 0.02);
  }
}

TEST(CutFillTest, TakesTerrainsThatOverlapInPartAndHaveFramesOfTheirOwn) {
  const auto make = [](double x, double y, double step, double unit_m, double z, std::int32_t size) {
    Frame frame;
    frame.x = {x, step, 1};
    frame.y = {y, step, 1};
    frame.vertical_unit_m = unit_m;
    std::vector<Placement> placements;
    for (const Point p : support::grid_points(size, size, 100)) placements.push_back({p, z});
    return *Terrain::build(frame, placements, Duplicates::kReject);
  };
  // 1000 m squares; the second is 600 m east and 700 m north, in other steps, and in feet.
  const Terrain before = make(1000, 2000, 0.1, 1, 10, 101), after = make(1600, 2700, 0.25, 0.3048, 50, 41);
  const Ground ground(before.frame(), {});
  const CutFill c = *tin::query::cut_fill(before, after, ground, {});
  EXPECT_NEAR(c.fill_area, 400 * 300, 1e-6);
  EXPECT_NEAR(c.fill_volume, 400 * 300 * (50 * 0.3048 - 10), 1e-6);
  EXPECT_EQ(c.cut_area, 0);
  const CutFill back = *tin::query::cut_fill(after, before, Ground(after.frame(), {}), {});
  EXPECT_NEAR(back.cut_volume, c.fill_volume, 1e-6);
  const Terrain apart = make(5000, 2000, 0.1, 1, 0, 3);
  EXPECT_EQ(tin::query::cut_fill(before, apart, ground, {})->fill_area, 0);
}

TEST(CutFillTest, LeavesVoidsOfEitherOut) {
  const auto full = support::heights(6, 6, [](std::int32_t, std::int32_t) { return std::optional(1.0); });
  const auto holed = [](std::int32_t column) {
    return support::heights(6, 6, [column](std::int32_t c, std::int32_t r) -> std::optional<double> {
      if (c == column && r == 2) return std::nullopt;
      return 2.0;
    });
  };
  const Terrain level = support::voided_terrain(full, 10, 10),
                left = support::voided_terrain(holed(1), 10, 10),
                right = support::voided_terrain(holed(3), 10, 10);
  EXPECT_NEAR(between(level, left).fill_area, 2400, 1e-9);
  EXPECT_NEAR(between(left, level).cut_volume, 2400, 1e-9);
  EXPECT_NEAR(between(left, right).equal_area, 2300, 1e-9);
  EXPECT_NEAR(between(left, right, {nullptr, Voids::kFill}).equal_area, 2500, 1e-9);
}

TEST(CutFillTest, RefusesDifferentReferenceSystems) {
  Frame frame;
  frame.crs = "EPSG:25832";
  const Terrain other = *Terrain::build(frame, std::vector<Placement>{{{0, 0}, 1}}, Duplicates::kReject);
  const auto refused =
      tin::query::cut_fill(support::terrain_of({{0, 0}}, support::plane), other, support::metre_ground(), {});
  ASSERT_FALSE(refused.ok());
  EXPECT_EQ(refused.error().code, Code::kInvalidValue);
}

}  // namespace
