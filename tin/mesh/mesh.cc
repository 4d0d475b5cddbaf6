#include "tin/mesh/mesh.h"

#include <algorithm>

namespace tin::mesh {
namespace {

/// Room for one more element: a quarter more when it is full. Twice as much would be quicker by a hair, and
/// wasted for long.
template <class T>
void make_room(PageVector<T>& array) {
  if (array.size() == array.capacity()) array.reserve(array.size() + array.size() / 4 + 16);
}

}  // namespace

Mesh::Mesh() : points_(1, exact::Point{}), star_(1, kNoTriangle) {}

int Mesh::dimension() const {
  if (triangle_count_ > 0) return 2;
  if (vertex_count_ == 0) return -1;
  return vertex_count_ == 1 ? 0 : 1;
}

std::size_t Mesh::finite_triangle_count() const {
  // Euler on the sphere: n + 1 vertices (one infinite) make 2n - 2 triangles, h of them infinite; h is found
  // by a walk.
  if (dimension() < 2) return 0;
  std::size_t hull = 0;
  const TriangleSlot first = triangle_at(kInfinite);
  TriangleSlot t = first;
  do {
    ++hull;
    t = twin(t, next3(index_of(t, kInfinite))).triangle();
  } while (t != first);
  return triangle_count_ - hull;
}

void Mesh::link(VertexSlot v, std::vector<HalfEdge>& out) const {
  out.clear();
  const TriangleSlot first = triangle_at(v);
  TriangleSlot t = first;
  do {
    const int i = index_of(t, v);
    const HalfEdge edge(t, i);
    // The walk around needs one triangle after the other; what its callers touch next can be fetched
    // meanwhile.
    prefetch(twin(edge).triangle());
    prefetch(origin(edge));
    out.push_back(edge);
    t = twin(t, next3(i)).triangle();
  } while (t != first);
}

VertexSlot Mesh::add_vertex(exact::Point p, VertexSlot near) {
  ++vertex_count_;
  if (!free_vertices_.empty()) {
    const std::uint32_t slot = free_vertices_.take_near(near.value());
    points_[slot] = p;
    star_[slot] = kNoTriangle;
    return VertexSlot(slot);
  }
  make_room(points_);
  make_room(star_);
  points_.push_back(p);
  star_.push_back(kNoTriangle);
  return VertexSlot(static_cast<std::uint32_t>(points_.size() - 1));
}

TriangleSlot Mesh::claim_triangle(TriangleSlot near) {
  ++triangle_count_;
  if (!free_triangles_.empty()) return TriangleSlot(free_triangles_.take_near(near.value()));
  make_room(triangles_);
  triangles_.emplace_back();
  return TriangleSlot(static_cast<std::uint32_t>(triangles_.size() - 1));
}

TriangleSlot Mesh::add_triangle(VertexSlot a, VertexSlot b, VertexSlot c) {
  const TriangleSlot t = claim_triangle(TriangleSlot(0));
  set_triangle(t, a, b, c);
  return t;
}

void Mesh::clear_triangles() {
  triangles_.clear();
  free_triangles_.clear();
  triangle_count_ = 0;
  for (auto& star : star_) {
    if (star != kDead) star = kNoTriangle;
  }
}

void Mesh::reserve(std::size_t vertices) {
  points_.reserve(vertices + 1);
  star_.reserve(vertices + 1);
  triangles_.reserve(2 * vertices);
}

void Mesh::begin_bulk(std::size_t count) {
  TIN_DCHECK(vertex_count_ == 0 && triangle_count_ == 0);
  free_vertices_.clear();
  free_triangles_.clear();
  points_.resize(count + 1);
  star_.resize(count + 1);
  triangles_.resize(2 * count);
}

void Mesh::end_bulk(std::span<const TriangleSlot> unused) {
  vertex_count_ = points_.size() - 1;
  triangle_count_ = triangles_.size();
  if (unused.size() == triangles_.size()) {
    std::fill(star_.begin(), star_.end(), kNoTriangle);
    return clear_triangles();
  }
  for (const TriangleSlot t : unused) release_triangle(t);
}

std::size_t Mesh::bytes() const {
  return points_.capacity() * sizeof(exact::Point) + star_.capacity() * sizeof(std::uint32_t) +
         triangles_.capacity() * sizeof(Triangle) + free_vertices_.bytes() + free_triangles_.bytes() +
         line_.capacity() * sizeof(VertexSlot);
}

}  // namespace tin::mesh
