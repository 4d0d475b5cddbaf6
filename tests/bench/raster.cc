// tinsmith-bench raster: pixels per second, beside gdal_grid -a linear on the same points.
#include "tin/query/raster.h"

#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <stdexcept>

#include "tests/bench/arguments.h"
#include "tests/bench/commands.h"
#include "tests/bench/measure.h"
#include "tests/bench/surface.h"

namespace bench {

using tin::query::PixelCentres;
using tin::query::Rasteriser;
using tin::terrain::Terrain;

namespace {

/// A square raster over the terrain's bounds, its upper left pixel centre first; whole steps a pixel.
struct Grid {
  Grid(const Terrain& terrain, std::size_t size) {
    const auto box = *terrain.bounds();
    const double longer = std::max(double(box.max.x) - box.min.x, double(box.max.y) - box.min.y);
    step = static_cast<std::int32_t>(longer / static_cast<double>(size)) / 2 * 2;  // its half is whole
    for (std::size_t i = 0; i < size; ++i) {
      const auto along = static_cast<std::int32_t>(i) * step + step / 2;
      centres.x.push_back(box.min.x + along);
      centres.y.push_back(box.max.y - along);
    }
  }
  std::int32_t step = 1;
  PixelCentres centres;
};

/// Rows of doubles, or nothing but their sum.
double rasterise(const Terrain& terrain, const Grid& grid, std::vector<double>* out) {
  Rasteriser raster(terrain, grid.centres, {}, -9999);
  std::vector<double> row(grid.centres.x.size());
  double sum = 0;
  for (std::size_t r = 0; r < grid.centres.y.size(); ++r) {
    raster.row(r, row);
    sum += row[row.size() / 2];
    if (out != nullptr) out->insert(out->end(), row.begin(), row.end());
  }
  return sum;
}

/// Runs a program to its end without its output. Throws std::runtime_error when it fails.
Spent run(const std::vector<std::string>& words) {
  const Stopwatch watch;
  setenv("GDAL_NUM_THREADS", "1", 1);
  const pid_t child = start(words, "/dev/null");
  int status = 0;
  struct rusage used {};
  if (child < 0 || wait4(child, &status, 0, &used) != child || status != 0) {
    throw std::runtime_error(words[0] + " failed or is not installed");
  }
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + static_cast<double>(t.tv_usec) * 1e-6;
  };
  return {watch.spent().wall_s, seconds(used.ru_utime), seconds(used.ru_stime)};
}

/// gdal_grid and its files, in a folder of their own.
class GdalGrid {
 public:
  explicit GdalGrid(const Terrain& terrain) {
    std::string pattern = (std::filesystem::temp_directory_path() / "tinsmith-bench-XXXXXX").string();
    if (mkdtemp(pattern.data()) == nullptr) throw std::runtime_error("no temporary folder");
    folder_ = pattern;
    std::ofstream csv(folder_ / "points.csv");
    csv << "x,y,z\n";
    csv.precision(17);
    for (const auto& v : terrain.vertices_by_id()) csv << v.at.x << ',' << v.at.y << ',' << v.z << '\n';
    std::ofstream(folder_ / "points.vrt")
        << "<OGRVRTDataSource><OGRVRTLayer name=\"points\"><SrcDataSource>"
        << (folder_ / "points.csv").string()
        << "</SrcDataSource><GeometryType>wkbPoint</GeometryType><GeometryField "
           "encoding=\"PointFromColumns\" x=\"x\" y=\"y\" z=\"z\"/></OGRVRTLayer></OGRVRTDataSource>";
  }
  ~GdalGrid() { std::filesystem::remove_all(folder_); }
  GdalGrid(const GdalGrid&) = delete;
  GdalGrid& operator=(const GdalGrid&) = delete;

  Spent grid(const Grid& grid, std::size_t size) const {
    const auto number = [](double v) { return std::to_string(v); };
    const double half = grid.step / 2;
    const auto& [x, y] = grid.centres;
    const std::string pixels = std::to_string(size);
    return run({"gdal_grid",
                "-q",
                "-a",
                "linear:radius=0:nodata=-9999",
                "-of",
                "ENVI",
                "-ot",
                "Float64",
                "-txe",
                number(x.front() - half),
                number(x.front() - half + double(grid.step) * double(grid.centres.x.size())),
                "-tye",
                number(y.front() + half),
                number(y.front() + half - double(grid.step) * double(grid.centres.y.size())),
                "-outsize",
                pixels,
                pixels,
                "-l",
                "points",
                (folder_ / "points.vrt").string(),
                (folder_ / "out.bin").string()});
  }
  std::vector<double> pixels(std::size_t count) const {
    std::vector<double> values(count);
    std::ifstream file(folder_ / "out.bin", std::ios::binary);
    file.read(reinterpret_cast<char*>(values.data()), static_cast<std::streamsize>(count * sizeof(double)));
    if (!file) throw std::runtime_error("gdal_grid's raster is too short");
    return values;
  }

 private:
  std::filesystem::path folder_;
};

void compare(const Terrain& terrain, const Grid& grid, double raster_s, double build_s) {
  const GdalGrid peer(terrain);
  const std::size_t size = grid.centres.x.size(), pixels = size * size;
  constexpr std::size_t kFew = 16;
  const Spent setup = peer.grid(grid, kFew), whole = peer.grid(grid, size);
  std::vector<double> ours;
  rasterise(terrain, grid, &ours);
  const std::vector<double> theirs = peer.pixels(pixels);
  double largest = 0;
  std::size_t compared = 0;
  for (std::size_t i = 0; i < pixels; ++i) {
    if (ours[i] == -9999 || theirs[i] == -9999) continue;
    ++compared;
    largest = std::max(largest, std::abs(ours[i] - theirs[i]));
  }
  const double gridding = whole.cpu_s() - setup.cpu_s();
  JsonLine("raster")
      .add("who", "gdal_grid")
      .add(whole, pixels)
      .add("setup_cpu_s", setup.cpu_s())
      .add("pixels_per_s", static_cast<double>(pixels) / gridding)
      .add("compared", static_cast<double>(compared))
      .add("largest_difference", largest)
      .print();
  JsonLine("raster")
      .add("who", "ratio")
      .add("pixels", gridding / raster_s)
      .add("with_building", whole.cpu_s() / (raster_s + build_s))
      .print();
}

}  // namespace

int run_raster(std::span<const std::string> arguments) {
  static constexpr std::string_view kOptions[] = {"--input", "--points",  "--size",
                                                  "--seed",  "--repeats", "--peer"};
  const Arguments options(arguments, kOptions);
  const std::size_t size = options.number("--size", 4000), repeats = options.number("--repeats", 3);
  const Stopwatch building;
  const Terrain terrain = wavy_terrain(options.text("--input", "uniform"),
                                       options.number("--points", 1'000'000), options.number("--seed", 1));
  const double build_s = building.spent().cpu_s();
  const Grid grid(terrain, size);
  double best = 0;
  for (std::size_t i = 0; i < repeats; ++i) {
    const PeakMemory memory;
    const Stopwatch watch;
    const double sum = rasterise(terrain, grid, nullptr);
    const Spent spent = watch.spent();
    best = i == 0 ? spent.cpu_s() : std::min(best, spent.cpu_s());
    JsonLine("raster")
        .add("who", "tinsmith")
        .add("points", static_cast<double>(terrain.vertex_count()))
        .add("size", static_cast<double>(size))
        .add("result", sum)
        .add(spent, size * size)
        .add("build_cpu_s", build_s)
        .add("pixels_per_s", static_cast<double>(size * size) / spent.cpu_s())
        .add("peak_bytes", static_cast<double>(memory.bytes()))
        .print();
  }
  if (options.text("--peer", "") == "gdal") compare(terrain, grid, best, build_s);
  return 0;
}

}  // namespace bench
