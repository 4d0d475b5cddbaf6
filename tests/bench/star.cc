// The cost of removing one vertex against its degree: the paper's lower bound (figure 5), and where quadratic methods fail.
#include <algorithm>
#include <array>
#include <chrono>
#include <ctime>
#include <stdexcept>

#include "tests/bench/arguments.h"
#include "tests/bench/cgal_peer.h"
#include "tests/bench/commands.h"
#include "tests/bench/deletion.h"
#include "tests/bench/measure.h"
#include "tests/support/stars.h"
#include "tin/delaunay/triangulation.h"

namespace bench {
namespace {

using tin::delaunay::Triangulation;
using tin::exact::Point;
using tin::mesh::VertexSlot;

constexpr double kEnoughSeconds = 0.3;      // of removals, for one line
constexpr double kPatienceSeconds = 30;     // with a method that will take longer
constexpr std::size_t kFewest = 5, kMost = 2001;

/// Of one removal: on the wall's clock, and of the processor.
struct Seconds {
  double wall = 0, processor = 0;
};

class Watch {
 public:
  Seconds seconds() const {
    const Seconds now = read();
    return {now.wall - start_.wall, now.processor - start_.processor};
  }

 private:
  static Seconds read() {
    timespec processor{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &processor);
    return {std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(),
            static_cast<double>(processor.tv_sec) + 1e-9 * static_cast<double>(processor.tv_nsec)};
  }
  Seconds start_ = read();
};

double median_of(std::vector<double> times) {
  std::sort(times.begin(), times.end());
  return times[times.size() / 2];
}

/// One line of output for each method and degree.
class StarBench {
 public:
  StarBench(support::StarShape shape, support::StarCentre centre, std::uint64_t seed)
      : shape_(shape), centre_(centre), seed_(seed) {}

  /// Makes the star of that degree.
  void build(std::size_t degree) {
    support::Random random(seed_);
    ring_ = support::star_ring(shape_, centre_, degree, random);
    asked_ = degree;
    triangulation_ = Triangulation();
    std::vector<VertexSlot> slots;
    triangulation_.insert_many(ring_, slots);
    centre_vertex_ = triangulation_.insert({0, 0}).vertex;
  }

  /// Returns the median time of a removal.
  double measure(const std::string& method) {
    Deletion deletion(method);
    const double median = repeat(method, [&] {
      tin::mesh::Mesh mesh = triangulation_.mesh();
      const Watch watch;
      deletion.remove(mesh, centre_vertex_);
      return watch.seconds();
    });
    return median;
  }

  double measure_peer() {
    std::vector<Point> points = ring_;
    points.push_back({0, 0});
    const auto centre = static_cast<std::uint32_t>(points.size() - 1);
    return repeat("cgal", [&] {
      const auto peer = make_cgal_peer(false);
      if (peer == nullptr) throw std::runtime_error("this program was built without CGAL");
      peer->build(points);
      peer->remember(points);
      const Watch watch;
      peer->remove(std::span(&centre, 1));
      return watch.seconds();
    });
  }

  JsonLine line(const std::string& method) const {
    JsonLine json("star");
    json.add("shape", support::name(shape_)).add("centre", centre_ == support::StarCentre::kInside ? "inside" : "hull");
    json.add("method", method).add("asked_degree", static_cast<double>(asked_));
    return json;
  }

 private:
  template <class Removal>
  double repeat(const std::string& method, Removal&& removal) {
    std::vector<double> wall, processor;
    for (double total = 0; wall.size() < kMost && (wall.size() < kFewest || total < kEnoughSeconds);) {
      const Seconds spent = removal();
      wall.push_back(spent.wall);
      processor.push_back(spent.processor);
      total += spent.wall;
      if (total > kPatienceSeconds) break;
    }
    const double median = median_of(wall), edges = linked();
    line(method)
        .add("degree", edges)
        .add("removals", static_cast<double>(wall.size()))
        .add("median_us", 1e6 * median)
        .add("ns_per_edge", 1e9 * median / edges)
        .add("cpu_ns_per_edge", 1e9 * median_of(processor) / edges)
        .add("best_ns_per_edge", 1e9 * *std::min_element(wall.begin(), wall.end()) / edges)
        .print();
    return median;
  }

  double linked() const {
    std::vector<tin::mesh::HalfEdge> link;
    triangulation_.mesh().link(centre_vertex_, link);
    return static_cast<double>(link.size());
  }

  support::StarShape shape_;
  support::StarCentre centre_;
  std::uint64_t seed_;
  std::size_t asked_ = 0;
  std::vector<Point> ring_;
  Triangulation triangulation_;
  VertexSlot centre_vertex_{tin::mesh::kNone};
};

support::StarShape shape_named(const std::string& name) {
  for (const auto shape : support::kStarShapes) {
    if (support::name(shape) == name) return shape;
  }
  throw std::runtime_error("unknown shape " + name);
}

/// A method, and what its last star cost: a quadratic one is left out before it takes too long.
struct Runner {
  std::string method;
  double seconds = 0;
  std::size_t degree = 1;
};

void run(StarBench& star, Runner& runner, std::size_t degree) {
  const double growth = static_cast<double>(degree) / static_cast<double>(runner.degree);
  // Twice a linear growth may be the caches; what was seen to be slower per edge is taken to be quadratic.
  if (runner.seconds * growth * growth > kPatienceSeconds && runner.seconds / static_cast<double>(runner.degree) > 5e-6) {
    star.line(runner.method).add("skipped", "would take too long").print();
    return;
  }
  runner.seconds = runner.method == "cgal" ? star.measure_peer() : star.measure(runner.method);
  runner.degree = degree;
}

}  // namespace

int run_star(std::span<const std::string> arguments) {
  constexpr std::array<std::string_view, 6> kKnown{"--shape", "--degrees", "--methods", "--centre", "--seed", "--peer"};
  const Arguments options(arguments, kKnown);
  const std::string centre = options.text("--centre", "inside"), peer = options.text("--peer", "");
  if (centre != "inside" && centre != "hull") throw std::runtime_error("unknown centre " + centre);
  if (!peer.empty() && peer != "cgal") throw std::runtime_error("unknown peer " + peer);
  StarBench star(shape_named(options.text("--shape", "K")),
                 centre == "inside" ? support::StarCentre::kInside : support::StarCentre::kOnHull, options.number("--seed", 1));
  std::vector<Runner> runners;
  for (const auto& method : options.list("--methods", "production,ear3")) runners.push_back({method});
  if (!peer.empty()) runners.push_back({"cgal"});
  for (const std::size_t degree : options.numbers("--degrees", "1000,10000,100000,1000000")) {
    if (degree < 4) throw std::runtime_error("degrees must be 4 at least");
    star.build(degree);
    for (Runner& runner : runners) run(star, runner, degree);
  }
  return 0;
}

}  // namespace bench
