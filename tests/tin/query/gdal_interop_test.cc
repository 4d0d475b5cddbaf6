// Contours and slopes against GDAL's own programs on the same raster.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "tests/support/process.h"
#include "tests/support/temp_dir.h"
#include "tests/tin/query/analytic.h"
#include "tin/query/contour.h"
#include "tin/query/gradient.h"

namespace {

using tests::support::run;
using tests::support::TempDir;
using tin::exact::Point;
using tin::frame::Place;
using tin::query::ContourLine;
using tin::query::ContourTracer;
using tin::terrain::Terrain;
using Json = nlohmann::json;

constexpr std::int32_t kSize = 60;

/// Hills without a height on a level, by column and row of pixel centres; row 0 in the north.
double hill(std::int32_t column, std::int32_t row) {
  return 100 + 37.1 * std::sin(column * 0.21) * std::cos(row * 0.17) +
         11.3 * std::cos(column * 0.05 + row * 0.31) + 0.0123;
}

/// One lattice step is a tenth of a pixel; the centre of column c, row r is at (10 c, -10 r).
Terrain hills() {
  return support::terrain_of(support::grid_points(kSize, kSize, 10, {0, -10 * (kSize - 1)}),
                             [](Point p) { return hill(p.x / 10, -p.y / 10); });
}

std::string write_raster(const TempDir& folder) {
  const std::string path = (folder.path() / "hills.asc").string();
  std::ofstream file(path);
  file.precision(17);
  file << "ncols " << kSize << "\nnrows " << kSize << "\nxllcorner -5\nyllcorner " << -10 * (kSize - 1) - 5
       << "\ncellsize 10\n";
  for (std::int32_t r = 0; r < kSize; ++r) {
    for (std::int32_t c = 0; c < kSize; ++c) file << hill(c, r) << (c + 1 < kSize ? ' ' : '\n');
  }
  return path;
}

double length(const std::vector<Place>& places) {
  double sum = 0;
  for (std::size_t i = 1; i < places.size(); ++i)
    sum += std::hypot(places[i].x - places[i - 1].x, places[i].y - places[i - 1].y);
  return sum;
}

double distance_to(const ContourLine& line, Place p) {
  double least = 1e300;
  for (std::size_t i = 1; i < line.places.size(); ++i) {
    const Place a = line.places[i - 1], b = line.places[i];
    const double dx = b.x - a.x, dy = b.y - a.y, whole = dx * dx + dy * dy;
    const double part = whole > 0 ? std::clamp(((p.x - a.x) * dx + (p.y - a.y) * dy) / whole, 0.0, 1.0) : 0;
    least = std::min(least, std::hypot(a.x + part * dx - p.x, a.y + part * dy - p.y));
  }
  return least;
}

TEST(GdalContourTest, CrossesTheRastersRowsAndColumnsWhereOursDo) {
  const TempDir folder;
  const std::string raster = write_raster(folder), out = (folder.path() / "contours.json").string();
  const auto done = run({"gdal_contour", "-q", "-a", "level", "-i", "10", "-f", "GeoJSON", "-lco",
                         "COORDINATE_PRECISION=9", raster, out});
  ASSERT_EQ(done.status, 0) << done.err;
  std::ifstream file(out);
  const Json theirs = Json::parse(file);

  const Terrain terrain = hills();
  ContourTracer tracer(terrain, *tin::query::contour_levels(terrain, 10, 0, 1000), {});
  std::map<double, std::vector<ContourLine>> ours;
  std::map<double, double> our_length, their_length;
  for (ContourLine line; tracer.next(line);) {
    our_length[line.level] += length(line.places);
    ours[line.level].push_back(line);
  }
  std::size_t places = 0;
  for (const Json& feature : theirs.at("features")) {
    const double level = feature.at("properties").at("level");
    std::vector<Place> at;
    for (const Json& p : feature.at("geometry").at("coordinates"))
      at.push_back({p[0].get<double>(), p[1].get<double>()});
    their_length[level] += length(at);
    for (const Place& p : at) {
      // GDAL extends the raster by half a pixel to its edges; ours ends at the outer centres.
      if (p.x < 0 || p.x > 10 * (kSize - 1) || p.y > 0 || p.y < -10 * (kSize - 1)) continue;
      double least = 1e300;
      for (const ContourLine& line : ours[level]) least = std::min(least, distance_to(line, p));
      EXPECT_LT(least, 1e-5) << level << " at " << p.x << ' ' << p.y;
      ++places;
    }
  }
  EXPECT_GT(places, 1000U);
  EXPECT_GE(ours.size(), 8U);
  for (const auto& [level, total] : our_length) {
    // Ours bends on the cells' diagonals too, theirs goes on to the raster's edges.
    EXPECT_NEAR(their_length[level] / total, 1, 0.12) << level;
  }
}

TEST(GdalSlopeTest, IsOursAtTheVerticesWithinTheErrorOfItsDifferences) {
  const TempDir folder;
  const std::string raster = write_raster(folder), out = (folder.path() / "slope.asc").string();
  const std::string tif = (folder.path() / "slope.tif").string();
  const auto made = run({"gdaldem", "slope", "-q", "-alg", "ZevenbergenThorne", raster, tif});
  ASSERT_EQ(made.status, 0) << made.err;
  ASSERT_EQ(run({"gdal_translate", "-q", "-of", "AAIGrid", "-co", "DECIMAL_PRECISION=9", tif, out}).status,
            0);
  std::ifstream file(out);
  std::string word;
  for (int i = 0; i < 12; ++i) file >> word;
  const Terrain terrain = hills();
  const auto ground = support::metre_ground();
  tin::query::GradientQuery query(terrain, tin::query::Voids::kKeep, ground);
  double sum = 0;
  std::size_t count = 0;
  for (std::int32_t r = 0; r < kSize; ++r) {
    for (std::int32_t c = 0; c < kSize; ++c) {
      double theirs = -9999;
      file >> theirs;
      if (theirs < 0 || r == 0 || c == 0 || r == kSize - 1 || c == kSize - 1) continue;
      // The mean of six triangles against differences over two pixels: equal to the second order.
      const double own = tin::query::slope_degrees(*query.at({10 * c, -10 * r}));
      EXPECT_NEAR(own, theirs, 2.0) << c << ' ' << r;
      sum += std::abs(own - theirs);
      ++count;
    }
  }
  ASSERT_GT(count, 3000U);
  EXPECT_LT(sum / static_cast<double>(count), 0.3);
}

}  // namespace
