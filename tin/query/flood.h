// All triangles of a mesh that meet a given one.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "tin/frame/ground.h"
#include "tin/query/convex.h"
#include "tin/terrain/terrain.h"

namespace tin::query {

/// Floods from a triangle at a corner (or where the hull is entered) over every edge that comes within a step
/// of the given triangle: that is connected, since both the triangle and the hull are convex. So none that
/// overlaps it is missed, and some are visited that only come near. Borrows the terrain. One thread.
class Flood {
 public:
  explicit Flood(const terrain::Terrain& terrain) : terrain_(terrain), mesh_(terrain.mesh()) {
    seen_.resize(mesh_.triangle_slots());
  }

  /// Calls visit(t) once for each finite triangle that overlaps a, b, c, which are in lattice steps of the
  /// terrain but need not be lattice points, and turn counter-clockwise. Cost: O(visited), and the hull's
  /// size where the triangle lies across it with no corner inside.
  template <class Visit>
  void visit(Place a, Place b, Place c, const Visit& visit) {
    const Corners corners{a, b, c};
    if (mesh_.dimension() < 2 || !seed(corners)) return;
    while (!to_visit_.empty()) {
      const mesh::TriangleSlot t = to_visit_.back();
      to_visit_.pop_back();
      visit(t);
      spread(t, corners);
    }
  }

 private:
  using Corners = std::array<Place, 3>;

  bool seed(const Corners& corners);
  bool seed_on_hull(const Corners& corners);
  void spread(mesh::TriangleSlot t, const Corners& corners);
  void push(mesh::TriangleSlot t);

  const terrain::Terrain& terrain_;
  const mesh::Mesh& mesh_;
  std::vector<std::uint32_t> seen_;  // by triangle: the call that saw it last
  std::uint32_t call_ = 0;
  std::vector<mesh::TriangleSlot> to_visit_;
  mesh::TriangleSlot last_{mesh::kNone};
};

}  // namespace tin::query
