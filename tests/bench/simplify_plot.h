// Vertices against tolerance, on logarithmic axes, as an SVG picture.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace bench {

struct Curve {
  struct Point {
    double tolerance, vertices;
  };
  std::string name;
  std::vector<Point> points;
};

/// Adds a point to the curve of that name, which is made where there is none.
void add_point(std::vector<Curve>& curves, const std::string& name, double tolerance, std::size_t vertices);

/// Throws std::runtime_error when the file can't be written.
void write_curves(const std::string& path, const std::string& title, std::span<const Curve> curves);

}  // namespace bench
