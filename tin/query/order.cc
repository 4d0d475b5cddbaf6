#include "tin/query/order.h"

#include <algorithm>

namespace tin::query {

using mesh::TriangleSlot;
using mesh::VertexSlot;
using terrain::VertexId;

void triangles_of(const terrain::Terrain& terrain, VertexId vertex, std::vector<TriangleView>& out) {
  out.clear();
  const auto& mesh = terrain.mesh();
  const auto slot = terrain.slot_of(vertex);
  if (!slot || mesh.dimension() < 2) return;
  const TriangleSlot first = mesh.triangle_at(*slot);
  TriangleSlot t = first;
  do {
    const int i = mesh.index_of(t, *slot);
    if (!mesh.is_infinite(t)) {
      const VertexSlot b = mesh.vertex(t, mesh::next3(i)), c = mesh.vertex(t, mesh::prev3(i));
      const TriangleView view{{vertex, terrain.id_of(b), terrain.id_of(c)}, {*slot, b, c}};
      if (vertex < view.ids[1] && vertex < view.ids[2]) out.push_back(view);
    }
    t = mesh.twin(t, mesh::next3(i)).triangle();
  } while (t != first);
  std::sort(out.begin(), out.end(),
            [](const TriangleView& l, const TriangleView& r) { return l.ids < r.ids; });
}

TriangleWalk::TriangleWalk(const terrain::Terrain& terrain, TriangleCursor from)
    : terrain_(terrain), vertex_(terrain.ids().first_from(VertexId(from.vertex))) {
  if (!vertex_) return;
  triangles_of(terrain_, *vertex_, batch_);
  if (vertex_->value() == from.vertex) at_ = std::min<std::size_t>(from.done, batch_.size());
}

std::optional<TriangleView> TriangleWalk::next() {
  while (vertex_ && at_ == batch_.size()) {
    vertex_ = terrain_.ids().first_from(VertexId(vertex_->value() + 1));
    at_ = 0;
    batch_.clear();
    if (vertex_) triangles_of(terrain_, *vertex_, batch_);
  }
  if (!vertex_) return std::nullopt;
  return batch_[at_++];
}

TriangleCursor TriangleWalk::cursor() const {
  if (!vertex_) return {~std::uint64_t{0}, 0};
  return {vertex_->value(), static_cast<std::uint32_t>(at_)};
}

namespace {

void add_edge(const terrain::Terrain& terrain, VertexId vertex, VertexSlot slot, VertexSlot other, bool hull,
              std::vector<EdgeView>& out) {
  if (other == mesh::kInfinite) return;
  const VertexId id = terrain.id_of(other);
  if (vertex < id) out.push_back({{vertex, id}, {slot, other}, hull});
}

/// The vertices next to one of those that stand in a line.
void edges_on_line(const terrain::Terrain& terrain, VertexId vertex, VertexSlot slot, std::vector<EdgeView>& out) {
  const auto& mesh = terrain.mesh();
  const auto line = mesh.line();
  const auto here = std::lower_bound(line.begin(), line.end(), mesh.point(slot), [&](VertexSlot v, exact::Point p) {
    const exact::Point at = mesh.point(v);
    return at.x != p.x ? at.x < p.x : at.y < p.y;
  });
  if (here != line.begin()) add_edge(terrain, vertex, slot, *(here - 1), true, out);
  if (here + 1 != line.end()) add_edge(terrain, vertex, slot, *(here + 1), true, out);
}

}  // namespace

void edges_of(const terrain::Terrain& terrain, VertexId vertex, std::vector<EdgeView>& out) {
  out.clear();
  const auto& mesh = terrain.mesh();
  const auto slot = terrain.slot_of(vertex);
  if (!slot) return;
  if (mesh.dimension() < 2) {
    edges_on_line(terrain, vertex, *slot, out);
  } else {
    const TriangleSlot first = mesh.triangle_at(*slot);
    TriangleSlot t = first;
    do {
      // The edge from `vertex` that this triangle and the next one counter-clockwise share.
      const int i = mesh.index_of(t, *slot);
      const TriangleSlot next = mesh.twin(t, mesh::next3(i)).triangle();
      add_edge(terrain, vertex, *slot, mesh.vertex(t, mesh::prev3(i)), mesh.is_infinite(t) || mesh.is_infinite(next), out);
      t = next;
    } while (t != first);
  }
  std::sort(out.begin(), out.end(), [](const EdgeView& l, const EdgeView& r) { return l.ids < r.ids; });
}

std::size_t edge_count(const terrain::Terrain& terrain) {
  const std::size_t vertices = terrain.vertex_count();
  if (vertices == 0) return 0;
  return vertices + terrain.triangle_count() - 1;  // collinear vertices: no triangles, one edge less than vertices
}

EdgeWalk::EdgeWalk(const terrain::Terrain& terrain, TriangleCursor from)
    : terrain_(terrain), vertex_(terrain.ids().first_from(VertexId(from.vertex))) {
  if (!vertex_) return;
  edges_of(terrain_, *vertex_, batch_);
  if (vertex_->value() == from.vertex) at_ = std::min<std::size_t>(from.done, batch_.size());
}

std::optional<EdgeView> EdgeWalk::next() {
  while (vertex_ && at_ == batch_.size()) {
    vertex_ = terrain_.ids().first_from(VertexId(vertex_->value() + 1));
    at_ = 0;
    batch_.clear();
    if (vertex_) edges_of(terrain_, *vertex_, batch_);
  }
  if (!vertex_) return std::nullopt;
  return batch_[at_++];
}

TriangleCursor EdgeWalk::cursor() const {
  if (!vertex_) return {~std::uint64_t{0}, 0};
  return {vertex_->value(), static_cast<std::uint32_t>(at_)};
}

}  // namespace tin::query
