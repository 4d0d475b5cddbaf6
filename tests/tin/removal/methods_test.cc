// Every deletion method on every kind of input: exact, canonical, ties included, down to nothing.
#include <map>

#include "tests/support/oracle.h"
#include "tests/support/stars.h"
#include "tests/tin/removal/fixture.h"
#include "tin/removal/remover.h"

namespace {

using removal_tests::broken;
using removal_tests::RemovalTest;
using removal_tests::triples;
using support::PointSet;
using support::StarCentre;
using support::triangles;
using tin::delaunay::Triangulation;
using tin::exact::Point;
using tin::mesh::Mesh;
using tin::mesh::VertexSlot;
using tin::removal::Counters;

#ifdef NDEBUG
constexpr int kEdits = 200000;
constexpr std::size_t kLargestStar = 10000;
#else
constexpr int kEdits = 20000;
constexpr std::size_t kLargestStar = 2000;
#endif

Triangulation built(std::span<const Point> points) {
  Triangulation t;
  std::vector<VertexSlot> slots;
  t.insert_many(points, slots);
  return t;
}

/// The hard sets, and more that put many collinear and co-circular points into one link.
std::vector<PointSet> many_sets(support::Random& random, std::size_t size) {
  auto sets = support::hard_sets(random, size);
  const auto side = static_cast<std::int32_t>(std::sqrt(static_cast<double>(size)));
  PointSet rows{"two rows", {}}, cross{"cross", {}}, steps{"points one step apart", {}};
  for (std::int32_t i = 0; i < static_cast<std::int32_t>(size / 2); ++i) {
    rows.points.push_back({i, 0});
    rows.points.push_back({i, 1});
    cross.points.push_back({i - static_cast<std::int32_t>(size / 4), 0});
    cross.points.push_back({0, i - static_cast<std::int32_t>(size / 4)});
  }
  std::sort(cross.points.begin(), cross.points.end());
  cross.points.erase(std::unique(cross.points.begin(), cross.points.end()), cross.points.end());
  for (const Point p : support::grid_points(side, side, 1)) {
    if (random() % 4 != 0) steps.points.push_back(p);
  }
  sets.push_back(std::move(rows));
  sets.push_back(std::move(cross));
  sets.push_back(std::move(steps));
  for (auto& set : sets) std::shuffle(set.points.begin(), set.points.end(), random);
  return sets;
}

TEST_F(RemovalTest, NamesMakeTheirMethods) {
  for (const auto& name : tin::removal::method_names()) {
    const auto method = tin::removal::make_method(name);
    ASSERT_NE(method, nullptr) << name;
    EXPECT_EQ(method->name(), name);
  }
  for (const char* unknown : {"", "ear4", "mixed", "mixed:4", "mixed:12", "heller"}) {
    EXPECT_EQ(tin::removal::make_method(unknown), nullptr) << unknown;
  }
}

TEST_F(RemovalTest, AllMethodsAgreeOnEveryVertexOfHardSets) {
  for (const std::size_t size : {12U, 60U, 900U}) {
    for (const auto& [name, points] : many_sets(random_, size)) {
      SCOPED_TRACE(name);
      const Triangulation t = built(points);
      if (t.mesh().dimension() < 2) continue;
      for (const Point p : points) ASSERT_NO_FATAL_FAILURE(expect_all_agree(t.mesh(), vertex_at(t, p)));
      EXPECT_EQ(broken(t.mesh()), "");
    }
  }
}

TEST_F(RemovalTest, EveryMethodEmptiesHardSetsAndStaysCanonical) {
  for (const auto& [name, points] : many_sets(random_, 40)) {
    SCOPED_TRACE(name);
    const Triangulation t = built(points);
    if (t.mesh().dimension() < 2) continue;
    for (const auto& method : methods_) {
      SCOPED_TRACE(std::string(method->name()));
      Mesh mesh = t.mesh();
      std::vector<tin::mesh::TriangleSlot> fresh;
      for (std::size_t left = points.size(); left-- > 0;) {
        star_.gather(mesh, vertex_at(t, points[left]));
        if (star_.leaves_a_line()) break;
        star_.refill(mesh, method->fill(star_), fresh);
        ASSERT_EQ(broken(mesh), "") << left << " left";
        if (left % 7 == 0) {
          ASSERT_EQ(triangles(mesh), support::cgal_delaunay(std::span(points).first(left)));
        }
      }
    }
  }
}

TEST_F(RemovalTest, TinySetsEqualTheBruteForceOracle) {
  for (int round = 0; round < 40; ++round) {
    auto points = support::random_points(random_, 10, 2);
    std::shuffle(points.begin(), points.end(), random_);
    const Triangulation t = built(points);
    const Point gone = points.back();
    points.pop_back();
    for (const auto& method : methods_) {
      Mesh mesh = t.mesh();
      std::vector<tin::mesh::TriangleSlot> fresh;
      star_.gather(mesh, vertex_at(t, gone));
      if (star_.leaves_a_line()) continue;
      star_.refill(mesh, method->fill(star_), fresh);
      EXPECT_EQ(broken(mesh), "");
      EXPECT_EQ(triangles(mesh), support::brute_force_delaunay(points)) << method->name();
    }
  }
}

TEST_F(RemovalTest, AllMethodsAgreeOnStarsOfEveryDegree) {
  for (const auto shape : support::kStarShapes) {
    for (const auto centre : {StarCentre::kInside, StarCentre::kOnHull}) {
      for (const std::size_t degree : {3UL, 4UL, 5UL, 6UL, 7UL, 8UL, 9UL, 12UL, 13UL, 14UL, 40UL, 300UL, kLargestStar}) {
        SCOPED_TRACE(std::string(support::name(shape)) + " " + std::to_string(degree) + (centre == StarCentre::kOnHull ? " hull" : ""));
        const auto ring = support::star_ring(shape, centre, degree, random_);
        Triangulation t = built(ring);
        const auto before = triangles(t.mesh());
        const VertexSlot v = t.insert({0, 0}).vertex;
        ASSERT_NO_FATAL_FAILURE(expect_all_agree(t.mesh(), v));
        EXPECT_GE(star_.degree(), degree) << "the shape does not keep its promise";
        if (degree == 3 && centre == StarCentre::kOnHull) continue;
        t.remove(v);
        EXPECT_EQ(broken(t.mesh()), "");
        EXPECT_EQ(triangles(t.mesh()), before);
        EXPECT_EQ(triangles(t.mesh()), support::cgal_delaunay(ring));
      }
    }
  }
}

TEST_F(RemovalTest, AllMethodsAgreeOnExactlyCocircularLinks) {
  for (const std::int32_t scale : {1, 400}) {
    for (const bool upper_half : {false, true}) {
      auto ring = support::circle_points(scale);
      if (upper_half) std::erase_if(ring, [](Point p) { return p.y < 0; });
      Triangulation t = built(ring);
      const auto before = triangles(t.mesh());
      for (const Point centre : {Point{0, 0}, Point{scale * 100, scale * 3}, Point{-scale, scale}}) {
        const VertexSlot v = t.insert(centre).vertex;
        ASSERT_NO_FATAL_FAILURE(expect_all_agree(t.mesh(), v));
        EXPECT_GT(star_.degree(), ring.size() / 2);
        t.remove(v);
        EXPECT_EQ(broken(t.mesh()), "");
        EXPECT_EQ(triangles(t.mesh()), before);
      }
    }
  }
}

TEST_F(RemovalTest, AllMethodsAgreeThroughLongHistories) {
  for (const std::int32_t extent : {4, 40, 1 << 20}) {
    SCOPED_TRACE(extent);
    Triangulation t;
    std::map<Point, VertexSlot> present;
    std::uniform_int_distribution<std::int32_t> coordinate(-extent, extent);
    for (int step = 0; step < kEdits / 3; ++step) {
      const bool grow = present.size() < 3 || random_() % 100 < (step / 4000 % 2 == 0 ? 60 : 40);
      if (grow) {
        const Point p{coordinate(random_), coordinate(random_)};
        present.emplace(p, t.insert(p).vertex);
      } else {
        auto it = present.lower_bound({coordinate(random_), coordinate(random_)});
        if (it == present.end()) it = present.begin();
        if (t.mesh().dimension() == 2) {
          ASSERT_NO_FATAL_FAILURE(expect_all_agree(t.mesh(), it->second));
        }
        t.remove(it->second);
        present.erase(it);
      }
      if (step % 1000 == 0) {
        ASSERT_EQ(broken(t.mesh()), "");
      }
    }
    std::vector<Point> points;
    for (const auto& [p, v] : present) points.push_back(p);
    EXPECT_EQ(broken(t.mesh()), "");
    EXPECT_EQ(triangles(t.mesh()), support::cgal_delaunay(points));
  }
}

TEST_F(RemovalTest, TrialDeletionShowsWhatRemovalMakesAndTouchesNothing) {
  for (const auto& [name, points] : many_sets(random_, 60)) {
    SCOPED_TRACE(name);
    Triangulation t = built(points);
    tin::removal::Remover trial;
    for (std::size_t i = 0; i < points.size() && t.mesh().dimension() == 2; ++i) {
      const VertexSlot v = vertex_at(t, points[i]);
      const auto before = triangles(t.mesh());
      const auto ears = trial.fill(t.mesh(), v);
      ASSERT_EQ(triangles(t.mesh()), before);
      std::vector<support::Corners> promised, made;
      for (const auto [a, b, c] : ears) {
        const VertexSlot x = trial.link_vertex(a), y = trial.link_vertex(b), z = trial.link_vertex(c);
        if (x == tin::mesh::kInfinite || y == tin::mesh::kInfinite || z == tin::mesh::kInfinite) continue;
        promised.push_back(support::canonical({t.mesh().point(x), t.mesh().point(y), t.mesh().point(z)}));
      }
      t.remove(v);
      if (t.mesh().dimension() < 2) {
        EXPECT_TRUE(ears.empty());
        break;
      }
      for (const auto slot : t.fresh_triangles()) {
        if (t.mesh().is_infinite(slot)) continue;
        const auto& w = t.mesh().triangle(slot).vertices;
        made.push_back(support::canonical({t.mesh().point(w[0]), t.mesh().point(w[1]), t.mesh().point(w[2])}));
      }
      std::sort(promised.begin(), promised.end());
      std::sort(made.begin(), made.end());
      ASSERT_EQ(promised, made);
    }
    EXPECT_EQ(broken(t.mesh()), "");
  }
}

}  // namespace
