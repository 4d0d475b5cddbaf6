// The benchmark's commands: one function each, listed in main.cc.
#pragma once

#include <span>
#include <string>

namespace bench {

/// Each takes what follows the command's name and returns the exit status; README.md has the options. Bad ones throw
/// std::runtime_error.
int run_paper(std::span<const std::string> arguments);
int run_star(std::span<const std::string> arguments);
int run_simplify(std::span<const std::string> arguments);
int run_scale(std::span<const std::string> arguments);
int run_raster(std::span<const std::string> arguments);
int run_surface(std::span<const std::string> arguments);
int run_snapshot(std::span<const std::string> arguments);

}  // namespace bench
