// The benchmarks of the triangulation: build, insert, locate and remove, against CGAL in the same process.
#pragma once

#include <span>
#include <string>

namespace bench {

/// Each takes what follows the command's name and returns the exit status; README.md has the options. Bad ones throw
/// std::runtime_error.
int run_build(std::span<const std::string> arguments);
int run_insert(std::span<const std::string> arguments);
int run_locate(std::span<const std::string> arguments);
int run_remove(std::span<const std::string> arguments);

}  // namespace bench
