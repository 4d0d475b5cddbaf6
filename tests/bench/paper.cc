// The paper's experiment (Devillers 2002, section 4.3): random points in a square, removed in random order by each method.
#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <stdexcept>

#include "tests/bench/arguments.h"
#include "tests/bench/cgal_peer.h"
#include "tests/bench/commands.h"
#include "tests/bench/deletion.h"
#include "tests/bench/measure.h"
#include "tests/bench/plot.h"
#include "tin/delaunay/triangulation.h"

namespace bench {
namespace {

using tin::delaunay::Triangulation;
using tin::exact::Point;
using tin::mesh::VertexSlot;

constexpr const char* kAllMethods =
    "ear3,ear3-update,ear5,flip,mixed:5,mixed:6,mixed:7,mixed:8,mixed:9,mixed:10,mixed:11,edge-completion,chew,production";

/// Row by row of a coarse grid, so that neighbours in the list are near on the ground.
std::vector<Point> random_square(std::size_t count, std::mt19937_64& random) {
  std::uniform_int_distribution<std::int32_t> coordinate(-tin::exact::kLatticeHalf, tin::exact::kLatticeHalf - 1);
  std::vector<Point> points(count);
  for (Point& p : points) p = {coordinate(random), coordinate(random)};
  std::sort(points.begin(), points.end());
  points.erase(std::unique(points.begin(), points.end()), points.end());
  const auto rows = std::max<std::int64_t>(1, std::llround(std::sqrt(static_cast<double>(count))));
  const auto row = [rows](Point p) { return (std::int64_t{p.y} + tin::exact::kLatticeHalf) * rows / (std::int64_t{2} << 29); };
  std::stable_sort(points.begin(), points.end(), [row](Point a, Point b) { return row(a) < row(b); });
  return points;
}

struct Experiment {
  std::size_t seed, repeats;
  std::vector<Point> points;
  std::vector<std::uint32_t> order;  // of removal
  Triangulation triangulation;
  std::vector<VertexSlot> slots;

  Experiment(std::size_t count, std::size_t seed_value, std::size_t repeat_count)
      : seed(seed_value), repeats(std::max<std::size_t>(1, repeat_count)) {
    std::mt19937_64 random(seed);
    points = random_square(count, random);
    order.resize(points.size());
    for (std::uint32_t i = 0; i < order.size(); ++i) order[i] = i;
    std::shuffle(order.begin(), order.end(), random);
  }

  JsonLine line(const std::string& method) const {
    JsonLine json("paper");
    json.add("method", method).add("points", static_cast<double>(points.size())).add("seed", static_cast<double>(seed));
    return json;
  }
};

void keep_best(Spent& best, const Spent& spent, bool first) {
  if (first || spent.cpu_s() < best.cpu_s()) best = spent;
}

void build(Experiment& experiment) {
  const Stopwatch watch;
  experiment.triangulation.insert_many(experiment.points, experiment.slots);
  experiment.line("build").add(watch.spent(), experiment.points.size()).print();
}

/// Removes until the vertices that are left are collinear.
void empty(const Experiment& experiment, Deletion& deletion, tin::mesh::Mesh& mesh, tin::removal::Counters* counters) {
  for (const std::uint32_t i : experiment.order) {
    if (!deletion.remove(mesh, experiment.slots[i], counters)) return;
  }
}

Bar measure(const Experiment& experiment, const std::string& method) {
  Deletion deletion(method);
  Spent best;
  for (std::size_t round = 0; round < experiment.repeats; ++round) {
    tin::mesh::Mesh mesh = experiment.triangulation.mesh();
    const Stopwatch watch;
    empty(experiment, deletion, mesh, nullptr);
    keep_best(best, watch.spent(), round == 0);
  }
  tin::removal::Counters counters;
  tin::mesh::Mesh mesh = experiment.triangulation.mesh();
  empty(experiment, deletion, mesh, &counters);
  const auto count = [](std::uint64_t n) { return static_cast<double>(n); };
  experiment.line(method)
      .add(best, experiment.points.size())
      .add("in_circle_tests", count(counters.in_circle_tests))
      .add("power_computations", count(counters.power_computations))
      .add("power_updates", count(counters.power_updates))
      .add("comparisons", count(counters.comparisons))
      .add("filter_failures", count(counters.filter_failures))
      .add("exact_evaluations", count(counters.exact_evaluations))
      .add("gmp_evaluations", count(counters.gmp_evaluations))
      .add("power_ties", count(counters.power_ties))
      .print();
  return {method, best.cpu_s(), count(counters.in_circle_tests), count(counters.power_computations + counters.power_updates)};
}

Bar measure_peer(const Experiment& experiment) {
  Spent best;
  for (std::size_t round = 0; round < experiment.repeats; ++round) {
    const auto peer = make_cgal_peer(false);
    if (peer == nullptr) throw std::runtime_error("this program was built without CGAL");
    peer->build(experiment.points);
    peer->remember(experiment.points);
    const Stopwatch watch;
    peer->remove(experiment.order);
    keep_best(best, watch.spent(), round == 0);
  }
  experiment.line("cgal").add(best, experiment.points.size()).print();
  return {"cgal", best.cpu_s(), 0, 0};
}

}  // namespace

int run_paper(std::span<const std::string> arguments) {
  constexpr std::array<std::string_view, 6> kKnown{"--points", "--seed", "--methods", "--peer", "--svg", "--repeats"};
  const Arguments options(arguments, kKnown);
  const std::string peer = options.text("--peer", ""), svg = options.text("--svg", "");
  if (!peer.empty() && peer != "cgal") throw std::runtime_error("unknown peer " + peer);
  Experiment experiment(options.number("--points", 2'000'000), options.number("--seed", 1), options.number("--repeats", 1));
  if (experiment.points.size() < 3) throw std::runtime_error("--points must be 3 at least");
  build(experiment);
  std::vector<Bar> bars;
  for (const auto& method : options.list("--methods", kAllMethods)) bars.push_back(measure(experiment, method));
  if (!peer.empty()) bars.push_back(measure_peer(experiment));
  if (!svg.empty()) {
    const std::string title = "Removing " + std::to_string(experiment.points.size()) + " random points in random order";
    write_plot(svg, title, bars);
  }
  return 0;
}

}  // namespace bench
