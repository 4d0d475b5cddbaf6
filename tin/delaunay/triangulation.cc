#include "tin/delaunay/triangulation.h"

#include "tin/base/check.h"

namespace tin::delaunay {

using exact::Point;
using mesh::kInfinite;
using mesh::kNone;
using mesh::TriangleSlot;
using mesh::VertexSlot;

Triangulation::Inserted Triangulation::insert(Point p) {
  if (mesh().dimension() < 2) return insert_at(p, {});
  std::uint64_t steps = 0;
  Stop stop = find_from_hint(p, steps);
  if (stop.kind == Stop::Kind::kGaveUp) {
    if (steps >= kPatience) grid_.give_up(p);
    stop = find_from_top(p, steps);
  }
  return insert_at(p, stop);
}

Triangulation::Inserted Triangulation::insert_near(Point p, VertexSlot hint) {
  if (mesh().dimension() < 2) return insert_at(p, {});
  return insert_at(p, walk(mesh(), p, finite_start(mesh(), mesh().triangle_at(hint)), Everywhere{}));
}

/// Inserts where a walk stopped; below dimension 2 there is no walk.
Triangulation::Inserted Triangulation::insert_at(Point p, const Stop& stop) {
  const Inserted inserted = mesh().dimension() < 2 ? base_.insert_below_plane(p) : base_.insert(p, stop);
  if (!inserted.fresh) return inserted;
  if (mesh().dimension() == 2) grid_.remember(mesh(), p, mesh().triangle_at(inserted.vertex));
  hierarchy_.add(p, inserted.vertex);
  return inserted;
}

void Triangulation::remove(VertexSlot v) {
  TIN_DCHECK(v != kInfinite && mesh().is_alive(v));
  mesh().prefetch(v);
  mesh().prefetch_around(TriangleSlot(2 * v.value()));
  hierarchy_.remove(mesh().point(v));
  base_.remove(v);
  refresh_grid();
}

void Triangulation::refresh_grid() {
  if (grid_.outdated(mesh())) grid_.rebuild(mesh());
}

Stop Triangulation::find(Point p, std::uint64_t& steps) const {
  const Stop stop = find_from_hint(p, steps);
  return stop.kind == Stop::Kind::kGaveUp ? find_from_top(p, steps) : stop;
}

/// Gives up when the grid has no hint, or after so many steps that the hierarchy is the better way.
Stop Triangulation::find_from_hint(Point p, std::uint64_t& steps) const {
  const TriangleSlot hint = grid_.near(mesh(), p);
  if (hint.value() == kNone) {
    Stop none{};
    none.kind = Stop::Kind::kGaveUp;
    return none;
  }
  const Stop stop = walk(mesh(), p, finite_start(mesh(), hint), Everywhere{}, kPatience);
  steps += stop.steps;
  return stop;
}

Stop Triangulation::find_from_top(Point p, std::uint64_t& steps) const {
  const VertexSlot near = hierarchy_.near(p, steps);
  const TriangleSlot start = mesh().triangle_at(near.value() == kNone ? kInfinite : near);
  const Stop stop = walk(mesh(), p, finite_start(mesh(), start), Everywhere{});
  steps += stop.steps;
  return stop;
}

}  // namespace tin::delaunay
