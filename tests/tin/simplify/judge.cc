#include "tests/tin/simplify/judge.h"

#include <gmpxx.h>

#include <algorithm>
#include <array>
#include <vector>

#include "tests/support/mesh_view.h"

namespace support {

using tin::exact::Point;
using tin::mesh::VertexSlot;
using tin::terrain::Terrain;

namespace {

struct Corner {
  mpq_class x, y, z;
};
struct Triangle {
  std::array<Corner, 3> corners;
  Point low, high;  // its box, which spares most rational arithmetic
};

mpq_class turn(const Corner& a, const Corner& b, const Corner& c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

Corner corner(const Terrain& terrain, VertexSlot v) {
  const Point p = terrain.mesh().point(v);
  return {p.x, p.y, mpq_class(terrain.z(v))};
}

std::vector<Triangle> triangles_of(const Terrain& terrain) {
  std::vector<Triangle> out;
  const auto& mesh = terrain.mesh();
  for (std::uint32_t i = 0; i < mesh.triangle_slots(); ++i) {
    const tin::mesh::TriangleSlot t(i);
    if (!mesh.is_alive(t) || mesh.is_infinite(t)) continue;
    const auto& v = mesh.triangle(t).vertices;
    const Point a = mesh.point(v[0]), b = mesh.point(v[1]), c = mesh.point(v[2]);
    out.push_back({{corner(terrain, v[0]), corner(terrain, v[1]), corner(terrain, v[2])},
                   {std::min({a.x, b.x, c.x}), std::min({a.y, b.y, c.y})},
                   {std::max({a.x, b.x, c.x}), std::max({a.y, b.y, c.y})}});
  }
  return out;
}

/// The height over (p.x, p.y); nothing when that is outside the closed triangle.
std::optional<mpq_class> height(const std::array<Corner, 3>& t, const Corner& p) {
  const mpq_class a = turn(t[1], t[2], p), b = turn(t[2], t[0], p), c = turn(t[0], t[1], p);
  if (sgn(a) < 0 || sgn(b) < 0 || sgn(c) < 0) return std::nullopt;
  return mpq_class((a * t[0].z + b * t[1].z + c * t[2].z) / (a + b + c));
}

}  // namespace

std::optional<std::string> judge(const Terrain& source, const Terrain& result, double tolerance) {
  const auto triangles = triangles_of(result);
  for (std::uint32_t i = 1; i < source.mesh().vertex_slots(); ++i) {
    if (!source.mesh().is_alive(VertexSlot(i))) continue;
    const Corner sample = corner(source, VertexSlot(i));
    const Point p = source.mesh().point(VertexSlot(i));
    const std::string name = "sample at " + std::to_string(p.x) + ", " + std::to_string(p.y);
    bool is_covered = false;
    for (const Triangle& t : triangles) {
      if (p.x < t.low.x || p.x > t.high.x || p.y < t.low.y || p.y > t.high.y) continue;
      const auto z = height(t.corners, sample);
      if (!z) continue;
      is_covered = true;
      if (abs(*z - sample.z) > mpq_class(tolerance)) {
        return name + " is off by " + std::to_string(mpq_class(abs(*z - sample.z)).get_d());
      }
    }
    if (!is_covered) return name + " is not covered";
  }
  return std::nullopt;
}

}  // namespace support
