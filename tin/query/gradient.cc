#include "tin/query/gradient.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tin/exact/predicates.h"
#include "tin/query/surface.h"

namespace tin::query {

using delaunay::Location;
using exact::Point;
using mesh::TriangleSlot;
using mesh::VertexSlot;

namespace {
constexpr double kRadian = std::numbers::pi / 180;
}

double slope_degrees(Gradient g) {
  return std::atan(std::hypot(g.east, g.north)) / kRadian;
}

std::optional<double> aspect_degrees(Gradient g) {
  if (g.east == 0 && g.north == 0) return std::nullopt;
  const double degrees = std::atan2(-g.east, -g.north) / kRadian;
  // -0.0 and tiny negative angles, which would round up to 360, are north.
  const double turned = degrees < 0 ? degrees + 360 : degrees;
  return turned >= 360 || turned == 0 ? 0 : turned;
}

Shade::Shade(const Sun& sun)
    : east_(std::sin(sun.azimuth_degrees * kRadian) * std::cos(sun.altitude_degrees * kRadian)),
      north_(std::cos(sun.azimuth_degrees * kRadian) * std::cos(sun.altitude_degrees * kRadian)),
      up_(std::sin(sun.altitude_degrees * kRadian)),
      exaggeration_(sun.exaggeration) {}

double Shade::operator()(Gradient g) const {
  const double x = -g.east * exaggeration_, y = -g.north * exaggeration_;
  return std::max(0.0, (x * east_ + y * north_ + up_) / std::sqrt(x * x + y * y + 1));
}

Gradient GradientQuery::at_vertex(VertexSlot v) const {
  const auto& mesh = terrain_.mesh();
  std::vector<mesh::HalfEdge> link;
  mesh.link(v, link);
  // From the smallest neighbour on, so that the order of the sum does not depend on storage.
  const auto smaller = [&mesh](mesh::HalfEdge a, mesh::HalfEdge b) {
    return mesh.point(mesh.origin(a)) < mesh.point(mesh.origin(b));
  };
  std::erase_if(link, [&mesh](mesh::HalfEdge e) { return mesh.is_infinite(e.triangle()); });
  std::rotate(link.begin(), std::min_element(link.begin(), link.end(), smaller), link.end());
  double dz_dx = 0, dz_dy = 0, areas = 0;
  for (const mesh::HalfEdge e : link) {
    const Facet facet(terrain_, canonical_corners(mesh, e.triangle()));
    const auto area = static_cast<double>(exact::orientation(facet.a(), facet.b(), facet.c()));
    dz_dx += area * facet.dz_dx();
    dz_dy += area * facet.dz_dy();
    areas += area;
  }
  return gradient_on_ground(dz_dx / areas, dz_dy / areas, ground_.steps_at(mesh.point(v).y),
                            ground_.vertical_m());
}

std::optional<Gradient> GradientQuery::at(Point p) {
  const auto& mesh = terrain_.mesh();
  if (mesh.dimension() < 2) return std::nullopt;
  const auto& triangulation = terrain_.triangulation();
  const Location where =
      last_.value() == mesh::kNone ? triangulation.locate(p) : triangulation.locate_from(p, last_);
  last_ = where.triangle;
  if (where.kind == Location::Kind::kOutsideHull) return std::nullopt;
  if (where.kind == Location::Kind::kOnVertex) return at_vertex(where.vertex);
  const TriangleSlot t = answering_triangle(mesh, where);
  if (voids_.any() && voids_.in_void_cell(p) && voids_.may_touch(mesh.triangle(t).vertices))
    return std::nullopt;
  const Facet facet(terrain_, canonical_corners(mesh, t));
  return gradient_on_ground(facet.dz_dx(), facet.dz_dy(), ground_.steps_at(p.y), ground_.vertical_m());
}

}  // namespace tin::query
