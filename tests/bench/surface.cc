// tinsmith-bench surface: what questions about a surface cost.
#include "tests/bench/surface.h"

#include <algorithm>
#include <cmath>
#include <random>

#include "tests/bench/arguments.h"
#include "tests/bench/commands.h"
#include "tests/bench/inputs.h"
#include "tests/bench/measure.h"
#include "tin/frame/ground.h"
#include "tin/query/contour.h"
#include "tin/query/elevation.h"
#include "tin/query/profile.h"
#include "tin/query/volume.h"

namespace bench {

using tin::exact::Point;
using tin::query::ElevationQuery;
using tin::query::Interpolation;
using tin::query::Voids;
using tin::terrain::Duplicates;
using tin::terrain::Placement;
using tin::terrain::Terrain;

Terrain wavy_terrain(const std::string& input, std::size_t points, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> noise(0, 20);
  std::vector<Placement> placements;
  for (const Point p : make_input(input, points, seed)) {
    placements.push_back({p, 490 + 300 * std::sin(p.x / 5e7) + 180 * std::cos(p.y / 3e7) + noise(random)});
  }
  tin::frame::Frame frame;
  frame.x = frame.y = {0, 1, 1};
  return *Terrain::build(frame, placements, Duplicates::kReplace);
}

namespace {

/// Runs `work`, which returns what it made, and prints what it took.
template <class Work>
void measure(const std::string& what, std::size_t operations, const Work& work) {
  const Stopwatch watch;
  const double result = work();
  const Spent spent = watch.spent();
  JsonLine("surface")
      .add("what", what)
      .add("operations", static_cast<double>(operations))
      .add("result", result)
      .add(spent, operations)
      .print();
}

double sum_of_elevations(const Terrain& terrain, const std::vector<Point>& at, Interpolation by) {
  ElevationQuery query(terrain, Voids::kKeep, by);
  double sum = 0;
  for (const Point p : at) {
    if (const auto found = query.at(p)) sum += found->z;
  }
  return sum;
}

}  // namespace

int run_surface(std::span<const std::string> arguments) {
  static constexpr std::string_view kOptions[] = {"--input", "--points", "--seed", "--levels"};
  const Arguments options(arguments, kOptions);
  const std::size_t count = options.number("--points", 1'000'000), levels = options.number("--levels", 50);
  const std::uint64_t seed = options.number("--seed", 1);
  const std::string input = options.text("--input", "uniform");
  const Terrain terrain = wavy_terrain(input, count, seed), other = wavy_terrain(input, count, seed + 1);
  const tin::frame::Ground ground(terrain.frame(), {});
  const std::size_t triangles = terrain.triangle_count();

  // Rows of positions, so that walks are short.
  const auto box = *terrain.bounds();
  std::vector<Point> at;
  for (int i = 0; i < 1000; ++i) {
    for (int k = 0; k < 1000; ++k) {
      at.push_back({static_cast<std::int32_t>(box.min.x + (double(box.max.x) - box.min.x) * k / 1000),
                    static_cast<std::int32_t>(box.min.y + (double(box.max.y) - box.min.y) * i / 1000)});
    }
  }
  measure("elevation, linear", at.size(),
          [&] { return sum_of_elevations(terrain, at, Interpolation::kLinear); });
  measure("elevation, natural neighbour", at.size(),
          [&] { return sum_of_elevations(terrain, at, Interpolation::kNaturalNeighbour); });

  measure("volume against a level", triangles,
          [&] { return tin::query::volumes_at(terrain, ground, 500, {})->volume_above; });
  measure("surface area", triangles, [&] { return tin::query::surface_area(terrain, ground, {})->surface; });
  measure("cut and fill between two", triangles,
          [&] { return tin::query::cut_fill(terrain, other, ground, {})->fill_volume; });

  const double interval = 1000.0 / static_cast<double>(levels);
  std::size_t places = 0;
  measure("contours", triangles, [&] {
    tin::query::ContourTracer tracer(terrain, *tin::query::contour_levels(terrain, interval, 0, 1'000'000),
                                     {});
    std::size_t lines = 0;
    for (tin::query::ContourLine line; tracer.next(line); ++lines) places += line.places.size();
    return static_cast<double>(lines);
  });
  JsonLine("surface").add("what", "contour places").add("result", static_cast<double>(places)).print();

  const std::vector<Point> diagonal{box.min, box.max};
  const auto profile = tin::query::profile(terrain, ground, diagonal, Voids::kKeep, 100'000'000);
  measure("profile across", profile->size(), [&] {
    return tin::query::profile(terrain, ground, diagonal, Voids::kKeep, 100'000'000)->back().distance;
  });
  return 0;
}

}  // namespace bench
