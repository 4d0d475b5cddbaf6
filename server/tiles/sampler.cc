#include "server/tiles/sampler.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace server::tiles {

using tin::base::Code;
using tin::base::error;
using tin::base::Result;

namespace {

constexpr double kNowhere = std::numeric_limits<double>::quiet_NaN();
/// Nodes between two that are converted exactly, where the grid is fine enough for straight lines between them.
constexpr int kCell = 16;
/// How far, in nodes, a position between may lie from where it belongs.
constexpr double kStray = 0.02;

}  // namespace

Result<Sampler> Sampler::create(const tin::terrain::Terrain& terrain, std::string_view crs) {
  const std::string& own = terrain.frame().crs;
  if (own.empty()) return error(Code::kNotFound, "The TIN has no CRS, so it has no place on the globe.");
  std::optional<gdal::CrsTransform> to_own;
  if (own != crs) {
    auto way = gdal::CrsTransform::create(crs, own);
    if (!way) return error(Code::kNotFound, "The TIN's CRS cannot be put on the globe: " + way.error().message);
    to_own = std::move(*way);
  }
  Sampler sampler(terrain, std::move(to_own));
  sampler.bounds_ = terrain.bounds();
  return sampler;
}

bool Sampler::to_own(std::vector<double>& x, std::vector<double>& y, std::vector<std::uint8_t>& ok) {
  ok.assign(x.size(), 1);
  return !to_own_ || to_own_->transform(x, y, ok);
}

double Sampler::height(double x, double y) {
  const auto at = terrain_.frame().to_lattice(x, y);
  if (!at || !bounds_) return kNowhere;
  if (at->x < bounds_->min.x || at->x > bounds_->max.x || at->y < bounds_->min.y || at->y > bounds_->max.y) return kNowhere;
  const auto found = query_.at(*at);
  return found ? found->z * terrain_.frame().vertical_unit_m : kNowhere;
}

std::vector<double> Sampler::heights(std::vector<double> x, std::vector<double> y) {
  std::vector<std::uint8_t> ok;
  to_own(x, y, ok);
  std::vector<double> z(x.size(), kNowhere);
  for (std::size_t i = 0; i < z.size(); ++i) {
    if (ok[i] != 0) z[i] = height(x[i], y[i]);
  }
  return z;
}

/// Converts the corners of cells and puts the nodes between them on straight lines; says no where that would stray.
bool Sampler::convert_by_cells(const Grid& grid, std::vector<double>& x, std::vector<double>& y) {
  const int columns = (grid.columns + kCell - 2) / kCell + 1, rows = (grid.rows + kCell - 2) / kCell + 1;
  std::vector<double> cx, cy, mx, my;  // corners, and the middles of cells
  for (int j = 0; j < rows; ++j) {
    for (int i = 0; i < columns; ++i) {
      cx.push_back(grid.x0 + grid.dx * kCell * i);
      cy.push_back(grid.y0 + grid.dy * kCell * j);
      mx.push_back(grid.x0 + grid.dx * kCell * (i + 0.5));
      my.push_back(grid.y0 + grid.dy * kCell * (j + 0.5));
    }
  }
  std::vector<std::uint8_t> ok;
  if (!to_own(cx, cy, ok) || !to_own(mx, my, ok)) return false;
  const auto corner = [&](int i, int j) { return static_cast<std::size_t>(j * columns + i); };
  const auto between = [&](const std::vector<double>& c, int i, int j, double u, double v) {
    return (c[corner(i, j)] * (1 - u) + c[corner(i + 1, j)] * u) * (1 - v) +
           (c[corner(i, j + 1)] * (1 - u) + c[corner(i + 1, j + 1)] * u) * v;
  };
  if (columns < 2 || rows < 2) return false;
  for (int j = 0; j + 1 < rows; ++j) {
    for (int i = 0; i + 1 < columns; ++i) {
      const double stray = std::hypot(between(cx, i, j, 0.5, 0.5) - mx[corner(i, j)], between(cy, i, j, 0.5, 0.5) - my[corner(i, j)]);
      const double node = std::hypot(cx[corner(i + 1, j + 1)] - cx[corner(i, j)], cy[corner(i + 1, j + 1)] - cy[corner(i, j)]) /
                          (kCell * std::sqrt(2.0));
      if (!(stray <= kStray * node)) return false;
    }
  }
  for (int row = 0; row < grid.rows; ++row) {
    const int j = std::min(row / kCell, rows - 2);
    for (int column = 0; column < grid.columns; ++column) {
      const int i = std::min(column / kCell, columns - 2);
      const double u = static_cast<double>(column - i * kCell) / kCell, v = static_cast<double>(row - j * kCell) / kCell;
      x.push_back(between(cx, i, j, u, v));
      y.push_back(between(cy, i, j, u, v));
    }
  }
  return true;
}

std::vector<double> Sampler::heights(const Grid& grid) {
  std::vector<double> x, y;
  x.reserve(static_cast<std::size_t>(grid.columns) * static_cast<std::size_t>(grid.rows));
  y.reserve(x.capacity());
  std::vector<std::uint8_t> ok;
  if (!convert_by_cells(grid, x, y)) {
    x.clear();
    y.clear();
    for (int j = 0; j < grid.rows; ++j) {
      for (int i = 0; i < grid.columns; ++i) {
        x.push_back(grid.x0 + grid.dx * i);
        y.push_back(grid.y0 + grid.dy * j);
      }
    }
    to_own(x, y, ok);
  } else {
    ok.assign(x.size(), 1);
  }
  std::vector<double> z(x.size(), kNowhere);
  for (std::size_t i = 0; i < z.size(); ++i) {
    if (ok[i] != 0) z[i] = height(x[i], y[i]);
  }
  return z;
}

}  // namespace server::tiles
