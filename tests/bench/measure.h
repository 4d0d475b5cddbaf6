// A stopwatch, peak memory and lines of JSON for the benchmarks.
#pragma once

#include <sys/types.h>

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace bench {

struct Spent {
  double wall_s = 0, user_s = 0, system_s = 0;
  double cpu_s() const { return user_s + system_s; }
};

/// Wall time and the process's processor time since it was made.
class Stopwatch {
 public:
  Stopwatch();
  Spent spent() const;

 private:
  Spent start_;
};

/// The most resident memory above what was resident when this was made; `idle` bytes of that, which wait to be used again,
/// count as not resident. Linux only; 0 elsewhere.
class PeakMemory {
 public:
  explicit PeakMemory(std::size_t idle = 0);
  std::size_t bytes() const;

 private:
  std::size_t before_;
};

/// Starts the program words[0], found as a shell finds it, whose output goes to the file `output`. Returns its
/// number, to be waited for; negative when there can be no process. It ends with 126 where `output` cannot be
/// written and with 127 where there is no such program.
pid_t start(const std::vector<std::string>& words, const std::string& output);

/// One JSON object on one line: JsonLine("build").add("points", 5).print().
class JsonLine {
 public:
  explicit JsonLine(std::string_view command);
  JsonLine& add(std::string_view name, double value);
  JsonLine& add(std::string_view name, std::string_view value);
  JsonLine& add(const Spent& spent, std::size_t operations);
  void print() const;

 private:
  std::string text_;
};

}  // namespace bench
