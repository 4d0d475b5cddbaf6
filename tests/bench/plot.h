// The paper's figure 4 as an SVG picture: time, in-circle tests and power computations of each method.
#pragma once

#include <span>
#include <string>

namespace bench {

struct Bar {
  std::string method;
  double seconds, in_circle_tests, power_computations;
};

/// Writes the picture. Throws std::runtime_error when the file can't be written.
void write_plot(const std::string& path, const std::string& title, std::span<const Bar> bars);

}  // namespace bench
