// Which pixels a DEM export has, and how each gets its elevation.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "proto/bbox.h"
#include "server/api/positions.h"
#include "server/gdal/geotiff.h"
#include "tin/query/elevation.h"
#include "tin/query/raster.h"
#include "tin/terrain/terrain.h"

namespace server::api {

struct ExportRequest {
  std::string crs;  // of the file; empty: the TIN's own
  std::optional<proto::Bbox> box;
  std::optional<double> cell_size;
  tin::query::Voids voids = tin::query::Voids::kKeep;
  tin::query::RasterLayer layer = tin::query::RasterLayer::kElevation;
  tin::query::Interpolation interpolation = tin::query::Interpolation::kLinear;  // of elevations
  tin::query::Sun sun;                                                            // of a hillshade
  std::int64_t max_pixels = 0;
};

/// A raster of elevations, or of another layer of the surface, over a terrain. Where nothing else is asked for it is the source's own grid, whose
/// pixel centres are lattice points, so that an untouched TIN gives its source back bit for bit. Borrows the
/// terrain. One thread.
class ExportGrid {
 public:
  /// Errors: kInvalidValue (an empty TIN or box, bad cell size), kTooLarge, as Positions::between().
  static tin::base::Result<ExportGrid> plan(const tin::terrain::Terrain& terrain,
                                            const ExportRequest& request);

  const gdal::RasterSpec& spec() const { return spec_; }
  /// Values at a row's pixel centres, spec().nodata where there are none. Rows in ascending order are quick: where they run
  /// along the lattice they are scan-converted; in another CRS and by natural neighbours each pixel is looked up.
  void sample_row(std::int64_t row, std::span<double> values);

 private:
  ExportGrid(const tin::terrain::Terrain& terrain, const ExportRequest& request, std::unique_ptr<tin::frame::Ground> ground)
      : terrain_(&terrain),
        request_(request),
        ground_(std::move(ground)),
        query_(terrain, request.voids, request.interpolation),
        gradient_(terrain, request.voids, *ground_),
        shade_(request.sun) {}
  void take_source_window(const tin::terrain::SourceGrid& grid, std::int64_t column, std::int64_t row,
                          std::int64_t width, std::int64_t height);
  tin::base::Result<void> take_source_grid(const tin::terrain::SourceGrid& grid,
                                           const ExportRequest& request);
  tin::base::Result<void> lay_new_grid(const ExportRequest& request, const std::string& crs);
  void choose_values();
  void choose_elevation_values();
  void scan();
  std::optional<double> value_at(tin::exact::Point p);

  const tin::terrain::Terrain* terrain_;
  ExportRequest request_;
  std::unique_ptr<tin::frame::Ground> ground_;
  tin::query::ElevationQuery query_;
  tin::query::GradientQuery gradient_;
  tin::query::Shade shade_;
  std::unique_ptr<tin::query::Rasteriser> raster_;  // where rows and columns run along the lattice
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
