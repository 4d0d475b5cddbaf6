// A terrain's surface in pieces: each triangle, cut by a region's and freed from voids.
#pragma once

#include <vector>

#include "tin/base/progress.h"
#include "tin/base/result.h"
#include "tin/query/flood.h"
#include "tin/query/region.h"
#include "tin/query/surface.h"
#include "tin/query/voids.h"

namespace tin::query {

inline Convex clip_to_triangle(Convex polygon, Place a, Place b, Place c) {
  polygon = clip(polygon, [&](Place p) { return cross(a, b, p); });
  polygon = clip(polygon, [&](Place p) { return cross(b, c, p); });
  return clip(polygon, [&](Place p) { return cross(c, a, p); });
}

/// Borrows the terrain. One thread.
class Pieces {
 public:
  Pieces(const terrain::Terrain& terrain, const Region* region, Voids voids, base::Progress* progress)
      : terrain_(terrain), region_(region), voids_(terrain, voids), progress_(progress) {}

  /// Calls visit(t, facet, piece, sign) for each piece of a triangle t; those of holes have sign -1 and are
  /// to be taken away. The pieces depend on the set of vertices only, their order does not. Errors:
  /// kCancelled.
  template <class Visit>
  base::Result<void> each(const Visit& visit) {
    const mesh::Mesh& mesh = terrain_.mesh();
    if (mesh.dimension() < 2) return {};
    if (region_ != nullptr) return each_in_region(visit);
    for (std::uint32_t i = 0; i < mesh.triangle_slots(); ++i) {
      const mesh::TriangleSlot t(i);
      if (i % 1024 == 0 && cancelled(static_cast<double>(i) / mesh.triangle_slots())) return stopped();
      if (mesh.is_alive(t) && !mesh.is_infinite(t)) solid(t, facet_triangle(t), 1, visit);
    }
    return {};
  }

 private:
  template <class Visit>
  base::Result<void> each_in_region(const Visit& visit) {
    Flood flood(terrain_);
    const double all = static_cast<double>(region_->outline().size() + region_->holes().size());
    std::size_t done = 0, visited = 0;
    bool stop = false;
    const auto triangles = [&](std::span<const Region::Triangle> parts, double sign) {
      for (const Region::Triangle& part : parts) {
        const Place a = frame::place(part[0]), b = frame::place(part[1]), c = frame::place(part[2]);
        flood.visit(a, b, c, [&](mesh::TriangleSlot t) {
          if (++visited % 1024 == 0) stop = stop || cancelled(static_cast<double>(done) / all);
          if (stop) return;
          const Convex piece = clip_to_triangle(facet_triangle(t), a, b, c);
          if (!piece.empty()) solid(t, piece, sign, visit);
        });
        ++done;
      }
    };
    triangles(region_->outline(), 1);
    triangles(region_->holes(), -1);
    if (stop) return stopped();
    return {};
  }

  template <class Visit>
  void solid(mesh::TriangleSlot t, const Convex& piece, double sign, const Visit& visit) {
    const Slots corners = canonical_corners(terrain_.mesh(), t);
    const Facet facet(terrain_, corners);
    if (!voids_.may_touch(corners)) return visit(t, facet, piece, sign);
    voids_.solid_parts(piece, parts_);
    for (const Convex& part : parts_) visit(t, facet, part, sign);
  }

  Convex facet_triangle(mesh::TriangleSlot t) const {
    const mesh::Mesh& mesh = terrain_.mesh();
    const Slots corners = canonical_corners(mesh, t);
    return triangle(frame::place(mesh.point(corners[0])), frame::place(mesh.point(corners[1])),
                    frame::place(mesh.point(corners[2])));
  }
  bool cancelled(double fraction) {
    if (progress_ == nullptr) return false;
    progress_->report(fraction);
    return progress_->cancelled();
  }
  static base::Error stopped() { return base::error(base::Code::kCancelled, "Stopped on request."); }

  const terrain::Terrain& terrain_;
  const Region* region_;
  VoidMask voids_;
  base::Progress* progress_;
  std::vector<Convex> parts_;
};

}  // namespace tin::query
