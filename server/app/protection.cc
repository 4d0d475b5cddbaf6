#include <algorithm>

#include "server/app/simplify.h"
#include "tin/query/within.h"

namespace server::app {

using tin::exact::Point;
using tin::mesh::VertexSlot;
using tin::query::Inside;
using tin::terrain::Terrain;

namespace {

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
    if (std::any_of(polygons.begin(), polygons.end(),
                    [p](const Inside& polygon) { return polygon.holds(p); }))
      out.push_back(p);
  }
  return out;
}

}  // namespace server::app
