#include "tin/mesh/mesh.h"

namespace tin::mesh {

Mesh::Mesh() : points_(1), star_{kNoTriangle} {}

int Mesh::dimension() const {
  if (triangles_.size() > free_triangles_.size()) return 2;
  if (vertex_count_ == 0) return -1;
  return vertex_count_ == 1 ? 0 : 1;
}

std::size_t Mesh::finite_triangle_count() const {
  // Euler on the sphere: n + 1 vertices (one infinite) make 2n - 2 triangles, h of them infinite; h is found by a walk.
  if (dimension() < 2) return 0;
  std::size_t hull = 0;
  const TriangleSlot first = triangle_at(kInfinite);
  TriangleSlot t = first;
  do {
    ++hull;
    t = twin(t, next3(index_of(t, kInfinite))).triangle();
  } while (t != first);
  return triangles_.size() - free_triangles_.size() - hull;
}

bool Mesh::is_infinite(TriangleSlot t) const {
  const auto& v = triangle(t).vertices;
  return v[0] == kInfinite || v[1] == kInfinite || v[2] == kInfinite;
}

int Mesh::index_of(TriangleSlot t, VertexSlot v) const {
  const auto& vertices = triangle(t).vertices;
  if (vertices[0] == v) return 0;
  if (vertices[1] == v) return 1;
  TIN_DCHECK(vertices[2] == v);
  return 2;
}

void Mesh::link(VertexSlot v, std::vector<HalfEdge>& out) const {
  out.clear();
  const TriangleSlot first = triangle_at(v);
  TriangleSlot t = first;
  do {
    const int i = index_of(t, v);
    out.emplace_back(t, i);
    t = twin(t, next3(i)).triangle();
  } while (t != first);
}

VertexSlot Mesh::add_vertex(exact::Point p) {
  ++vertex_count_;
  if (!free_vertices_.empty()) {
    const std::uint32_t slot = free_vertices_.back();
    free_vertices_.pop_back();
    points_[slot] = p;
    star_[slot] = kNoTriangle;
    return VertexSlot(slot);
  }
  points_.push_back(p);
  star_.push_back(kNoTriangle);
  return VertexSlot(static_cast<std::uint32_t>(points_.size() - 1));
}

void Mesh::release_vertex(VertexSlot v) {
  TIN_DCHECK(v != kInfinite && is_alive(v));
  --vertex_count_;
  star_[v.value()] = kDead;
  free_vertices_.push_back(v.value());
}

TriangleSlot Mesh::add_triangle(VertexSlot a, VertexSlot b, VertexSlot c) {
  TriangleSlot t;
  if (free_triangles_.empty()) {
    t = TriangleSlot(static_cast<std::uint32_t>(triangles_.size()));
    triangles_.emplace_back();
  } else {
    t = TriangleSlot(free_triangles_.back());
    free_triangles_.pop_back();
  }
  set_triangle(t, a, b, c);
  return t;
}

void Mesh::set_triangle(TriangleSlot t, VertexSlot a, VertexSlot b, VertexSlot c) {
  triangles_[t.value()].vertices = {a, b, c};
  star_[a.value()] = star_[b.value()] = star_[c.value()] = t.value();
}

void Mesh::release_triangle(TriangleSlot t) {
  triangles_[t.value()].vertices[0] = VertexSlot(kNone);
  free_triangles_.push_back(t.value());
}

void Mesh::join(HalfEdge a, HalfEdge b) {
  triangles_[a.triangle().value()].neighbours[static_cast<std::size_t>(a.index())] = b;
  triangles_[b.triangle().value()].neighbours[static_cast<std::size_t>(b.index())] = a;
}

void Mesh::clear_triangles() {
  triangles_.clear();
  free_triangles_.clear();
  for (auto& star : star_) {
    if (star != kDead) star = kNoTriangle;
  }
}

void Mesh::reserve(std::size_t vertices) {
  points_.reserve(vertices + 1);
  star_.reserve(vertices + 1);
  triangles_.reserve(2 * vertices);
}

}  // namespace tin::mesh
