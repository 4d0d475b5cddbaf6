// Terrains on the globe, for tests of tiles.
#pragma once

#include <cmath>
#include <vector>

#include "tests/support/point_sets.h"
#include "tin/terrain/terrain.h"

namespace tests::tiles {

using tin::terrain::Duplicates;
using tin::terrain::Placement;
using tin::terrain::Terrain;

inline double hills(double x, double y) {
  return 800 + 300 * std::sin(x / 900) * std::cos(y / 700) + 40 * std::sin(x / 90 + y / 110);
}

/// `count` vertices scattered over 20 km x 15 km in UTM 32 N, near Zurich.
inline Terrain scattered(std::size_t count) {
  tin::frame::Frame frame;
  frame.crs = "EPSG:32632";
  frame.x = {460000, 1, 1000};
  frame.y = {5240000, 1, 1000};
  ::support::Random random(::support::seed());
  std::vector<Placement> placements;
  for (const auto p : ::support::random_points(random, count, 10'000'000)) {
    const tin::exact::Point at{p.x, static_cast<std::int32_t>(p.y * 0.75)};
    placements.push_back({at, hills(at.x / 1000.0, at.y / 1000.0)});
  }
  return *Terrain::build(frame, placements, Duplicates::kReplace);
}

/// A grid of n x n cells in longitude and latitude; its extent ends on sides of tiles.
inline Terrain aligned_grid(int n) {
  tin::frame::Frame frame;
  frame.crs = "EPSG:4326";
  frame.x = {7.03125, 0.17578125, 1 << 20};  // one tile of level 10
  frame.y = {45.0, 0.17578125, 1 << 20};
  std::vector<Placement> placements;
  const std::int32_t step = (1 << 20) / n;
  for (int j = 0; j <= n; ++j) {
    for (int i = 0; i <= n; ++i) placements.push_back({{i * step, j * step}, hills(i * 300.0, j * 400.0)});
  }
  return *Terrain::build(frame, placements, Duplicates::kReplace);
}

}  // namespace tests::tiles
