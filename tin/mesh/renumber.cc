// Renumbering: after mass deletion the arrays have gaps, after growth in random order what is near on the
// ground is far in memory. Storing vertices in the order of a space-filling curve, and triangles after their
// vertices, mends both.
#include <algorithm>

#include "tin/mesh/mesh.h"

namespace tin::mesh {
namespace {

/// The triangle's smallest finite vertex in the new numbering: triangles are stored in the order of these.
std::uint32_t first_vertex(const Triangle& t, const std::vector<VertexSlot>& new_of_old) {
  std::uint32_t first = kNone;
  for (const VertexSlot v : t.vertices) {
    if (v != kInfinite) first = std::min(first, new_of_old[v.value()].value());
  }
  return first;
}

}  // namespace

Renumbering Mesh::renumber(std::span<const VertexSlot> order) {
  TIN_DCHECK(order.size() == vertex_count_);
  Renumbering moved;
  moved.vertices.assign(points_.size(), VertexSlot(kNone));
  moved.vertices[0] = kInfinite;
  PageVector<exact::Point> points(order.size() + 1);
  points[0] = points_[0];
  for (std::uint32_t i = 0; i < order.size(); ++i) {
    points[i + 1] = points_[order[i].value()];
    moved.vertices[order[i].value()] = VertexSlot(i + 1);
  }
  points_ = std::move(points);
  moved.triangles = renumber_triangles(moved.vertices);
  PageVector<std::uint32_t> star(order.size() + 1, kNoTriangle);
  for (std::uint32_t t = 0; t < triangles_.size(); ++t) {
    for (const VertexSlot v : triangles_[t].vertices) star[v.value()] = t;
  }
  star_ = std::move(star);
  for (VertexSlot& v : line_) v = moved.vertices[v.value()];
  free_vertices_.clear();
  return moved;
}

/// A counting sort by first vertex, then one pass that rewrites the triangles with their new names.
std::vector<TriangleSlot> Mesh::renumber_triangles(const std::vector<VertexSlot>& new_of_old) {
  std::vector<std::uint32_t> place(points_.size() + 1, 0);
  for (const Triangle& t : triangles_) {
    if (t.vertices[0].value() != kNone) ++place[first_vertex(t, new_of_old) + 1];
  }
  for (std::size_t i = 1; i < place.size(); ++i) place[i] += place[i - 1];
  std::vector<TriangleSlot> moved(triangles_.size(), TriangleSlot(kNone));
  for (std::uint32_t t = 0; t < triangles_.size(); ++t) {
    if (!is_alive(TriangleSlot(t))) continue;
    moved[t] = TriangleSlot(place[first_vertex(triangles_[t], new_of_old)]++);
  }
  PageVector<Triangle> triangles(triangle_count_);
  for (std::uint32_t t = 0; t < triangles_.size(); ++t) {
    if (!is_alive(TriangleSlot(t))) continue;
    Triangle& copy = triangles[moved[t].value()];
    for (std::size_t i = 0; i < 3; ++i) {
      const HalfEdge twin = triangles_[t].neighbours[i];
      copy.vertices[i] = new_of_old[triangles_[t].vertices[i].value()];
      copy.neighbours[i] = HalfEdge(moved[twin.triangle().value()], twin.index());
    }
  }
  triangles_ = std::move(triangles);
  free_triangles_.clear();
  return moved;
}

}  // namespace tin::mesh
