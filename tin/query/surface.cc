#include "tin/query/surface.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "tin/exact/predicates.h"

namespace tin::query {

using delaunay::Location;
using exact::orientation;
using exact::Point;
using mesh::TriangleSlot;
using mesh::VertexSlot;

Slots canonical_corners(const mesh::Mesh& mesh, TriangleSlot t) {
  Slots corners = mesh.triangle(t).vertices;
  const auto smaller = [&mesh](VertexSlot a, VertexSlot b) { return mesh.point(a) < mesh.point(b); };
  std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end(), smaller), corners.end());
  return corners;
}

bool owns_edge(const mesh::Mesh& mesh, TriangleSlot t, int index) {
  const mesh::HalfEdge other = mesh.twin(t, index);
  if (mesh.is_infinite(other.triangle())) return true;
  return mesh.point(mesh.vertex(t, index)) < mesh.point(mesh.apex(other));
}

namespace {

TriangleSlot answering_at_vertex(const mesh::Mesh& mesh, const Location& where) {
  TriangleSlot best = where.triangle, t = where.triangle;
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

}  // namespace

TriangleSlot answering_triangle(const mesh::Mesh& mesh, const Location& where) {
  if (where.kind == Location::Kind::kOnVertex) return answering_at_vertex(mesh, where);
  if (where.kind == Location::Kind::kOnEdge && !owns_edge(mesh, where.triangle, where.index)) {
    return mesh.twin(where.triangle, where.index).triangle();
  }
  return where.triangle;
}

Facet::Facet(const terrain::Terrain& terrain, const Slots& corners)
    : a_(terrain.mesh().point(corners[0])),
      b_(terrain.mesh().point(corners[1])),
      c_(terrain.mesh().point(corners[2])),
      za_(terrain.z(corners[0])),
      rise_b_(terrain.z(corners[1]) - za_),
      rise_c_(terrain.z(corners[2]) - za_),
      area_(static_cast<double>(orientation(a_, b_, c_))) {}

namespace {
double along(std::int32_t from, std::int32_t to) {
  return static_cast<double>(to) - from;
}
}  // namespace

double Facet::dz_dx() const {
  return (rise_b_ * along(a_.y, c_.y) - rise_c_ * along(a_.y, b_.y)) / area_;
}
double Facet::dz_dy() const {
  return (rise_c_ * along(a_.x, b_.x) - rise_b_ * along(a_.x, c_.x)) / area_;
}

double Facet::z(Point p) const {
  const auto weight_b = static_cast<double>(orientation(a_, p, c_)),
             weight_c = static_cast<double>(orientation(a_, b_, p));
  return za_ + (weight_b * rise_b_ + weight_c * rise_c_) / area_;
}

void Facet::z_along(std::int32_t y, std::span<const double> x, double* out) const {
  constexpr double kExact = 0x1p26;  // products of two such numbers, and their differences, are exact doubles
  const double ab_x = along(a_.x, b_.x), ab_y = along(a_.y, b_.y), ac_x = along(a_.x, c_.x),
               ac_y = along(a_.y, c_.y);
  const double up = along(a_.y, y), ax = a_.x;
  const double widest =
      std::max({std::abs(ab_x), std::abs(ab_y), std::abs(ac_x), std::abs(ac_y), std::abs(up)});
  if (widest >= kExact) {
    for (std::size_t i = 0; i < x.size(); ++i) out[i] = z(Point{static_cast<std::int32_t>(x[i]), y});
    return;
  }
  const double b_row = up * ac_x, c_row = ab_x * up;
  const double za = za_, rise_b = rise_b_, rise_c = rise_c_, area = area_;
  const double* from = x.data();
  const std::size_t count = x.size();
  for (std::size_t i = 0; i < count; ++i) {
    const double right = from[i] - ax;
    const double weight_b = right * ac_y - b_row, weight_c = c_row - ab_y * right;
    out[i] = za + (weight_b * rise_b + weight_c * rise_c) / area;
  }
}

}  // namespace tin::query
