#include "tin/removal/remover.h"

namespace tin::removal {

std::span<const Ear> Remover::fill(const mesh::Mesh& mesh, mesh::VertexSlot v) {
  star_.gather(mesh, v);
  if (star_.leaves_a_line()) return {};
  NoCounters none;
  return production_.fill(star_, none);
}

bool Remover::remove(mesh::Mesh& mesh, mesh::VertexSlot v, std::vector<mesh::TriangleSlot>& fresh) {
  const auto ears = fill(mesh, v);
  if (ears.empty()) {
    fresh.clear();
    return false;
  }
  star_.refill(mesh, ears, fresh);
  return true;
}

}  // namespace tin::removal
