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
  double origin = 0;        // world coordinate of lattice 0
  double unit = 1;          // world units, > 0
  std::int64_t parts = 1000;  // lattice steps per unit, > 0

  double step() const { return unit / static_cast<double>(parts); }
  /// World coordinate of lattice coordinate `i`; rounded once each by product, quotient and sum.
  double world(double i) const { return origin + i * unit / static_cast<double>(parts); }
  /// Lattice coordinate of `w`, not rounded and not range-checked.
  double lattice(double w) const { return (w - origin) / unit * static_cast<double>(parts); }
  friend bool operator==(const Axis&, const Axis&) = default;
};

/// CRS, axes and vertical unit of a terrain. x is easting or longitude, y northing or latitude, always in that
/// order ("GIS order"), whatever the authority of the CRS says.
struct Frame {
  std::string crs;            // "EPSG:4326" where an authority code is known, else WKT2; empty: unknown (local)
  Axis x;
  Axis y;
  std::string vertical_unit = "metre";  // name as users know it: metre, foot, US survey foot
  double vertical_unit_m = 1;           // its length in metres
  friend bool operator==(const Frame&, const Frame&) = default;

  /// Nearest lattice point. Errors: kNotFinite, kOutsideLattice.
  base::Result<exact::Point> to_lattice(double world_x, double world_y) const;
};

/// How lengths of the two axes compare on the ground; made by server/gdal from a CRS.
struct GroundScale {
  bool geographic = false;
  double unit_m = 1;  // projected: metres per CRS unit; geographic: unused
};

/// Metres on the ellipsoid (WGS84) of one degree of longitude and of latitude around `latitude_deg`.
struct DegreeLengths {
  double lon_m = 0;
  double lat_m = 0;
};
DegreeLengths degree_lengths(double latitude_deg);

/// Extent of data in world units.
struct Extent {
  double min_x = 0, min_y = 0, max_x = 0, max_y = 0;
};

/// Axes for scattered points: about 1 mm on the ground (or the given resolution in CRS units, 0 = choose), equal
/// on the ground in x and y, centred on the extent, coarser if the extent does not fit into half the lattice.
/// Errors: kInvalidValue when a given resolution cannot hold the extent or is not positive.
base::Result<Frame> fit_points(const Extent& extent, const GroundScale& scale, double resolution_x,
                               double resolution_y);

/// Axes for a raster of `width` x `height` pixels of the given size (> 0) whose centre of pixel (0, 0), the upper
/// left one, is at (x0, y0): each pixel is divided into a whole number of parts, about 1 mm on the ground and
/// equal on the ground in x and y, so that pixel centres are lattice points exactly. Lattice 0 is the centre of pixel
/// (width / 2, height / 2). Errors: kInvalidValue.
base::Result<Frame> fit_raster(double x0, double y0, double pixel_x, double pixel_y, std::int64_t width,
                               std::int64_t height, const GroundScale& scale);

}  // namespace tin::frame
