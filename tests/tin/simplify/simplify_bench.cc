// tin_simplify_bench DIR [TOLERANCE...]: simplifies the SRTM tiles in DIR; one JSON line per file and
// tolerance.
#include <sys/resource.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <string>
#include <vector>

#include "tests/tin/simplify/terrains.h"
#include "tin/simplify/simplify.h"

namespace {

struct Tile {
  const char* name;
  double south;
};

void run(const char* name, const tin::terrain::Terrain& terrain, const tin::simplify::Options& options) {
  using Clock = std::chrono::steady_clock;
  const auto start = Clock::now();
  const std::clock_t cpu = std::clock();
  const auto outcome = tin::simplify::simplify(terrain, options, nullptr);
  const double seconds = std::chrono::duration<double>(Clock::now() - start).count();
  const double cpu_seconds = static_cast<double>(std::clock() - cpu) / CLOCKS_PER_SEC;
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  const auto& report = outcome->report;
  std::printf(
      "{\"file\": \"%s\", \"tolerance\": %g, \"max_vertices\": %zu, \"before\": %zu, \"after\": %zu, "
      "\"max_error\": %.17g, "
      "\"rmse\": %.6g, \"seconds\": %.3f, \"cpu\": %.3f, \"peak_mib\": %ld}\n",
      name, options.tolerance.value_or(-1), options.max_vertices.value_or(0), report.vertices_before,
      report.vertices_after, report.max_error, report.rmse, seconds, cpu_seconds, usage.ru_maxrss / 1024);
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) {
    std::fprintf(stderr, "usage: %s DIR [TOLERANCE...]\n", argv[0]);
    return 2;
  }
  std::vector<double> tolerances;
  for (int i = 2; i < argc; ++i) tolerances.push_back(std::atof(argv[i]));
  if (tolerances.empty()) tolerances = {20, 10, 5, 2, 1};
  for (const auto& [name, south] : {Tile{"N44W072", 44}, Tile{"N53E027", 53}, Tile{"N51E001", 51}}) {
    const auto terrain = support::hgt_terrain(std::string(argv[1]) + "/" + name + ".hgt", south);
    if (!terrain) continue;
    for (const double tolerance : tolerances)
      run(name, *terrain, {.tolerance = tolerance, .max_vertices = {}});
    run(name, *terrain, {.tolerance = {}, .max_vertices = terrain->vertex_count() / 100});
  }
}
