#include <cstdio>
#include <exception>
#include <string>
#include <vector>

#include "tests/bench/core_commands.h"

int main(int argc, char** argv) {
  const std::vector<std::string> arguments(argv + 1, argv + argc);
  const struct {
    const char* name;
    int (*run)(std::span<const std::string>);
  } commands[] = {{"build", bench::run_build}, {"insert", bench::run_insert}, {"locate", bench::run_locate}, {"remove", bench::run_remove}};
  try {
    for (const auto& command : commands) {
      if (!arguments.empty() && arguments[0] == command.name) return command.run(std::span(arguments).subspan(1));
    }
    std::fprintf(stderr, "usage: %s build|insert|locate|remove [options]\n", argv[0]);
  } catch (const std::exception& e) {
    std::fprintf(stderr, "%s\n", e.what());
  }
  return 2;
}
