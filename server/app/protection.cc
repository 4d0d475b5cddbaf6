#include <algorithm>

#include "server/app/simplify.h"

namespace server::app {

using tin::exact::Point;
using tin::mesh::VertexSlot;
using tin::terrain::Terrain;

namespace {

/// Rings by rows of y, so that a position meets few sides.
class Inside {
 public:
  explicit Inside(const Protection::Polygon& polygon) {
    for (const auto& ring : polygon) {
      for (std::size_t i = 0; i < ring.size(); ++i) {
        const auto &a = ring[i], &b = ring[i + 1 == ring.size() ? 0 : i + 1];
        if (a.y != b.y) sides_.push_back(a.y < b.y ? Side{a, b} : Side{b, a});
      }
    }
    std::sort(sides_.begin(), sides_.end(), [](const Side& a, const Side& b) { return a.low.y < b.low.y; });
    for (const Side& side : sides_) highest_ = std::max(highest_, side.high.y - side.low.y);
  }

  bool holds(double x, double y) const {
    // A side across y begins at or below it, and less than the highest side's length below.
    const auto after = [](double value, const Side& side) { return value < side.low.y; };
    auto side = std::upper_bound(sides_.begin(), sides_.end(), y, after);
    bool inside = false;
    while (side != sides_.begin() && (--side)->low.y >= y - highest_) {
      if (side->high.y <= y) continue;
      const double along = (y - side->low.y) / (side->high.y - side->low.y);
      if (x < side->low.x + along * (side->high.x - side->low.x)) inside = !inside;
    }
    return inside;
  }

 private:
  struct Side {
    Protection::Corner low, high;
  };
  std::vector<Side> sides_;
  double highest_ = 0;
};

void add_border(const Terrain& terrain, std::vector<Point>& out) {
  const auto& mesh = terrain.mesh();
  if (mesh.dimension() < 2) return;
  std::vector<tin::mesh::HalfEdge> link;
  mesh.link(tin::mesh::kInfinite, link);
  for (const auto e : link) out.push_back(mesh.point(mesh.origin(e)));
}

}  // namespace

std::vector<Point> protected_positions(const Terrain& terrain, const Protection& protection) {
  std::vector<Point> out;
  for (const VertexId id : protection.ids) {
    if (const auto vertex = terrain.vertex(id)) out.push_back(vertex->at);
  }
  if (protection.border) add_border(terrain, out);
  if (protection.polygons.empty()) return out;
  const std::vector<Inside> polygons(protection.polygons.begin(), protection.polygons.end());
  const auto& mesh = terrain.mesh();
  for (std::uint32_t i = 1; i < mesh.vertex_slots(); ++i) {
    if (!mesh.is_alive(VertexSlot(i))) continue;
    const Point p = mesh.point(VertexSlot(i));
    const double x = terrain.frame().x.world(p.x), y = terrain.frame().y.world(p.y);
    if (std::any_of(polygons.begin(), polygons.end(),
                    [&](const Inside& polygon) { return polygon.holds(x, y); }))
      out.push_back(p);
  }
  return out;
}

}  // namespace server::app
