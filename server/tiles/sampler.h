// Heights of a terrain on regular grids in another CRS.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "server/gdal/crs.h"
#include "tin/base/result.h"
#include "tin/query/elevation.h"
#include "tin/terrain/terrain.h"

namespace server::tiles {

/// Where the nodes of a grid are: x0 + i * dx, y0 + j * dy for i < columns, j < rows.
struct Grid {
  double x0 = 0, dx = 1;
  int columns = 0;
  double y0 = 0, dy = 1;
  int rows = 0;
};

/// Borrows the terrain. One thread.
class Sampler {
 public:
  /// Errors: kNotFound when the terrain has no CRS or none that can be reached from `crs`.
  static tin::base::Result<Sampler> create(const tin::terrain::Terrain& terrain, std::string_view crs);

  /// Heights in metres, row by row; NaN where there is no terrain. Voids are filled.
  std::vector<double> heights(const Grid& grid);
  /// At single places; each x, y is converted by itself.
  std::vector<double> heights(std::vector<double> x, std::vector<double> y);

 private:
  Sampler(const tin::terrain::Terrain& terrain, std::optional<gdal::CrsTransform> to_own)
      : terrain_(terrain), to_own_(std::move(to_own)), query_(terrain, tin::query::Voids::kFill) {}
  bool to_own(std::vector<double>& x, std::vector<double>& y, std::vector<std::uint8_t>& ok);
  bool convert_by_cells(const Grid& grid, std::vector<double>& x, std::vector<double>& y);
  double height(double x, double y);

  const tin::terrain::Terrain& terrain_;
  std::optional<gdal::CrsTransform> to_own_;  // nothing: the same CRS
  tin::query::ElevationQuery query_;
  std::optional<tin::terrain::Box> bounds_;
};

}  // namespace server::tiles
