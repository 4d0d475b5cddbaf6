// tinsmith-bench scale: a raster larger than it should be in memory, through `tinsmith simplify`, and what
// that takes.
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "tests/bench/arguments.h"
#include "tests/bench/commands.h"
#include "tests/bench/fractal.h"
#include "tests/bench/measure.h"

namespace bench {

namespace {

constexpr std::string_view kOptions[] = {"--program",  "--side",    "--folder",  "--tolerance", "--efforts",
                                         "--memories", "--threads", "--outputs", "--seed"};

/// In bytes.
struct Memory {
  std::size_t resident = 0, anonymous = 0, of_files = 0;
};

/// The most of each that a running process had.
class MemoryWatch {
 public:
  void look(pid_t process) {
    std::ifstream status("/proc/" + std::to_string(process) + "/status");
    std::string name, unit;
    std::size_t files = 0, kilobytes = 0;
    while (status >> name) {
      if (!name.starts_with("Vm") && !name.starts_with("Rss")) continue;
      status >> kilobytes >> unit;
      if (name == "VmHWM:") most_.resident = std::max(most_.resident, kilobytes * 1024);
      if (name == "RssAnon:") most_.anonymous = std::max(most_.anonymous, kilobytes * 1024);
      if (name == "RssFile:" || name == "RssShmem:") files += kilobytes * 1024;
    }
    most_.of_files = std::max(most_.of_files, files);
  }
  const Memory& most() const { return most_; }

 private:
  Memory most_;
};

struct Run {
  Spent spent;
  Memory memory;
  std::string report;
};

Run run(const std::vector<std::string>& words, const std::string& report) {
  const Stopwatch watch;
  const pid_t child = start(words, report);
  int status = 0;
  struct rusage used {};
  MemoryWatch memory;
  while (child > 0 && wait4(child, &status, WNOHANG, &used) == 0) {
    memory.look(child);
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  if (child < 0 || status != 0) throw std::runtime_error(words[0] + " failed");
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + static_cast<double>(t.tv_usec) * 1e-6;
  };
  std::ifstream file(report);
  std::string text((std::istreambuf_iterator<char>(file)), {});
  return {
      {watch.spent().wall_s, seconds(used.ru_utime), seconds(used.ru_stime)}, memory.most(), std::move(text)};
}

/// A number of the program's own report.
double number_of(const std::string& report, const std::string& name) {
  const std::size_t at = report.find('"' + name + '"');
  return at == std::string::npos ? 0 : std::strtod(report.c_str() + report.find(':', at) + 1, nullptr);
}

}  // namespace

int run_scale(std::span<const std::string> arguments) {
  const Arguments given(arguments, kOptions);
  const std::filesystem::path folder = given.text("--folder", std::filesystem::temp_directory_path());
  const std::size_t side = given.number("--side", 20000);
  const std::string input = folder / ("fractal-" + std::to_string(side) + ".tif"),
                    tolerance = given.text("--tolerance", "10");
  if (!std::filesystem::exists(input))
    write_fractal(input, static_cast<std::int32_t>(side), given.number("--seed", 1));
  for (const auto& effort : given.list("--efforts", "fast")) {
    for (const auto& memory : given.list("--memories", "1024")) {
      for (const auto& suffix : given.list("--outputs", "ply")) {
        const std::string output = folder / ("fractal-" + std::to_string(side) + "-out." + suffix);
        const Run done = run({given.text("--program", "tinsmith"), "simplify", input, "--tolerance",
                              tolerance, "--effort", effort, "--memory", memory, "--threads",
                              given.text("--threads", "2"), "--output", output, "--json"},
                             folder / "fractal-report.json");
        JsonLine line("scale");
        line.add("side", static_cast<double>(side))
            .add("effort", effort)
            .add("tolerance", tolerance)
            .add("output", suffix);
        line.add("memory_mb", memory)
            .add("wall_s", done.spent.wall_s)
            .add("user_s", done.spent.user_s)
            .add("system_s", done.spent.system_s);
        line.add("peak_mb", static_cast<double>(done.memory.resident) / 1e6);
        line.add("anonymous_mb", static_cast<double>(done.memory.anonymous) / 1e6);
        line.add("of_files_mb", static_cast<double>(done.memory.of_files) / 1e6);
        line.add("vertices", number_of(done.report, "verticesAfter"))
            .add("max_error", number_of(done.report, "maxError"));
        line.add("output_mb", static_cast<double>(std::filesystem::file_size(output)) / 1e6).print();
      }
    }
  }
  return 0;
}

}  // namespace bench
