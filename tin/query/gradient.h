// Slope, aspect and shade of the surface.
//
//   GradientQuery query(terrain, Voids::kKeep, ground);
//   if (auto g = query.at({120, 340})) use(slope_degrees(*g), aspect_degrees(*g));
#pragma once

#include <optional>

#include "tin/frame/ground.h"
#include "tin/query/voids.h"
#include "tin/terrain/terrain.h"

namespace tin::query {

/// Rise per metre of ground, in metres, towards east and towards north (of the CRS).
struct Gradient {
  double east = 0, north = 0;
  friend bool operator==(const Gradient&, const Gradient&) = default;
};

/// The angle against the horizontal, 0 to 90.
double slope_degrees(Gradient g);
/// Where the surface faces: the direction of steepest descent, clockwise from north, 0 up to 360; nothing on
/// level ground.
std::optional<double> aspect_degrees(Gradient g);

/// Where the light comes from.
struct Sun {
  double azimuth_degrees = 315;  // clockwise from north
  double altitude_degrees = 45;  // above the horizon
  double exaggeration = 1;       // of elevations
};

/// Light on a surface from a sun: the cosine of the angle between the light and the surface's normal, 0 in
/// the shade.
class Shade {
 public:
  explicit Shade(const Sun& sun);
  double operator()(Gradient g) const;

 private:
  double east_, north_, up_, exaggeration_;
};

/// From rises per lattice step, where steps have these lengths.
inline Gradient gradient_on_ground(double dz_dx, double dz_dy, frame::StepLengths step, double vertical_m) {
  return {dz_dx * vertical_m / step.x, dz_dy * vertical_m / step.y};
}

/// Gradients at lattice points. Borrows terrain and ground. One thread.
class GradientQuery {
 public:
  GradientQuery(const terrain::Terrain& terrain, Voids voids, const frame::Ground& ground)
      : terrain_(terrain), voids_(terrain, voids), ground_(ground) {}

  /// That of the triangle (on an edge, of the one that the elevation is taken from); at a vertex the mean of
  /// its triangles' by their areas on the lattice. Nothing outside, in voids, and where there are no
  /// triangles. Equal for every history of the same set. Cost: as ElevationQuery::at().
  std::optional<Gradient> at(exact::Point p);
  /// At a vertex. Requires: dimension 2. Cost: its degree.
  Gradient at_vertex(mesh::VertexSlot v) const;

 private:
  const terrain::Terrain& terrain_;
  VoidMask voids_;
  const frame::Ground& ground_;
  mesh::TriangleSlot last_{mesh::kNone};
};

}  // namespace tin::query
