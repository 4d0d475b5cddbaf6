#include "tests/bench/measure.h"

#include <sys/resource.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <fstream>

namespace bench {
namespace {

double seconds(const timeval& time) { return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec); }

Spent now() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  const auto wall = std::chrono::steady_clock::now().time_since_epoch();
  return {std::chrono::duration<double>(wall).count(), seconds(usage.ru_utime), seconds(usage.ru_stime)};
}

/// A line of /proc/self/status, in bytes.
std::size_t status(const std::string& name) {
  std::ifstream file("/proc/self/status");
  for (std::string line; std::getline(file, line);) {
    if (line.rfind(name + ":", 0) == 0) return std::stoull(line.substr(name.size() + 1)) * 1024;
  }
  return 0;
}

}  // namespace

Stopwatch::Stopwatch() : start_(now()) {}

Spent Stopwatch::spent() const {
  const Spent end = now();
  return {end.wall_s - start_.wall_s, end.user_s - start_.user_s, end.system_s - start_.system_s};
}

PeakMemory::PeakMemory(std::size_t idle) : before_(status("VmRSS") - idle) { std::ofstream("/proc/self/clear_refs") << "5\n"; }

std::size_t PeakMemory::bytes() const {
  const std::size_t peak = status("VmHWM");
  return peak > before_ ? peak - before_ : 0;
}

JsonLine::JsonLine(std::string_view command) : text_("{\"command\":\"" + std::string(command) + "\"") {}

JsonLine& JsonLine::add(std::string_view name, double value) {
  char number[32];
  std::snprintf(number, sizeof number, "%.10g", value);
  text_ += ",\"" + std::string(name) + "\":" + number;
  return *this;
}

JsonLine& JsonLine::add(std::string_view name, std::string_view value) {
  text_ += ",\"" + std::string(name) + "\":\"";
  for (const char c : value) {
    if (c == '"' || c == '\\') text_ += '\\';
    text_ += c;
  }
  text_ += '"';
  return *this;
}

JsonLine& JsonLine::add(const Spent& spent, std::size_t operations) {
  const double per_operation = 1e9 / static_cast<double>(operations);
  add("wall_s", spent.wall_s).add("user_s", spent.user_s).add("system_s", spent.system_s);
  return add("wall_ns_per_op", per_operation * spent.wall_s).add("cpu_ns_per_op", per_operation * spent.cpu_s());
}

pid_t start(const std::vector<std::string>& words, const std::string& output) {
  const pid_t child = fork();
  if (child == 0) {
    std::vector<char*> arguments;
    for (const std::string& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
    arguments.push_back(nullptr);
    if (std::freopen(output.c_str(), "w", stdout) == nullptr) _exit(126);
    execvp(arguments[0], arguments.data());
    _exit(127);
  }
  return child;
}

void JsonLine::print() const {
  std::printf("%s}\n", text_.c_str());
  std::fflush(stdout);
}

}  // namespace bench
