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

}  // namespace tin::query
