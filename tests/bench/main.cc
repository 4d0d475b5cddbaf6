// tinsmith-bench COMMAND [options]: what the engine costs, as lines of JSON. See README.md.
#include "tests/bench/commands.h"

#include <cstdio>
#include <exception>
#include <string>
#include <vector>

#include "tests/bench/core_commands.h"

int main(int argc, char** argv) {
  static constexpr struct {
    const char* name;
    int (*run)(std::span<const std::string>);
  } kCommands[] = {
      {"paper", bench::run_paper},       {"star", bench::run_star},     {"build", bench::run_build},
      {"insert", bench::run_insert},     {"locate", bench::run_locate}, {"remove", bench::run_remove},
      {"simplify", bench::run_simplify}, {"raster", bench::run_raster}, {"surface", bench::run_surface},
      {"snapshot", bench::run_snapshot}, {"scale", bench::run_scale},
  };
  const std::vector<std::string> arguments(argv + 1, argv + argc);
  try {
    for (const auto& command : kCommands) {
      if (!arguments.empty() && arguments[0] == command.name) return command.run(std::span(arguments).subspan(1));
    }
    std::fputs("usage: tinsmith-bench COMMAND [options], where COMMAND is one of", stderr);
    for (const auto& command : kCommands) std::fprintf(stderr, " %s", command.name);
    std::fputs("\n", stderr);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "tinsmith-bench: %s\n", error.what());
  }
  return 2;
}
