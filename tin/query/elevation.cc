#include "tin/query/elevation.h"

#include <algorithm>

#include "tin/exact/predicates.h"
#include "tin/query/surface.h"

namespace tin::query {

using delaunay::Location;
using exact::orientation;
using exact::Point;
using mesh::VertexSlot;

std::optional<Elevation> ElevationQuery::at(Point p) {
  const auto& mesh = terrain_.mesh();
  if (mesh.dimension() < 2) return on_line(p);
  const auto& triangulation = terrain_.triangulation();
  const Location where =
      last_.value() == mesh::kNone ? triangulation.locate(p) : triangulation.locate_from(p, last_);
  last_ = where.triangle;
  if (where.kind == Location::Kind::kOutsideHull) return std::nullopt;
  const Slots corners = canonical_corners(mesh, answering_triangle(mesh, where));
  if (is_void(p, corners)) return std::nullopt;
  double z = 0;
  if (where.kind == Location::Kind::kOnVertex) {
    z = terrain_.z(where.vertex);
  } else {
    z = by_ == Interpolation::kLinear ? Facet(terrain_, corners).z(p) : by_neighbours(p, where.triangle);
  }
  std::array ids{terrain_.id_of(corners[0]), terrain_.id_of(corners[1]), terrain_.id_of(corners[2])};
  std::rotate(ids.begin(), std::min_element(ids.begin(), ids.end()), ids.end());
  return Elevation{z, ids};
}

double ElevationQuery::by_neighbours(Point p, mesh::TriangleSlot t) {
  const auto weights = neighbours_.at(p, t);
  const double base = terrain_.z(weights.front().vertex);
  // Relative to one neighbour, so that level ground is level to the last bit.
  double rise = 0;
  for (const auto& [vertex, weight] : weights) rise += weight * (terrain_.z(vertex) - base);
  return base + rise;
}

std::optional<Elevation> ElevationQuery::on_line(Point p) const {
  const auto& mesh = terrain_.mesh();
  const auto line = mesh.line();
  const auto after = std::lower_bound(line.begin(), line.end(), p,
                                      [&mesh](VertexSlot v, Point q) { return mesh.point(v) < q; });
  if (after == line.end()) return std::nullopt;
  if (mesh.point(*after) == p) return Elevation{terrain_.z(*after), std::nullopt};
  if (after == line.begin()) return std::nullopt;
  const VertexSlot from = *(after - 1), to = *after;
  const Point a = mesh.point(from), b = mesh.point(to);
  if (orientation(a, b, p) != 0 || is_void(p, std::array{from, to})) return std::nullopt;
  const double along =
      a.x != b.x ? (double(p.x) - a.x) / (double(b.x) - a.x) : (double(p.y) - a.y) / (double(b.y) - a.y);
  return Elevation{terrain_.z(from) + along * (terrain_.z(to) - terrain_.z(from)), std::nullopt};
}

bool ElevationQuery::is_void(Point p, std::span<const VertexSlot> corners) const {
  if (!voids_.any() || !voids_.in_void_cell(p)) return false;
  return std::none_of(corners.begin(), corners.end(), [&](VertexSlot v) {
    return voids_.in_void_cell(terrain_.mesh().point(v));
  });
}

}  // namespace tin::query
