#include "tests/bench/inputs.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <random>
#include <stdexcept>

namespace bench {

using tin::exact::in_lattice;
using tin::exact::kLatticeHalf;
using tin::exact::Point;
using Random = std::mt19937_64;

namespace {

std::vector<Point> uniform(Random& random, std::size_t count) {
  std::uniform_int_distribution<std::int32_t> coordinate(-kLatticeHalf, kLatticeHalf - 1);
  std::vector<Point> points(count);
  for (Point& p : points) p = {coordinate(random), coordinate(random)};
  return points;
}

std::vector<Point> grid(std::size_t count) {
  const auto side = static_cast<std::int32_t>(std::sqrt(static_cast<double>(count)));
  std::vector<Point> points;
  for (std::int32_t y = 0; y < side; ++y) {
    for (std::int32_t x = 0; x < side; ++x) points.push_back({(x - side / 2) * 1000, (y - side / 2) * 1000});
  }
  return points;
}

/// Millimetres: strips 300 m wide every 250 m, points about 0.3 m apart along zigzag lines; a fifth of them in clusters of 2 m.
std::vector<Point> strips(Random& random, std::size_t count) {
  constexpr int kStrips = 8;
  const std::size_t per_strip = count * 4 / 5 / kStrips;
  std::normal_distribution<double> jitter(0, 40);
  std::vector<Point> points;
  for (int strip = 0; strip < kStrips; ++strip) {
    for (std::size_t i = 0; i < per_strip; ++i) {
      const double phase = static_cast<double>(i % 1000) / 1000, line = static_cast<double>(i / 1000);
      points.push_back({static_cast<std::int32_t>(strip * 250'000 + phase * 300'000 + jitter(random)),
                        static_cast<std::int32_t>(line * 300 + phase * 300 + jitter(random))});
    }
  }
  std::uniform_int_distribution<std::size_t> centre(0, points.size() - 1);
  std::normal_distribution<double> spread(0, 2'000);
  while (points.size() < count) {
    const Point c = points[centre(random)];
    for (int i = 0; i < 5000 && points.size() < count; ++i) {
      points.push_back({static_cast<std::int32_t>(c.x + spread(random)), static_cast<std::int32_t>(c.y + spread(random))});
    }
  }
  return points;
}

std::vector<Point> from_file(const std::string& path, std::size_t count) {
  std::ifstream file(path);
  if (!file) throw std::runtime_error("Can't read " + path);
  std::vector<Point> points;
  std::int64_t x = 0, y = 0;
  while (points.size() < count && file >> x >> y) {
    if (!in_lattice(x, y)) throw std::runtime_error("A point of " + path + " lies outside the lattice");
    points.push_back({static_cast<std::int32_t>(x), static_cast<std::int32_t>(y)});
  }
  return points;
}

}  // namespace

std::vector<Point> make_input(const std::string& kind, std::size_t count, std::uint64_t seed) {
  Random random(seed);
  std::vector<Point> points = kind == "uniform"  ? uniform(random, count)
                              : kind == "grid"   ? grid(count)
                              : kind == "strips" ? strips(random, count)
                                                 : from_file(kind, count);
  std::sort(points.begin(), points.end());
  points.erase(std::unique(points.begin(), points.end()), points.end());
  std::shuffle(points.begin(), points.end(), random);
  return points;
}

}  // namespace bench
