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

namespace {

struct Edge {
  Point from, to;
  double from_z, to_z;
};

/// Each once.
std::vector<Edge> edges_of(const Terrain& terrain) {
  const auto& mesh = terrain.mesh();
  std::vector<Edge> out;
  for (std::uint32_t i = 0; i < mesh.triangle_slots(); ++i) {
    const tin::mesh::TriangleSlot t(i);
    if (!mesh.is_alive(t) || mesh.is_infinite(t)) continue;
    for (int side = 0; side < 3; ++side) {
      const VertexSlot a = mesh.vertex(t, side), b = mesh.vertex(t, (side + 1) % 3);
      const auto beyond = mesh.twin(t, (side + 2) % 3).triangle();
      if (mesh.is_infinite(beyond) || t < beyond) out.push_back({mesh.point(a), mesh.point(b), terrain.z(a), terrain.z(b)});
    }
  }
  return out;
}

/// Twice the area of the triangle; exact, since coordinates have 30 bits.
std::int64_t turn(Point a, Point b, Point c) {
  return (std::int64_t{b.x} - a.x) * (std::int64_t{c.y} - a.y) - (std::int64_t{b.y} - a.y) * (std::int64_t{c.x} - a.x);
}

bool is_between(std::int64_t from, std::int64_t to) {
  return (from < 0 && to > 0) || (from > 0 && to < 0);
}

/// from / (from - to) of the way from one height to the other.
mpq_class height_between(std::int64_t from, std::int64_t to, double from_z, double to_z) {
  const mpq_class start(mpz_class(static_cast<long>(from))), length(mpz_class(static_cast<long>(from - to)));
  return mpq_class(from_z) + start / length * (mpq_class(to_z) - mpq_class(from_z));
}

}  // namespace

std::optional<std::string> judge_surface(const Terrain& source, const Terrain& result, double tolerance) {
  const auto ours = edges_of(source), theirs = edges_of(result);
  for (const Edge& p : ours) {
    for (const Edge& q : theirs) {
      const std::int64_t from = turn(q.from, q.to, p.from), to = turn(q.from, q.to, p.to);
      if (!is_between(from, to)) continue;
      const std::int64_t start = turn(p.from, p.to, q.from), end = turn(p.from, p.to, q.to);
      if (!is_between(start, end)) continue;
      const mpq_class difference =
          height_between(from, to, p.from_z, p.to_z) - height_between(start, end, q.from_z, q.to_z);
      if (abs(difference) > mpq_class(tolerance))
        return "a crossing is off by " + std::to_string(mpq_class(abs(difference)).get_d());
    }
  }
  return std::nullopt;
}

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
