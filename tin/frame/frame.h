// The frame of a terrain: how its integer lattice lies in its CRS.
//
//   Frame f;                                  // 1 mm lattice around (0, 0), no CRS
//   f.x = {500000.0, 1.0, 1000};              // origin 500000, steps of 1/1000 unit
//   auto p = f.to_lattice(500001.2345, 12.0); // Result<Point>: snapped to the nearest lattice point
//   double x = f.x.world(p->x);               // 500001.235 (round half away): what clients see
#pragma once

#include <cstdint>
#include <string>

#include "tin/base/result.h"
#include "tin/exact/point.h"

namespace tin::frame {

/// One axis: world = origin + i * (unit / parts). A DEM's axis has the pixel size as its unit, so that pixel
/// centres are exact multiples of `parts`; a survey's has unit 1 and, say, 1000 parts.
struct Axis {
  double origin = 0;          // world coordinate of lattice 0
  double unit = 1;            // world units, > 0
  std::int64_t parts = 1000;  // lattice steps per unit, > 0

  double step() const { return unit / static_cast<double>(parts); }
  /// World coordinate of lattice coordinate `i`; rounded once each by product, quotient and sum.
  double world(double i) const { return origin + i * unit / static_cast<double>(parts); }
  /// Lattice coordinate of `w`, not rounded and not range-checked.
  double lattice(double w) const { return (w - origin) / unit * static_cast<double>(parts); }
  friend bool operator==(const Axis&, const Axis&) = default;
};

/// CRS, axes and vertical unit of a terrain. x is easting or longitude, y northing or latitude, always in
/// that order ("GIS order"), whatever the authority of the CRS says.
struct Frame {
  std::string crs;  // "EPSG:4326" where an authority code is known, else WKT2; empty: unknown (local)
  Axis x;
  Axis y;
  std::string vertical_unit;   // name as users know it: metre, foot, US survey foot; empty: unknown
  double vertical_unit_m = 1;  // its length in metres
  friend bool operator==(const Frame&, const Frame&) = default;

  /// Nearest lattice point. Errors: kNotFinite, kOutsideLattice.
  base::Result<exact::Point> to_lattice(double world_x, double world_y) const;
};

/// How lengths of the two axes compare on the ground; made by server/gdal from a CRS.
struct GroundScale {
  bool geographic = false;
  double unit_m = 1;  // projected: metres per CRS unit; geographic: unused
};

/// Metres on the ellipsoid (WGS84) of one degree of longitude and of latitude around `latitude_deg`, which is
/// taken as +-89 degrees nearer to the poles, where a degree of longitude would have no length.
struct DegreeLengths {
  double lon_m = 0;
  double lat_m = 0;
};
DegreeLengths degree_lengths(double latitude_deg);

/// Extent of data in world units.
struct Extent {
  double min_x = 0, min_y = 0, max_x = 0, max_y = 0;
};

/// Axes for scattered points. The step is the power of ten of the CRS unit nearest below 1 mm on the ground
/// (1e-8 degrees for geographic CRSs), or the given resolution in CRS units (0: choose); equal on the ground
/// in x and y where it is chosen. The lattice is centred on the extent (at a rounded position, so that
/// decimal coordinates stay decimal), and a chosen step is 2, 5, 10 ... times coarser where the extent would
/// not fit into half the lattice. Errors: kNotFinite; kInvalidValue when a given resolution is negative,
/// one-sided or cannot hold the extent, when latitudes leave -90..90, or when the coordinates are too large
/// for doubles to tell the steps apart.
base::Result<Frame> fit_points(const Extent& extent, const GroundScale& scale, double resolution_x,
                               double resolution_y);

/// Whether data of this extent can lie on a frame that came from outside: its axes are finite and positive, all of
/// the extent is on the lattice, and doubles can tell the steps apart. Errors: kNotFinite, kInvalidValue,
/// kOutsideLattice.
base::Result<void> check_frame(const Frame& frame, const Extent& extent);

/// A raster of `width` x `height` pixels of the given size in CRS units (> 0), north-up; the centre of pixel
/// (0, 0), the upper left one, is at (x0, y0).
struct RasterShape {
  double x0 = 0, y0 = 0;
  double pixel_x = 0, pixel_y = 0;
  std::int64_t width = 0, height = 0;
};

/// Axes for a raster: each pixel is divided into a whole number of parts, about 1 mm on the ground and equal
/// on the ground in x and y (or about the given resolution in CRS units), so that pixel centres are lattice
/// points exactly; whole factors coarser where the raster would not fit into half the lattice. Lattice 0 is
/// the centre of pixel (width / 2, height / 2). Errors: as fit_points(); kInvalidValue also for a raster that
/// no lattice can hold.
base::Result<Frame> fit_raster(const RasterShape& raster, const GroundScale& scale, double resolution_x = 0,
                               double resolution_y = 0);

}  // namespace tin::frame
