// A mesh as a sorted list of triangles by coordinates: equal lists mean the same triangulation.
#pragma once

#include <algorithm>
#include <array>
#include <vector>

#include "tin/mesh/mesh.h"

namespace support {

using Corners = std::array<tin::exact::Point, 3>;

/// Rotates the smallest corner to the front; keeps the turn.
inline Corners canonical(Corners c) {
  std::rotate(c.begin(), std::min_element(c.begin(), c.end()), c.end());
  return c;
}

inline std::vector<Corners> triangles(const tin::mesh::Mesh& mesh) {
  std::vector<Corners> out;
  if (mesh.dimension() < 2) return out;
  for (std::uint32_t i = 0; i < mesh.triangle_slots(); ++i) {
    const tin::mesh::TriangleSlot t(i);
    if (!mesh.is_alive(t) || mesh.is_infinite(t)) continue;
    const auto& v = mesh.triangle(t).vertices;
    out.push_back(canonical({mesh.point(v[0]), mesh.point(v[1]), mesh.point(v[2])}));
  }
  std::sort(out.begin(), out.end());
  return out;
}

}  // namespace support
