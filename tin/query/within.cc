#include "tin/query/within.h"

#include <algorithm>

#include "tin/exact/predicates.h"

namespace tin::query {

using exact::Point;

Inside::Inside(std::span<const Ring> rings) {
  for (const Ring& ring : rings) {
    for (std::size_t i = 0; i < ring.size(); ++i) {
      const Point a = ring[i], b = ring[i + 1 == ring.size() ? 0 : i + 1];
      if (a == b) continue;
      if (sides_.empty()) min_ = max_ = a;
      min_ = {std::min(min_.x, a.x), std::min(min_.y, a.y)};
      max_ = {std::max(max_.x, a.x), std::max(max_.y, a.y)};
      sides_.push_back(a.y <= b.y ? Side{a, b} : Side{b, a});
      tallest_ = std::max(tallest_, std::int64_t{sides_.back().high.y} - sides_.back().low.y);
    }
  }
  std::sort(sides_.begin(), sides_.end(), [](const Side& a, const Side& b) { return a.low.y < b.low.y; });
}

bool Inside::holds(Point p) const {
  if (p.x < min_.x || p.x > max_.x || p.y < min_.y || p.y > max_.y) return false;
  const auto above = [](std::int32_t y, const Side& side) { return y < side.low.y; };
  auto side = std::upper_bound(sides_.begin(), sides_.end(), p.y, above);
  bool inside = false;
  while (side != sides_.begin() && (--side)->low.y + tallest_ >= p.y) {
    if (side->high.y < p.y) continue;
    const std::int64_t turn = exact::orientation(side->low, side->high, p);
    const auto [left, right] = std::minmax(side->low.x, side->high.x);
    if (turn == 0 && p.x >= left && p.x <= right) return true;
    if (turn > 0 && p.y < side->high.y) inside = !inside;
  }
  return inside;
}

std::vector<terrain::VertexId> vertices_within(const terrain::Terrain& terrain, const Ring& ring,
                                               std::size_t most) {
  const Inside inside(ring);
  const mesh::Mesh& mesh = terrain.mesh();
  std::vector<terrain::VertexId> ids;
  for (std::uint32_t i = 1; i < mesh.vertex_slots() && ids.size() <= most; ++i) {
    const mesh::VertexSlot v(i);
    if (mesh.is_alive(v) && inside.holds(mesh.point(v))) ids.push_back(terrain.id_of(v));
  }
  std::sort(ids.begin(), ids.end());
  return ids;
}

}  // namespace tin::query
