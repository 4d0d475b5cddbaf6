// tinsmith-bench simplify: vertices, time, memory and the truth about the error, for ours and for peers.
#include "tin/simplify/simplify.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <limits>
#include <stdexcept>

#include "tests/bench/arguments.h"
#include "tests/bench/commands.h"
#include "tests/bench/dem.h"
#include "tests/bench/measure.h"
#include "tests/bench/simplify_plot.h"
#include "tests/bench/tin_judge.h"
#include "tin/delaunay/triangulation.h"

namespace bench {

using tin::simplify::Effort;
using tin::simplify::Options;

namespace {

constexpr std::string_view kOptions[] = {"--dem",        "--tolerances",     "--efforts",   "--threads",
                                         "--enlarge",    "--budget-percent", "--peers",     "--dump",
                                         "--svg",        "--error-map",      "--map-side",  "--seed",
                                         "--elevations", "--against",        "--keep-flat", "--pixels"};

Effort effort_of(const std::string& name) {
  if (name == "fast") return Effort::kFast;
  if (name == "balanced") return Effort::kBalanced;
  if (name == "thorough") return Effort::kThorough;
  if (name == "best") return Effort::kBest;
  throw std::runtime_error("unknown effort " + name);
}

/// The canonical TIN of the vertices chosen.
PixelTin triangulated(const Dem& dem, const std::vector<tin::terrain::Placement>& vertices) {
  std::vector<tin::exact::Point> points;
  for (const auto& vertex : vertices) points.push_back(vertex.at);
  tin::delaunay::Triangulation triangulation;
  std::vector<tin::mesh::VertexSlot> slots;
  triangulation.insert_many(points, slots);
  const auto& mesh = triangulation.mesh();
  PixelTin out;
  out.vertices.resize(mesh.vertex_slots());
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    const auto at = vertices[i].at;
    out.vertices[slots[i].value()] = {static_cast<double>(at.x - dem.grid->x0) / dem.grid->dx,
                                      static_cast<double>(at.y - dem.grid->y0) / dem.grid->dy, vertices[i].z};
  }
  for (std::uint32_t i = 0; i < mesh.triangle_slots(); ++i) {
    const tin::mesh::TriangleSlot t(i);
    if (!mesh.is_alive(t) || mesh.is_infinite(t)) continue;
    const auto& v = mesh.triangle(t).vertices;
    out.triangles.push_back({v[0].value(), v[1].value(), v[2].value()});
  }
  return out;
}

/// A picture of errors: white is none, dark grey the tolerance, black above it. Of several samples in a pixel
/// the worst counts.
struct ErrorMap {
  std::string file;   // empty: none
  std::int32_t side;  // pixels at most

  void write(const Dem& dem, const std::vector<float>& errors, double tolerance) const {
    const std::int32_t block = (std::max(dem.width(), dem.height()) + side - 1) / side;
    const std::int32_t width = (dem.width() + block - 1) / block, height = (dem.height() + block - 1) / block;
    std::vector<std::uint8_t> grey(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), 255);
    for (std::size_t i = 0; i < errors.size(); ++i) {
      if (std::isnan(errors[i])) continue;
      const auto cells = static_cast<std::size_t>(dem.width()), side_of = static_cast<std::size_t>(block);
      std::uint8_t& pixel = grey[i / cells / side_of * static_cast<std::size_t>(width) + i % cells / side_of];
      const double part = errors[i] / tolerance;
      pixel = std::min(pixel, part > 1 + 1e-6 ? std::uint8_t{0}
                                              : static_cast<std::uint8_t>(255 - 195 * std::min(part, 1.0)));
    }
    write_png(file, width, height, grey);
  }
};

void print(JsonLine line, const Dem& dem, const PixelTin& tin, std::size_t vertices, double tolerance,
           const ErrorMap& map) {
  const Judgement judgement = judge(dem, tin, tolerance);
  line.add("vertices", static_cast<double>(vertices));
  line.add("true_max_error", judgement.max_error).add("true_rmse", judgement.rmse);
  line.add("over", static_cast<double>(judgement.over))
      .add("uncovered", static_cast<double>(judgement.uncovered));
  line.add("not_delaunay", static_cast<double>(judgement.not_delaunay));
  line.add("open_edges", static_cast<double>(judgement.open_edges));
  line.print();
  if (!map.file.empty())
    map.write(dem, judgement.errors, std::max(tolerance, 1e-9));
}

/// One run of ours; returns the number of vertices.
std::size_t run_ours(const Dem& dem, const Options& options, const std::string& effort, const ErrorMap& map) {
  const auto samples = dem.samples();
  const PeakMemory memory;
  const Stopwatch watch;
  const auto chosen = tin::simplify::simplify_samples(samples, options, nullptr);
  const Spent spent = watch.spent();
  if (!chosen) throw std::runtime_error(chosen.error().message);
  const double asked = options.tolerance.value_or(std::numeric_limits<double>::max());
  JsonLine line("simplify");
  line.add("who", "tinsmith").add("dem", dem.name).add("effort", effort).add("threads", options.threads);
  line.add("elevations", options.elevations == tin::simplify::Elevations::kFit ? "fit" : "source");
  line.add("against", options.against == tin::simplify::Against::kSurface ? "surface" : "samples");
  if (options.keep_flat > 0)
    line.add("keep_flat", static_cast<double>(options.keep_flat))
        .add("level", static_cast<double>(chosen->report.level));
  if (options.tolerance) line.add("tolerance", *options.tolerance);
  if (options.max_vertices) line.add("max_vertices", static_cast<double>(*options.max_vertices));
  line.add("wall_s", spent.wall_s)
      .add("cpu_s", spent.cpu_s())
      .add("peak_mb", static_cast<double>(memory.bytes()) / 1e6);
  line.add("max_error", chosen->report.max_error).add("rmse", chosen->report.rmse);
  print(line, dem, triangulated(dem, chosen->vertices), chosen->vertices.size(), asked, map);
  return chosen->vertices.size();
}

/// What peers.mjs left: PREFIX.json with a line per run, and the TIN of each.
void judge_peers(const Dem& dem, const std::string& prefix, const ErrorMap& map, std::vector<Curve>& curves) {
  std::ifstream list(prefix + ".list");
  if (!list) throw std::runtime_error("can't read " + prefix + ".list");
  std::string who, tolerance, file;
  double cpu = 0, wall = 0;
  while (list >> who >> tolerance >> cpu >> wall >> file) {
    const PixelTin tin = read_tin(file);
    JsonLine line("simplify");
    line.add("who", who)
        .add("dem", dem.name)
        .add("tolerance", std::stod(tolerance))
        .add("wall_s", wall)
        .add("cpu_s", cpu);
    ErrorMap of_peer = map;
    if (!map.file.empty())
      of_peer.file.insert(map.file.rfind('.') == std::string::npos ? map.file.size() : map.file.rfind('.'),
                          "-" + who);
    print(line, dem, tin, tin.vertices.size(), std::stod(tolerance), of_peer);
    add_point(curves, who, std::stod(tolerance), tin.vertices.size());
  }
}

/// For peers.mjs: single precision, voids as 0.
void dump(const Dem& dem, const std::string& path) {
  std::ofstream file(path, std::ios::binary);
  for (const double z : dem.z) {
    const auto single = static_cast<float>(std::isnan(z) ? 0 : z);
    file.write(reinterpret_cast<const char*>(&single), sizeof single);
  }
  if (!file) throw std::runtime_error("can't write " + path);
  std::printf("{\"dumped\": \"%s\", \"width\": %d, \"height\": %d}\n", path.c_str(), dem.width(),
              dem.height());
}

}  // namespace

int run_simplify(std::span<const std::string> arguments) {
  const Arguments given(arguments, kOptions);
  Dem dem = read_dem(given.text("--dem", ""));
  if (const std::size_t side = given.number("--enlarge", 0); side > 0)
    dem = enlarged(dem, static_cast<std::int32_t>(side));
  if (given.text("--pixels", "own") == "square") dem = squared(dem);
  if (const auto path = given.text("--dump", ""); !path.empty()) {
    dump(dem, path);
    return 0;
  }
  Options options;
  options.threads = static_cast<unsigned>(given.number("--threads", 1));
  options.seed = given.number("--seed", 1);
  if (given.text("--elevations", "source") == "fit") options.elevations = tin::simplify::Elevations::kFit;
  if (given.text("--against", "samples") == "surface") options.against = tin::simplify::Against::kSurface;
  options.keep_flat = given.number("--keep-flat", 0);
  const ErrorMap map{given.text("--error-map", ""),
                     static_cast<std::int32_t>(given.number("--map-side", 1U << 20))};
  if (map.side < 1) throw std::runtime_error("--map-side must be positive");
  std::vector<Curve> curves;
  for (const auto& effort : given.list("--efforts", "fast")) {
    options.effort = effort_of(effort);
    for (const auto& tolerance : given.list("--tolerances", "2,5,10,20")) {
      options.tolerance = std::stod(tolerance);
      options.max_vertices.reset();
      add_point(curves, effort, *options.tolerance, run_ours(dem, options, effort, map));
    }
    const double percent = std::stod(given.text("--budget-percent", "0"));
    if (percent == 0) continue;
    options.tolerance.reset();
    options.max_vertices = static_cast<std::size_t>(static_cast<double>(dem.z.size()) * percent / 100);
    run_ours(dem, options, effort, {});
  }
  if (const auto peers = given.text("--peers", ""); !peers.empty()) judge_peers(dem, peers, map, curves);
  if (const auto svg = given.text("--svg", ""); !svg.empty())
    write_curves(svg, dem.name + ": vertices against tolerance", curves);
  return 0;
}

}  // namespace bench
