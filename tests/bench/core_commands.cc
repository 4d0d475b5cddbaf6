#include "tests/bench/core_commands.h"

#include <algorithm>
#include <cstdint>
#include <functional>
#include <memory>
#include <numeric>
#include <random>
#include <stdexcept>
#include <vector>

#include "tests/bench/cgal_peer.h"
#include "tests/bench/inputs.h"
#include "tests/bench/measure.h"
#include "tin/delaunay/triangulation.h"

namespace bench {

using tin::delaunay::Location;
using tin::delaunay::Triangulation;
using tin::exact::Point;
using tin::mesh::VertexSlot;

namespace {

constexpr double kElevationBytes = 8;

struct Options {
  std::string input = "uniform";
  std::string order = "random";
  std::size_t points = 2'000'000;
  std::size_t batch = 0;  // operations per batch; 0: one by one
  std::size_t repeats = 3;
  std::uint64_t seed = 1;
  unsigned threads = 1;
  bool peer = false;
  bool keep_order = false;  // removal in batches: fetching ahead only
};

std::size_t number(const std::string& text) {
  std::size_t used = 0;
  const std::size_t value = std::stoull(text, &used);
  if (used != text.size()) throw std::runtime_error("Not a number: " + text);
  return value;
}

Options parse(std::span<const std::string> arguments) {
  Options options;
  for (std::size_t i = 0; i < arguments.size(); ++i) {
    const std::string& name = arguments[i];
    const bool has_value = i + 1 < arguments.size() && arguments[i + 1].rfind("--", 0) != 0;
    const std::string value = has_value ? arguments[++i] : "";
    if (name == "--input") {
      options.input = value;
    } else if (name == "--order") {
      options.order = value;
    } else if (name == "--points") {
      options.points = number(value);
    } else if (name == "--batch") {
      options.batch = has_value ? number(value) : 100'000;
    } else if (name == "--repeats") {
      options.repeats = number(value);
    } else if (name == "--seed") {
      options.seed = number(value);
    } else if (name == "--threads") {
      options.threads = static_cast<unsigned>(number(value));
    } else if (name == "--keep-order") {
      options.keep_order = true;
    } else if (name == "--peer" && value == "cgal") {
      options.peer = true;
    } else {
      throw std::runtime_error("Unknown option: " + name + " " + value);
    }
  }
  if (options.order != "random" && options.order != "storage" && options.order != "sorted") {
    throw std::runtime_error("--order is random, storage or sorted");
  }
  return options;
}

JsonLine line(const char* command, const char* who, const Options& options, std::size_t round, std::size_t points) {
  JsonLine json(command);
  json.add("who", who).add("input", options.input).add("points", static_cast<double>(points));
  json.add("memory", round == 0 ? "cold" : "warm");
  return json;
}

/// Alternates our measurement with the peer's, and ends with the ratio of the medians of the warm rounds.
class Duel {
 public:
  Duel(const char* command, const Options& options, std::size_t operations)
      : command_(command), options_(options), operations_(operations) {}

  /// `ours` and `peers` return their time; they add to the line what else there is to say.
  void run(const std::function<Spent(JsonLine&)>& ours, const std::function<Spent(JsonLine&)>& peers) {
    for (std::size_t round = 0; round < std::max<std::size_t>(options_.repeats, 1); ++round) {
      ours_.push_back(measure("tinsmith", round, ours));
      if (options_.peer && make_cgal_peer(false)) peers_.push_back(measure("cgal", round, peers));
    }
    if (peers_.empty()) return;
    JsonLine(command_).add("who", "ratio").add("input", options_.input).add("batch", double(options_.batch))
        .add("order", options_.order).add("threads", options_.threads)
        .add("warm_wall", median(peers_, &Spent::wall_s) / median(ours_, &Spent::wall_s))
        .add("warm_user", median(peers_, &Spent::user_s) / median(ours_, &Spent::user_s))
        .add("first_wall", peers_[0].wall_s / ours_[0].wall_s).add("first_cpu", peers_[0].cpu_s() / ours_[0].cpu_s()).print();
  }

 private:
  Spent measure(const char* who, std::size_t round, const std::function<Spent(JsonLine&)>& what) const {
    JsonLine json = line(command_, who, options_, round, options_.points);
    json.add("operations", double(operations_)).add("batch", double(options_.batch)).add("order", options_.order)
        .add("threads", options_.threads);
    const Spent spent = what(json);
    json.add(spent, operations_).print();
    return spent;
  }

  /// Of the warm rounds, if there are any.
  static double median(const std::vector<Spent>& rounds, double Spent::*what) {
    std::vector<double> times;
    for (const Spent& spent : rounds) times.push_back(spent.*what);
    if (times.size() > 1) times.erase(times.begin());
    std::nth_element(times.begin(), times.begin() + static_cast<std::ptrdiff_t>(times.size() / 2), times.end());
    return times[times.size() / 2];
  }

  const char* command_;
  const Options& options_;
  std::size_t operations_;
  std::vector<Spent> ours_, peers_;
};

/// All points, in the order of their slots in a mesh built at once: along the Hilbert curve.
std::vector<Point> in_storage_order(const Triangulation& triangulation) {
  std::vector<Point> points;
  for (std::uint32_t i = 1; i < triangulation.mesh().vertex_slots(); ++i) points.push_back(triangulation.mesh().point(VertexSlot(i)));
  return points;
}

/// Positions 0..count in the order asked for; `points` are in storage order.
std::vector<std::uint32_t> make_order(const Options& options, const std::vector<Point>& points) {
  std::vector<std::uint32_t> order(points.size());
  std::iota(order.begin(), order.end(), 0);
  std::mt19937_64 random(options.seed + 1);
  if (options.order == "random") std::shuffle(order.begin(), order.end(), random);
  if (options.order == "sorted") {
    std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) { return points[a] < points[b]; });
  }
  return order;
}

std::vector<Point> permuted(const std::vector<Point>& points, const std::vector<std::uint32_t>& order) {
  std::vector<Point> result;
  for (const std::uint32_t i : order) result.push_back(points[i]);
  return result;
}

Triangulation built(const std::vector<Point>& points) {
  Triangulation triangulation;
  std::vector<VertexSlot> slots;
  triangulation.insert_many(points, slots);
  return triangulation;
}

}  // namespace

int run_build(std::span<const std::string> arguments) {
  const Options options = parse(arguments);
  const auto points = make_input(options.input, options.points, options.seed);
  const auto ours = [&](JsonLine& json) {
    const PeakMemory peak(tin::mesh::kept_pages());
    Triangulation triangulation;
    std::vector<VertexSlot> slots;
    const Stopwatch watch;
    triangulation.insert_many(points, slots, nullptr, options.threads);
    const Spent spent = watch.spent();
    const auto count = static_cast<double>(points.size());
    json.add("triangles", double(triangulation.mesh().finite_triangle_count()));
    json.add("bytes_per_vertex", double(triangulation.bytes()) / count + kElevationBytes);
    json.add("peak_bytes_per_vertex", double(peak.bytes()) / count + kElevationBytes);
    return spent;
  };
  const auto peers = [&](JsonLine& json) {
    const PeakMemory peak;
    const auto peer = make_cgal_peer(false);
    const Stopwatch watch;
    peer->build(points);
    const Spent spent = watch.spent();
    json.add("peak_bytes_per_vertex", double(peak.bytes()) / double(points.size()));
    json.add("vertices", double(peer->vertices()));
    return spent;
  };
  Duel("build", options, points.size()).run(ours, peers);
  return 0;
}

int run_insert(std::span<const std::string> arguments) {
  const Options options = parse(arguments);
  const auto stored = in_storage_order(built(make_input(options.input, options.points, options.seed)));
  const auto points = permuted(stored, make_order(options, stored));
  const auto ours = [&](JsonLine& json) {
    Triangulation triangulation;
    std::vector<VertexSlot> slots;
    const Stopwatch watch;
    for (std::size_t i = 0; options.batch == 0 && i < points.size(); ++i) triangulation.insert(points[i]);
    for (std::size_t i = 0; options.batch != 0 && i < points.size(); i += options.batch) {
      triangulation.insert_many(std::span(points).subspan(i, std::min(options.batch, points.size() - i)), slots);
    }
    const Spent spent = watch.spent();
    json.add("triangles", double(triangulation.mesh().finite_triangle_count()));
    json.add("bytes_per_vertex", double(triangulation.bytes()) / double(points.size()) + kElevationBytes);
    return spent;
  };
  const auto peers = [&](JsonLine& json) {
    const auto peer = make_cgal_peer(true);
    const Stopwatch watch;
    peer->insert(points);
    const Spent spent = watch.spent();
    json.add("vertices", double(peer->vertices()));
    return spent;
  };
  Duel("insert", options, points.size()).run(ours, peers);
  return 0;
}

int run_locate(std::span<const std::string> arguments) {
  const Options options = parse(arguments);
  const auto points = make_input(options.input, options.points, options.seed);
  const Triangulation triangulation = built(points);
  // Queries near points, so that they follow the input's distribution.
  std::mt19937_64 random(options.seed + 2);
  std::uniform_int_distribution<std::int32_t> offset(-500, 500);
  const auto stored = in_storage_order(triangulation);
  auto queries = permuted(stored, make_order(options, stored));
  for (Point& q : queries) {
    const std::int32_t x = q.x + offset(random), y = q.y + offset(random);
    if (tin::exact::in_lattice(x, y)) q = {x, y};
  }
  const auto peer = options.peer ? make_cgal_peer(true) : nullptr;
  if (peer) peer->build(points);
  const auto ours = [&](JsonLine& json) {
    std::size_t inside = 0;
    std::vector<Location> found;
    const Stopwatch watch;
    for (std::size_t i = 0; options.batch == 0 && i < queries.size(); ++i) {
      inside += triangulation.locate(queries[i]).kind == Location::Kind::kOutsideHull ? 0 : 1;
    }
    for (std::size_t i = 0; options.batch != 0 && i < queries.size(); i += options.batch) {
      triangulation.locate_many(std::span(queries).subspan(i, std::min(options.batch, queries.size() - i)), found);
      for (const Location& where : found) inside += where.kind == Location::Kind::kOutsideHull ? 0 : 1;
    }
    const Spent spent = watch.spent();
    json.add("inside", double(inside));
    return spent;
  };
  const auto peers = [&](JsonLine& json) {
    const Stopwatch watch;
    json.add("inside", double(peer->locate(queries)));
    return watch.spent();
  };
  Duel("locate", options, queries.size()).run(ours, peers);
  return 0;
}

int run_remove(std::span<const std::string> arguments) {
  const Options options = parse(arguments);
  const Triangulation full = built(make_input(options.input, options.points, options.seed));
  const auto points = in_storage_order(full);
  const auto order = make_order(options, points);
  const std::size_t count = order.size() - 4;  // some triangles stay
  const auto ours = [&](JsonLine& json) {
    Triangulation triangulation = full;
    std::vector<VertexSlot> slots;
    for (std::size_t i = 0; i < count; ++i) slots.emplace_back(order[i] + 1);
    const Stopwatch watch;
    for (std::size_t i = 0; options.batch == 0 && i < count; ++i) triangulation.remove(slots[i]);
    for (std::size_t i = 0; options.batch != 0 && i < count; i += options.batch) {
      const auto part = std::span(slots).subspan(i, std::min(options.batch, count - i));
      options.keep_order ? triangulation.remove_in_order(part) : triangulation.remove_many(part);
    }
    const Spent spent = watch.spent();
    json.add("triangles", double(triangulation.mesh().finite_triangle_count()));
    return spent;
  };
  const auto peers = [&](JsonLine& json) {
    const auto peer = make_cgal_peer(false);
    peer->build(points);
    peer->remember(points);
    const Stopwatch watch;
    peer->remove(std::span(order).first(count));
    const Spent spent = watch.spent();
    json.add("vertices", double(peer->vertices()));
    return spent;
  };
  Duel("remove", options, count).run(ours, peers);
  return 0;
}

}  // namespace bench
