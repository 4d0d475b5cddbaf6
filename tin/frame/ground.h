// Lengths and areas on the ground of what is given in lattice steps.
//
//   Ground ground(terrain.frame(), crs.scale);
//   double metres = ground.distance({x0, y0}, {x1, y1});
#pragma once

#include "tin/frame/frame.h"

namespace tin::frame {

/// A position in lattice steps that need not be a lattice point.
struct Place {
  double x = 0, y = 0;
  friend bool operator==(const Place&, const Place&) = default;
};

inline Place place(exact::Point p) {
  return {static_cast<double>(p.x), static_cast<double>(p.y)};
}

/// Metres of one lattice step along x and along y.
struct StepLengths {
  double x = 0, y = 0;
};

/// In projected (and local) CRSs metres are those of the map plane, without its scale error; in geographic
/// ones those on the WGS84 ellipsoid. A local CRS counts in metres. Copies what it needs; thread-safe.
class Ground {
 public:
  Ground(const Frame& frame, const GroundScale& scale);

  bool geographic() const { return geographic_; }
  /// Metres of one unit of elevation.
  double vertical_m() const { return vertical_m_; }
  /// At the lattice ordinate `y`. Towards the poles lengths along x are those at 89 degrees.
  StepLengths steps_at(double y) const;
  /// Metres between two places: the geodesic, or the straight line of the map. Cost: about 1 us if geodesic.
  double distance(Place a, Place b) const;
  /// Square metres of one square lattice step at the lattice ordinate `y`. Beyond the poles there is no
  /// ground: 0.
  double area_at(double y) const;

 private:
  double latitude(double y) const { return y_.world(y); }

  Axis x_, y_;
  bool geographic_;
  double vertical_m_;
  StepLengths fixed_;  // unless geographic
};

}  // namespace tin::frame
