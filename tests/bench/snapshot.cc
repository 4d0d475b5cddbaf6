// tinsmith-bench snapshot: what it costs to give readers a terrain of their own, by copying it or by pages
// that are copied when they are written.
#include <cstring>
#include <memory>
#include <optional>
#include <random>
#include <set>

#include "tests/bench/arguments.h"
#include "tests/bench/commands.h"
#include "tests/bench/inputs.h"
#include "tests/bench/measure.h"
#include "tests/bench/surface.h"
#include "tin/exact/predicates.h"

namespace bench {
namespace {

using tin::exact::Point;
using tin::mesh::Mesh;
using tin::mesh::Triangle;
using tin::mesh::TriangleSlot;
using tin::mesh::VertexSlot;
using tin::terrain::Terrain;

/// An array as it is.
template <class T>
class Flat {
 public:
  explicit Flat(std::vector<T> items) : items_(std::move(items)) {}
  const T& operator[](std::size_t i) const { return items_[i]; }

 private:
  std::vector<T> items_;
};

/// An array in pages of a power of two of items, as copying on write needs it: each access looks up its page.
template <class T>
class Paged {
 public:
  Paged(const std::vector<T>& items, std::size_t page_bytes) {
    while ((sizeof(T) << (shift_ + 1)) <= page_bytes) ++shift_;
    mask_ = (std::size_t{1} << shift_) - 1;
    for (std::size_t at = 0; at < items.size(); at += mask_ + 1) {
      pages_.push_back(std::make_shared<std::vector<T>>(
          items.begin() + static_cast<std::ptrdiff_t>(at),
          items.begin() + static_cast<std::ptrdiff_t>(std::min(items.size(), at + mask_ + 1))));
      table_.push_back(pages_.back()->data());
    }
  }
  const T& operator[](std::size_t i) const { return table_[i >> shift_][i & mask_]; }
  std::size_t pages() const { return pages_.size(); }
  /// What taking a snapshot is: a count for each page.
  std::vector<std::shared_ptr<std::vector<T>>> snapshot() const { return pages_; }

 private:
  std::vector<std::shared_ptr<std::vector<T>>> pages_;
  std::vector<T*> table_;
  unsigned shift_ = 0;
  std::size_t mask_ = 0;
};

/// A walk by visibility, from a triangle that is not infinite. The triangle where it ends.
template <class Triangles, class Points>
std::uint32_t walk(const Triangles& triangles, const Points& points, Point goal, std::uint32_t t) {
  for (;;) {
    const Triangle& here = triangles[t];
    if (here.vertices[0].value() == 0 || here.vertices[1].value() == 0 || here.vertices[2].value() == 0)
      return t;
    const Point a = points[here.vertices[0].value()], b = points[here.vertices[1].value()],
                c = points[here.vertices[2].value()];
    const int out = tin::exact::orientation(b, c, goal) < 0   ? 0
                    : tin::exact::orientation(c, a, goal) < 0 ? 1
                    : tin::exact::orientation(a, b, goal) < 0 ? 2
                                                              : -1;
    if (out < 0) return t;
    t = here.neighbours[static_cast<std::size_t>(out)].triangle().value();
  }
}

/// Walks of a few dozen triangles each, here and there.
template <class Triangles, class Points>
void measure_walks(const std::string& what, const Triangles& triangles, const Points& points,
                   const std::vector<Point>& goals, const std::vector<std::uint32_t>& starts) {
  for (int round = 0; round < 3; ++round) {
    const Stopwatch watch;
    double sum = 0;
    for (std::size_t i = 0; i < goals.size(); ++i) sum += walk(triangles, points, goals[i], starts[i]);
    JsonLine("snapshot").add("what", what).add("result", sum).add(watch.spent(), goals.size()).print();
  }
}

/// In how many pages of its arrays an insertion writes.
void measure_pages(const Terrain& terrain, std::size_t page_bytes, std::mt19937_64& random) {
  constexpr int kEdits = 12;
  const auto box = *terrain.bounds();
  Terrain edited = terrain;
  double pages = 0;
  for (int i = 0; i < kEdits; ++i) {
    const Terrain before = edited;
    const auto between = [&](std::int32_t low, std::int32_t high) {
      return std::uniform_int_distribution<std::int32_t>(low, high)(random);
    };
    const tin::terrain::Edit insert =
        tin::terrain::Insert{{between(box.min.x, box.max.x), between(box.min.y, box.max.y)}, 500};
    if (!edited.apply({&insert, 1}, tin::terrain::Duplicates::kReplace)) continue;
    const Mesh &old = before.mesh(), &now = edited.mesh();
    std::set<std::size_t> of_triangles, of_points, of_stars, of_heights;
    for (std::uint32_t t = 0; t < now.triangle_slots(); ++t) {
      const bool same =
          t < old.triangle_slots() &&
          std::memcmp(&old.triangle(TriangleSlot(t)), &now.triangle(TriangleSlot(t)), sizeof(Triangle)) == 0;
      if (!same) of_triangles.insert(t * sizeof(Triangle) / page_bytes);
    }
    for (std::uint32_t v = 1; v < now.vertex_slots(); ++v) {
      const VertexSlot slot(v);
      const bool fresh = v >= old.vertex_slots() || old.is_alive(slot) != now.is_alive(slot);
      if (fresh) of_points.insert(v * sizeof(Point) / page_bytes);
      if (fresh) of_heights.insert(v * sizeof(double) / page_bytes);
      if (fresh || (now.is_alive(slot) && old.triangle_at(slot) != now.triangle_at(slot)))
        of_stars.insert(v * sizeof(std::uint32_t) / page_bytes);
    }
    // And one for the ids.
    pages +=
        static_cast<double>(of_triangles.size() + of_points.size() + of_stars.size() + of_heights.size() + 1);
  }
  JsonLine("snapshot")
      .add("what", "pages that an insertion writes")
      .add("page_bytes", static_cast<double>(page_bytes))
      .add("result", pages / kEdits)
      .print();
}

}  // namespace

int run_snapshot(std::span<const std::string> arguments) {
  static constexpr std::string_view kOptions[] = {"--input", "--points", "--seed", "--page"};
  const Arguments options(arguments, kOptions);
  const std::size_t count = options.number("--points", 2'000'000), page = options.number("--page", 16'384);
  const std::uint64_t seed = options.number("--seed", 1);
  std::mt19937_64 random(seed);
  const Terrain terrain = wavy_terrain(options.text("--input", "uniform"), count, seed);
  for (int round = 0; round < 5; ++round) {
    const Stopwatch watch;
    const auto copy = std::make_unique<Terrain>(terrain);
    JsonLine("snapshot")
        .add("what", "copy of the whole")
        .add("result", static_cast<double>(copy->vertex_count()))
        .add(watch.spent(), 1)
        .print();
  }
  measure_pages(terrain, page, random);

  const Mesh& mesh = terrain.mesh();
  std::vector<Triangle> triangles;
  std::vector<Point> points(1);
  for (std::uint32_t t = 0; t < mesh.triangle_slots(); ++t)
    triangles.push_back(mesh.triangle(TriangleSlot(t)));
  for (std::uint32_t v = 1; v < mesh.vertex_slots(); ++v) points.push_back(mesh.point(VertexSlot(v)));
  std::vector<Point> goals;
  std::vector<std::uint32_t> starts;
  while (goals.size() < 500'000) {
    const auto t = static_cast<std::uint32_t>(random() % triangles.size());
    if (mesh.is_infinite(TriangleSlot(t))) continue;
    const Point at = mesh.point(mesh.vertex(TriangleSlot(t), 0));
    std::uniform_int_distribution<std::int32_t> near(-4'000'000, 4'000'000);
    const std::int64_t x = at.x + near(random), y = at.y + near(random);
    if (!tin::exact::in_lattice(x, y)) continue;
    goals.push_back({static_cast<std::int32_t>(x), static_cast<std::int32_t>(y)});
    starts.push_back(t);
  }
  {
    const Paged<Triangle> paged_triangles(triangles, page);
    const Paged<Point> paged_points(points, page);
    const Stopwatch watch;
    const auto first = paged_triangles.snapshot();
    const auto second = paged_points.snapshot();
    JsonLine("snapshot")
        .add("what", "snapshot of pages")
        .add("result", static_cast<double>(first.size() + second.size()))
        .add(watch.spent(), 1)
        .print();
    measure_walks("walks on pages", paged_triangles, paged_points, goals, starts);
  }
  const Flat<Triangle> flat_triangles(std::move(triangles));
  const Flat<Point> flat_points(std::move(points));
  measure_walks("walks on flat arrays", flat_triangles, flat_points, goals, starts);
  return 0;
}

}  // namespace bench
