// Point sets that are hard on a Delaunay triangulation, and the seed that makes the random ones.
#pragma once

#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include "tin/exact/point.h"

namespace support {

using Random = std::mt19937_64;

/// The seed of this run: TINSMITH_SEED if set, else a fixed one. Tests print it with SCOPED_TRACE.
std::uint64_t seed();

struct PointSet {
  std::string name;
  std::vector<tin::exact::Point> points;
};

/// Distinct points in [-extent, extent]^2.
std::vector<tin::exact::Point> random_points(Random& random, std::size_t count, std::int32_t extent);
/// columns x rows points, `step` apart, lower left at `origin`.
std::vector<tin::exact::Point> grid_points(std::int32_t columns, std::int32_t rows, std::int32_t step,
                                           tin::exact::Point origin = {0, 0});
/// All integer points on a circle of radius 5 * 13 * 17 * 29 * scale: 108 of them, exactly co-circular.
std::vector<tin::exact::Point> circle_points(std::int32_t scale, tin::exact::Point centre = {0, 0});
/// Points on the line through the origin with direction (dx, dy).
std::vector<tin::exact::Point> line_points(std::size_t count, std::int32_t dx, std::int32_t dy);
/// Squares within squares, all corners of all of them, with their common centre.
std::vector<tin::exact::Point> nested_squares(int count);
/// Clusters at the four corners of the lattice.
std::vector<tin::exact::Point> corner_clusters(Random& random, std::size_t per_corner);

/// One small set of each kind, of at most about `size` points, shuffled.
std::vector<PointSet> hard_sets(Random& random, std::size_t size);

}  // namespace support
