#include "tin/delaunay/triangulation.h"

#include <algorithm>

#include "tin/base/check.h"

namespace tin::delaunay {

using mesh::kInfinite;
using mesh::TriangleSlot;
using mesh::VertexSlot;

void Triangulation::remove(VertexSlot v) {
  TIN_DCHECK(v != kInfinite && mesh_.is_alive(v));
  if (mesh_.dimension() < 2) {
    fresh_.clear();
    std::erase(mesh_.mutable_line(), v);
    mesh_.release_vertex(v);
    return;
  }
  if (!remover_.remove(mesh_, v, fresh_)) drop_to_line(v);
}

/// All vertices but `gone` are collinear: they become a line again.
void Triangulation::drop_to_line(VertexSlot gone) {
  mesh_.clear_triangles();
  mesh_.release_vertex(gone);
  auto& line = mesh_.mutable_line();
  line.clear();
  for (std::uint32_t i = 1; i < mesh_.vertex_slots(); ++i) {
    if (mesh_.is_alive(VertexSlot(i))) line.push_back(VertexSlot(i));
  }
  std::sort(line.begin(), line.end(), [this](VertexSlot a, VertexSlot b) { return mesh_.point(a) < mesh_.point(b); });
}

}  // namespace tin::delaunay
