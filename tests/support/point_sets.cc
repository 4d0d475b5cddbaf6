#include "tests/support/point_sets.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <set>

namespace support {

using tin::exact::kLatticeHalf;
using tin::exact::Point;

std::uint64_t seed() {
  const char* given = std::getenv("TINSMITH_SEED");
  return given != nullptr ? std::strtoull(given, nullptr, 10) : 20021128;
}

std::vector<Point> random_points(Random& random, std::size_t count, std::int32_t extent) {
  std::uniform_int_distribution<std::int32_t> coordinate(-extent, extent);
  std::set<Point> points;
  while (points.size() < count) points.insert({coordinate(random), coordinate(random)});
  return {points.begin(), points.end()};
}

std::vector<Point> grid_points(std::int32_t columns, std::int32_t rows, std::int32_t step, Point origin) {
  std::vector<Point> points;
  for (std::int32_t r = 0; r < rows; ++r) {
    for (std::int32_t c = 0; c < columns; ++c) points.push_back({origin.x + c * step, origin.y + r * step});
  }
  return points;
}

std::vector<Point> circle_points(std::int32_t scale, Point centre) {
  const std::int64_t radius = 5 * 13 * 17 * 29;
  std::vector<Point> points;
  std::int64_t y = radius;
  for (std::int64_t x = 0; x <= radius; ++x) {
    while (x * x + y * y > radius * radius) --y;
    if (x * x + y * y != radius * radius) continue;
    for (const std::int64_t sx : {-1, 1}) {
      for (const std::int64_t sy : {-1, 1}) {
        const Point p{static_cast<std::int32_t>(centre.x + sx * x * scale),
                      static_cast<std::int32_t>(centre.y + sy * y * scale)};
        if (std::find(points.begin(), points.end(), p) == points.end()) points.push_back(p);
      }
    }
  }
  return points;
}

std::vector<Point> line_points(std::size_t count, std::int32_t dx, std::int32_t dy) {
  std::vector<Point> points;
  for (std::size_t i = 0; i < count; ++i) {
    const auto t = static_cast<std::int32_t>(i) - static_cast<std::int32_t>(count / 2);
    points.push_back({t * dx, t * dy});
  }
  return points;
}

std::vector<Point> nested_squares(int count) {
  std::vector<Point> points{{0, 0}};
  for (std::int32_t i = 1; i <= count; ++i) {
    for (const Point corner : {Point{i, i}, Point{i, -i}, Point{-i, i}, Point{-i, -i}}) points.push_back(corner);
  }
  return points;
}

std::vector<Point> corner_clusters(Random& random, std::size_t per_corner) {
  std::vector<Point> points;
  for (const Point corner : {Point{-kLatticeHalf, -kLatticeHalf}, Point{kLatticeHalf - 21, -kLatticeHalf},
                             Point{-kLatticeHalf, kLatticeHalf - 21}, Point{kLatticeHalf - 21, kLatticeHalf - 21}}) {
    for (const Point p : random_points(random, per_corner, 10)) points.push_back({corner.x + 10 + p.x, corner.y + 10 + p.y});
  }
  return points;
}

std::vector<PointSet> hard_sets(Random& random, std::size_t size) {
  const auto side = static_cast<std::int32_t>(std::max<std::size_t>(2, static_cast<std::size_t>(std::sqrt(double(size)))));
  std::vector<PointSet> sets{
      {"random, wide", random_points(random, size, kLatticeHalf - 1)},
      {"random, crowded", random_points(random, size, side)},
      {"grid, step 1", grid_points(side, side, 1)},
      {"grid, far out", grid_points(side, side, 7, {kLatticeHalf - 8 * side, -kLatticeHalf})},
      {"grid, tilted", {}},
      {"circle", circle_points(1)},
      {"circle with its centre", circle_points(400, {1000, -1000})},
      {"line", line_points(size, 3, -2)},
      {"line with one point off it", line_points(size, 1000, 0)},
      {"nested squares", nested_squares(static_cast<int>(size / 4))},
      {"corner clusters", corner_clusters(random, std::min<std::size_t>(size / 4, 300))},
  };
  for (const Point p : grid_points(side, side, 1)) sets[4].points.push_back({3 * p.x - 4 * p.y, 4 * p.x + 3 * p.y});
  sets[6].points.push_back({1000, -1000});
  sets[8].points.push_back({500, 777});
  for (auto& set : sets) std::shuffle(set.points.begin(), set.points.end(), random);
  return sets;
}

}  // namespace support
