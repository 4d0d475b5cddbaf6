// The judge of simplified terrains: compares every sample with the triangle above it and looks at every edge. It shares no code
// with the engine, and judges peers' TINs as well.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "tests/bench/dem.h"

namespace bench {

/// A TIN over a raster, in columns and rows.
struct PixelTin {
  struct Vertex {
    double column, row, z;
  };
  std::vector<Vertex> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

struct Judgement {
  double max_error = 0, rmse = 0;
  std::size_t over = 0;       // samples over the tolerance
  std::size_t uncovered = 0;  // samples under no triangle
  /// Edges with a vertex strictly inside the circle of the triangle on the other side (whole coordinates only).
  std::size_t not_delaunay = 0;
  /// Edges of one triangle only that do not lie on the raster's border: holes and T-junctions. (Of a raster with voids: not
  /// counted.)
  std::size_t open_edges = 0;
  std::vector<float> errors;  // of each sample; NaN where there is none
};

/// `tolerance`: errors up to it, and a ten-millionth of it more (they are kept in single precision), are not over.
Judgement judge(const Dem& dem, const PixelTin& tin, double tolerance);

/// "vertices triangles" in the first line, then "column row z" and "a b c" lines. Throws std::runtime_error.
PixelTin read_tin(const std::string& path);

}  // namespace bench
