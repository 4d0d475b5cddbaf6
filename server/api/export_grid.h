// Which pixels a DEM export has, and how each gets its elevation.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "proto/bbox.h"
#include "server/api/positions.h"
#include "server/gdal/geotiff.h"
#include "tin/query/elevation.h"
#include "tin/terrain/terrain.h"

namespace server::api {

struct ExportRequest {
  std::string crs;  // of the file; empty: the TIN's own
  std::optional<proto::Bbox> box;
  std::optional<double> cell_size;
  tin::query::Voids voids = tin::query::Voids::kKeep;
  std::int64_t max_pixels = 0;
};

/// A raster of elevations over a terrain. Where nothing else is asked for it is the source's own grid, whose
/// pixel centres are lattice points, so that an untouched TIN gives its source back bit for bit. Borrows the
/// terrain. One thread.
class ExportGrid {
 public:
  /// Errors: kInvalidValue (an empty TIN or box, bad cell size), kTooLarge, as Positions::between().
  static tin::base::Result<ExportGrid> plan(const tin::terrain::Terrain& terrain,
                                            const ExportRequest& request);

  const gdal::RasterSpec& spec() const { return spec_; }
  /// Elevations of a row's pixel centres, linear on the surface; spec().nodata where there are none.
  void sample_row(std::int64_t row, std::span<double> values);

 private:
  ExportGrid(const tin::terrain::Terrain& terrain, tin::query::Voids voids)
      : terrain_(&terrain), query_(terrain, voids) {}
  void take_source_window(const tin::terrain::SourceGrid& grid, std::int64_t column, std::int64_t row,
                          std::int64_t width, std::int64_t height);
  tin::base::Result<void> take_source_grid(const tin::terrain::SourceGrid& grid,
                                           const ExportRequest& request);
  tin::base::Result<void> lay_new_grid(const ExportRequest& request, const std::string& crs);
  void choose_values();

  const tin::terrain::Terrain* terrain_;
  tin::query::ElevationQuery query_;
  gdal::RasterSpec spec_;
  const tin::terrain::SourceGrid* source_ = nullptr;  // set when pixels are the source's
  std::int64_t first_column_ = 0, first_row_ = 0;
  std::optional<Positions> to_own_;
  std::vector<double> x_, y_;
  std::vector<std::uint8_t> ok_;
};

/// The extent of the terrain in another CRS, from points along its sides. Errors: kInvalidValue when some
/// cannot be converted.
tin::base::Result<tin::frame::Extent> extent_in(const tin::terrain::Terrain& terrain, Positions& positions);

}  // namespace server::api
