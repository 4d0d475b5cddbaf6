#include "tin/query/elevation.h"

#include <algorithm>

#include "tin/exact/predicates.h"

namespace tin::query {

using delaunay::Location;
using exact::orientation;
using exact::Point;
using mesh::VertexSlot;

namespace {

using Slots = std::array<VertexSlot, 3>;

/// Corners with the smallest position first, counter-clockwise: rounding then does not depend on storage.
Slots canonical_corners(const mesh::Mesh& mesh, mesh::TriangleSlot t) {
  Slots corners = mesh.triangle(t).vertices;
  const auto smaller = [&mesh](VertexSlot a, VertexSlot b) { return mesh.point(a) < mesh.point(b); };
  std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end(), smaller), corners.end());
  return corners;
}

/// Of the two triangles at an edge the one whose far corner is smaller, so that storage order does not show.
mesh::TriangleSlot pick_at_edge(const mesh::Mesh& mesh, const Location& where) {
  const mesh::HalfEdge other = mesh.twin(where.triangle, where.index);
  if (mesh.is_infinite(other.triangle())) return where.triangle;
  const Point here = mesh.point(mesh.vertex(where.triangle, where.index)),
              there = mesh.point(mesh.apex(other));
  return here < there ? where.triangle : other.triangle();
}

/// Of the triangles at a vertex the one that follows its smallest finite neighbour counter-clockwise, if
/// finite.
mesh::TriangleSlot pick_at_vertex(const mesh::Mesh& mesh, const Location& where) {
  mesh::TriangleSlot best = where.triangle, t = where.triangle;
  std::optional<Point> smallest;
  do {
    const int i = mesh.index_of(t, where.vertex);
    const Point next = mesh.point(mesh.vertex(t, mesh::next3(i)));
    if (!mesh.is_infinite(t) && (!smallest || next < *smallest)) {
      smallest = next;
      best = t;
    }
    t = mesh.twin(t, mesh::next3(i)).triangle();
  } while (t != where.triangle);
  return best;
}

double interpolate(const terrain::Terrain& terrain, const Slots& corners, Point p) {
  const auto& mesh = terrain.mesh();
  const Point a = mesh.point(corners[0]), b = mesh.point(corners[1]), c = mesh.point(corners[2]);
  const double za = terrain.z(corners[0]);
  const auto weight_b = static_cast<double>(orientation(a, p, c)),
             weight_c = static_cast<double>(orientation(a, b, p));
  const auto area = static_cast<double>(orientation(a, b, c));
  // Relative to one corner, so that level triangles are level to the last bit.
  return za + (weight_b * (terrain.z(corners[1]) - za) + weight_c * (terrain.z(corners[2]) - za)) / area;
}

}  // namespace

std::optional<Elevation> ElevationQuery::at(Point p) {
  const auto& mesh = terrain_.mesh();
  if (mesh.dimension() < 2) return std::nullopt;
  const auto& triangulation = terrain_.triangulation();
  const Location where =
      last_.value() == mesh::kNone ? triangulation.locate(p) : triangulation.locate_from(p, last_);
  last_ = where.triangle;
  if (where.kind == Location::Kind::kOutsideHull) return std::nullopt;
  mesh::TriangleSlot t = where.triangle;
  if (where.kind == Location::Kind::kOnEdge) t = pick_at_edge(mesh, where);
  if (where.kind == Location::Kind::kOnVertex) t = pick_at_vertex(mesh, where);
  const Slots corners = canonical_corners(mesh, t);
  if (is_void(p, corners)) return std::nullopt;
  const double z =
      where.kind == Location::Kind::kOnVertex ? terrain_.z(where.vertex) : interpolate(terrain_, corners, p);
  Elevation found{z, {terrain_.id_of(corners[0]), terrain_.id_of(corners[1]), terrain_.id_of(corners[2])}};
  std::rotate(found.triangle.begin(), std::min_element(found.triangle.begin(), found.triangle.end()),
              found.triangle.end());
  return found;
}

bool ElevationQuery::is_void(Point p, const Slots& corners) const {
  const terrain::SourceGrid* grid = terrain_.source_grid();
  if (voids_ == Voids::kFill || grid == nullptr || grid->valid.empty()) return false;
  const auto in_void = [grid](Point q) {
    const auto cell = grid->cell_at(q);
    return cell && !grid->is_valid(cell->column, cell->row);
  };
  if (!in_void(p)) return false;
  return std::none_of(corners.begin(), corners.end(),
                      [&](VertexSlot v) { return in_void(terrain_.mesh().point(v)); });
}

}  // namespace tin::query
