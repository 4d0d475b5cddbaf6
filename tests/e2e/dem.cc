#include "tests/e2e/dem.h"

#include <gdal.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <map>
#include <stdexcept>

namespace tests::e2e {
namespace {

namespace fs = std::filesystem;

fs::path folder(const char* variable, const char* otherwise) {
  const char* named = std::getenv(variable);
  return named != nullptr ? fs::path(named) : fs::path(TINSMITH_SOURCE_DIR) / otherwise;
}

/// A vertex as a pixel.
struct Node {
  std::int64_t column = 0, row = 0;
  double z = 0;
};

std::int64_t turn(const Node& a, const Node& b, std::int64_t column, std::int64_t row) {
  return (b.column - a.column) * (row - a.row) - (b.row - a.row) * (column - a.column);
}

class Comparison {
 public:
  explicit Comparison(const Dem& dem)
      : dem_(dem), error_(dem.values.size(), std::numeric_limits<double>::infinity()) {}

  /// The pixel nearest to a position.
  Node place(const nlohmann::json& position) const {
    return {std::llround(column_of(position)), std::llround(row_of(position)), position.at(2)};
  }

  Node node(const nlohmann::json& position) {
    const double column = column_of(position), row = row_of(position);
    const Node node = place(position);
    const bool inside =
        node.column >= 0 && node.row >= 0 && node.column < dem_.width && node.row < dem_.height;
    const int c = static_cast<int>(node.column), r = static_cast<int>(node.row);
    if (!inside || std::abs(column - static_cast<double>(c)) > 1e-3 ||
        std::abs(row - static_cast<double>(r)) > 1e-3 || !dem_.valid(c, r)) {
      ++misses_.strangers;
      return {};
    }
    if (dem_.value(c, r) != node.z) ++misses_.strangers;
    return node;
  }

  void take(Node a, Node b, Node c) {
    if (turn(a, b, c.column, c.row) < 0) std::swap(b, c);  // rows run downwards
    const auto area = static_cast<double>(turn(a, b, c.column, c.row));
    const auto [left, right] = std::minmax({a.column, b.column, c.column});
    const auto [top, bottom] = std::minmax({a.row, b.row, c.row});
    for (std::int64_t row = top; row <= bottom; ++row) {
      for (std::int64_t column = left; column <= right; ++column) {
        const std::int64_t of_a = turn(b, c, column, row), of_b = turn(c, a, column, row),
                           of_c = turn(a, b, column, row);
        if (of_a < 0 || of_b < 0 || of_c < 0) continue;
        const double z = (static_cast<double>(of_a) * a.z + static_cast<double>(of_b) * b.z +
                          static_cast<double>(of_c) * c.z) /
                         area;
        double& error = error_[static_cast<std::size_t>(row * dem_.width + column)];
        const double here = std::abs(z - dem_.value(static_cast<int>(column), static_cast<int>(row)));
        // On an edge the triangles on both sides agree, but for rounding.
        error = std::isinf(error) ? here : std::max(error, here);
      }
    }
  }

  Misses result(double tolerance) {
    for (int row = 0; row < dem_.height; ++row) {
      for (int column = 0; column < dem_.width; ++column) {
        if (!dem_.valid(column, row)) continue;
        const double error = error_[static_cast<std::size_t>(row) * dem_.width + column];
        if (std::isinf(error)) {
          ++misses_.uncovered;
          continue;
        }
        misses_.largest = std::max(misses_.largest, error);
        if (error > tolerance + 1e-9) ++misses_.beyond;
      }
    }
    return misses_;
  }

 private:
  double column_of(const nlohmann::json& position) const {
    return (position.at(0).get<double>() - dem_.geotransform[0]) / dem_.geotransform[1] - 0.5;
  }
  double row_of(const nlohmann::json& position) const {
    return (position.at(1).get<double>() - dem_.geotransform[3]) / dem_.geotransform[5] - 0.5;
  }

  const Dem& dem_;
  std::vector<double> error_;
  Misses misses_;
};

}  // namespace

Dem::Dem(const fs::path& path) : file(path) {
  GDALAllRegister();
  const GDALDatasetH dataset = GDALOpen(path.c_str(), GA_ReadOnly);
  if (dataset == nullptr) throw std::runtime_error(path.string() + " cannot be read");
  width = GDALGetRasterXSize(dataset);
  height = GDALGetRasterYSize(dataset);
  GDALGetGeoTransform(dataset, geotransform.data());
  const GDALRasterBandH band = GDALGetRasterBand(dataset, 1);
  int has_nodata = 0;
  const double value = GDALGetRasterNoDataValue(band, &has_nodata);
  if (has_nodata != 0) nodata = value;
  values.resize(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  const CPLErr read =
      GDALRasterIO(band, GF_Read, 0, 0, width, height, values.data(), width, height, GDT_Float64, 0, 0);
  GDALClose(dataset);
  if (read != CE_None) throw std::runtime_error(path.string() + " is damaged");
}

std::size_t Dem::valid_count() const {
  if (!nodata) return values.size();
  return values.size() - static_cast<std::size_t>(std::count(values.begin(), values.end(), *nodata));
}

std::optional<fs::path> terrain_file(const std::string& name) {
  for (const fs::path& file : {folder("TINSMITH_SAMPLES", "build/sample") / name,
                               folder("TINSMITH_TERRAIN", "../shared/terrain") / name}) {
    if (fs::exists(file)) return file;
  }
  return std::nullopt;
}

fs::path sample_file(const std::string& name) {
  if (const auto file = terrain_file(name + ".tif")) return *file;
  throw std::runtime_error("the sample terrain " + name + " is not there: run deploy/sample.sh " + name +
                           ", or let TINSMITH_SAMPLES name the folder with it");
}

Misses compare(const Dem& dem, const nlohmann::json& triangles, double tolerance) {
  Comparison comparison(dem);
  for (const auto& feature : triangles.at("features")) {
    const auto& ring = feature.at("geometry").at("coordinates").at(0);
    comparison.take(comparison.node(ring.at(0)), comparison.node(ring.at(1)), comparison.node(ring.at(2)));
  }
  return comparison.result(tolerance);
}

std::vector<std::pair<int, int>> strictly_inside(const Dem& dem, const nlohmann::json& star) {
  Comparison pixels(dem);
  std::vector<std::array<Node, 3>> triangles;
  std::map<std::array<std::int64_t, 4>, int> sides;
  for (const auto& feature : star.at("features")) {
    const auto& ring = feature.at("geometry").at("coordinates").at(0);
    std::array<Node, 3> t{pixels.place(ring.at(0)), pixels.place(ring.at(1)), pixels.place(ring.at(2))};
    if (turn(t[0], t[1], t[2].column, t[2].row) < 0) std::swap(t[1], t[2]);
    for (std::size_t i = 0; i < 3; ++i) {
      std::pair a(t[i].column, t[i].row), b(t[(i + 1) % 3].column, t[(i + 1) % 3].row);
      if (b < a) std::swap(a, b);
      ++sides[{a.first, a.second, b.first, b.second}];
    }
    triangles.push_back(t);
  }
  const auto on_rim = [&](std::int64_t column, std::int64_t row) {
    return std::any_of(sides.begin(), sides.end(), [&](const auto& side) {
      const auto& [at, count] = side;
      const Node a{at[0], at[1], 0}, b{at[2], at[3], 0};
      return count == 1 && turn(a, b, column, row) == 0 && std::min(at[0], at[2]) <= column &&
             column <= std::max(at[0], at[2]) && std::min(at[1], at[3]) <= row &&
             row <= std::max(at[1], at[3]);
    });
  };
  std::vector<std::pair<int, int>> inside;
  for (int row = 0; row < dem.height; ++row) {
    for (int column = 0; column < dem.width; ++column) {
      const bool covered = std::any_of(triangles.begin(), triangles.end(), [&](const auto& t) {
        return turn(t[0], t[1], column, row) >= 0 && turn(t[1], t[2], column, row) >= 0 &&
               turn(t[2], t[0], column, row) >= 0;
      });
      if (covered && !on_rim(column, row)) inside.emplace_back(column, row);
    }
  }
  return inside;
}

}  // namespace tests::e2e
