#include "tin/query/segment_walk.h"

#include <algorithm>

#include "tin/exact/predicates.h"
#include "tin/query/surface.h"

namespace tin::query {

using delaunay::Location;
using exact::orientation;
using exact::Point;
using mesh::HalfEdge;
using mesh::next3;
using mesh::prev3;
using mesh::TriangleSlot;
using mesh::VertexSlot;

struct SegmentWalk::Step {
  enum class Kind { kEnd, kAtVertex, kAcross };
  Kind kind = Kind::kEnd;
  VertexSlot vertex{mesh::kNone};
  HalfEdge edge;  // of the triangle that is entered
};

namespace {

std::int64_t dot(Point o, Point a, Point b) {
  return (std::int64_t{a.x} - o.x) * (std::int64_t{b.x} - o.x) +
         (std::int64_t{a.y} - o.y) * (std::int64_t{b.y} - o.y);
}

}  // namespace

void SegmentWalk::stations(Point p, Point q, std::vector<Station>& out) {
  out.clear();
  out_ = &out;
  p_ = p;
  q_ = q;
  if (mesh_.dimension() < 2) return on_line();
  const auto& triangulation = terrain_.triangulation();
  // Triangles may have come and gone since the last walk only if the caller broke his promise not to edit.
  const Location where =
      last_.value() == mesh::kNone ? triangulation.locate(p) : triangulation.locate_from(p, last_);
  last_ = where.triangle;
  for (Step step = start(where); step.kind != Step::Kind::kEnd;) {
    step = step.kind == Step::Kind::kAtVertex ? from_vertex(step.vertex) : into(step.edge);
  }
  out_ = nullptr;
}

SegmentWalk::Step SegmentWalk::start(const Location& where) {
  if (where.kind == Location::Kind::kOutsideHull) return p_ == q_ ? Step{} : enter_hull(where.triangle);
  if (where.kind == Location::Kind::kOnVertex) return {Step::Kind::kAtVertex, where.vertex, {}};
  add_point(p_, elevation_.at(p_)->z);
  out_->back().to_next = where.triangle;
  if (p_ == q_) return {};
  if (where.kind == Location::Kind::kOnEdge) return from_edge(HalfEdge(where.triangle, where.index));
  return from_inside(where.triangle);
}

/// Over the hull edge that has p on its far side and the line through it, or at one of its ends.
SegmentWalk::Step SegmentWalk::enter_hull(TriangleSlot outside) {
  TriangleSlot t = outside;
  do {
    const int infinite = mesh_.index_of(t, mesh::kInfinite);
    const HalfEdge edge = mesh_.twin(t, infinite);  // the hull is to its left
    const VertexSlot from = mesh_.origin(edge), to = mesh_.destination(edge);
    const Point f = mesh_.point(from), g = mesh_.point(to);
    const std::int64_t side_f = orientation(p_, q_, f), side_g = orientation(p_, q_, g);
    if (side_f >= 0 && side_g <= 0 && orientation(f, g, p_) < 0) {
      if (side_f == 0) return reaches(f) ? Step{Step::Kind::kAtVertex, from, {}} : Step{};
      if (side_g == 0) return reaches(g) ? Step{Step::Kind::kAtVertex, to, {}} : Step{};
      const std::int64_t goal = orientation(f, g, q_);
      if (goal < 0) return {};
      if (goal == 0) return end_in(edge.triangle());
      add_crossing(edge);
      return {Step::Kind::kAcross, {}, edge};
    }
    t = mesh_.twin(t, next3(infinite)).triangle();
  } while (t != outside);
  return {};
}

SegmentWalk::Step SegmentWalk::from_vertex(VertexSlot v) {
  const Point at = mesh_.point(v);
  add_point(at, terrain_.z(v));
  if (at == q_) return {};
  const TriangleSlot first = mesh_.triangle_at(v);
  TriangleSlot t = first;
  do {
    const int i = mesh_.index_of(t, v);
    if (!mesh_.is_infinite(t)) {
      const VertexSlot b = mesh_.vertex(t, next3(i)), c = mesh_.vertex(t, prev3(i));
      const std::int64_t side_b = orientation(at, mesh_.point(b), q_),
                         side_c = orientation(at, mesh_.point(c), q_);
      if (side_b == 0 && ahead(at, mesh_.point(b))) return along_edge(HalfEdge(t, prev3(i)), b);
      if (side_c == 0 && ahead(at, mesh_.point(c))) return along_edge(HalfEdge(t, next3(i)), c);
      if (side_b > 0 && side_c < 0) return out_of(HalfEdge(t, i));
    }
    t = mesh_.twin(t, next3(i)).triangle();
  } while (t != first);
  return {};
}

SegmentWalk::Step SegmentWalk::from_edge(HalfEdge edge) {
  const VertexSlot from = mesh_.origin(edge), to = mesh_.destination(edge);
  const std::int64_t side = orientation(mesh_.point(from), mesh_.point(to), q_);
  if (side == 0) return along_edge(edge, ahead(p_, mesh_.point(to)) ? to : from);
  const HalfEdge entered = side > 0 ? edge : mesh_.twin(edge);
  return mesh_.is_infinite(entered.triangle()) ? Step{} : into(entered);
}

SegmentWalk::Step SegmentWalk::from_inside(TriangleSlot t) {
  if (holds_goal(t)) return end_in(t);
  for (int i = 0; i < 3; ++i) {
    const Point v = mesh_.point(mesh_.vertex(t, i));
    if (orientation(p_, q_, v) == 0 && ahead(p_, v)) return {Step::Kind::kAtVertex, mesh_.vertex(t, i), {}};
  }
  for (int i = 0; i < 3; ++i) {
    const HalfEdge edge(t, i);
    if (orientation(p_, q_, mesh_.point(mesh_.origin(edge))) < 0 &&
        orientation(p_, q_, mesh_.point(mesh_.destination(edge))) > 0) {
      return out_of(edge);
    }
  }
  TIN_CHECK(false);
}

/// On the edge, towards one of its ends.
SegmentWalk::Step SegmentWalk::along_edge(HalfEdge edge, VertexSlot to) {
  const bool owner = owns_edge(mesh_, edge.triangle(), edge.index());
  const TriangleSlot t = owner ? edge.triangle() : mesh_.twin(edge).triangle();
  if (!reaches(mesh_.point(to))) return end_in(t);
  out_->back().to_next = t;
  return {Step::Kind::kAtVertex, to, {}};
}

/// In the triangle behind `edge`, which the line has crossed from outside, between its ends.
SegmentWalk::Step SegmentWalk::into(HalfEdge edge) {
  const TriangleSlot t = edge.triangle();
  out_->back().to_next = t;
  const VertexSlot apex = mesh_.apex(edge);
  const std::int64_t side = orientation(p_, q_, mesh_.point(apex));
  if (side == 0) {
    return reaches(mesh_.point(apex)) ? Step{Step::Kind::kAtVertex, apex, {}} : end_in(t);
  }
  // The edge's origin is to the left of the line, its destination to the right.
  return out_of(HalfEdge(t, side > 0 ? next3(edge.index()) : prev3(edge.index())));
}

/// Over an edge of the triangle that the line is in, between its ends, unless the goal comes before.
SegmentWalk::Step SegmentWalk::out_of(HalfEdge edge) {
  if (orientation(mesh_.point(mesh_.origin(edge)), mesh_.point(mesh_.destination(edge)), q_) >= 0) {
    return end_in(edge.triangle());
  }
  out_->back().to_next = edge.triangle();
  add_crossing(edge);
  const HalfEdge beyond = mesh_.twin(edge);
  if (mesh_.is_infinite(beyond.triangle())) return {};
  last_ = beyond.triangle();
  return {Step::Kind::kAcross, {}, beyond};
}

SegmentWalk::Step SegmentWalk::end_in(TriangleSlot t) {
  if (!out_->empty()) out_->back().to_next = t;
  add_point(q_, elevation_.at(q_)->z);
  return {};
}

bool SegmentWalk::holds_goal(TriangleSlot t) const {
  for (int i = 0; i < 3; ++i) {
    const HalfEdge edge(t, i);
    if (orientation(mesh_.point(mesh_.origin(edge)), mesh_.point(mesh_.destination(edge)), q_) < 0)
      return false;
  }
  return true;
}

/// Of a point on the line: whether it lies in the goal's direction from `from`.
bool SegmentWalk::ahead(Point from, Point v) const {
  return dot(from, q_, v) > 0;
}

/// Of a point on the line: whether it comes after p and not after q.
bool SegmentWalk::reaches(Point v) const {
  return dot(p_, q_, v) > 0 && dot(q_, p_, v) >= 0;
}

void SegmentWalk::add(double along, frame::Place at, double z) {
  // Two quotients of neighbouring crossings may be rounded the wrong way around.
  if (!out_->empty()) along = std::max(along, out_->back().along);
  out_->push_back({std::clamp(along, 0.0, 1.0), at, z, TriangleSlot(mesh::kNone)});
}

void SegmentWalk::add_point(Point at, double z) {
  const std::int64_t dx = std::int64_t{q_.x} - p_.x, dy = std::int64_t{q_.y} - p_.y;
  double along = 0;
  if (std::abs(dx) >= std::abs(dy)) {
    if (dx != 0) along = static_cast<double>(std::int64_t{at.x} - p_.x) / static_cast<double>(dx);
  } else {
    along = static_cast<double>(std::int64_t{at.y} - p_.y) / static_cast<double>(dy);
  }
  add(along, frame::place(at), z);
}

void SegmentWalk::add_crossing(HalfEdge edge) {
  VertexSlot u = mesh_.origin(edge), v = mesh_.destination(edge);
  if (mesh_.point(v) < mesh_.point(u)) std::swap(u, v);
  const Point a = mesh_.point(u), b = mesh_.point(v);
  const std::int64_t side_p = orientation(a, b, p_), side_q = orientation(a, b, q_);
  const std::int64_t side_a = orientation(p_, q_, a), side_b = orientation(p_, q_, b);
  const double along = static_cast<double>(side_p) / static_cast<double>(side_p - side_q);
  const double part = static_cast<double>(side_a) / static_cast<double>(side_a - side_b);
  const frame::Place at{a.x + part * (static_cast<double>(b.x) - a.x),
                        a.y + part * (static_cast<double>(b.y) - a.y)};
  add(along, at, terrain_.z(u) + part * (terrain_.z(v) - terrain_.z(u)));
}

void SegmentWalk::on_line() {
  const auto line = mesh_.line();
  if (line.empty()) return;
  const Point first = mesh_.point(line.front()), last = mesh_.point(line.back());
  const auto add_if_on_line = [this](Point at) {
    if (const auto found = elevation_.at(at)) add_point(at, found->z);
  };
  add_if_on_line(p_);
  if (p_ == q_) return;
  if (line.size() == 1 || (orientation(first, last, p_) == 0 && orientation(first, last, q_) == 0)) {
    std::vector<Point> between;
    for (const VertexSlot v : line) {
      const Point at = mesh_.point(v);
      if (orientation(p_, q_, at) == 0 && reaches(at) && at != q_) between.push_back(at);
    }
    if (q_ < p_) std::reverse(between.begin(), between.end());
    for (const Point at : between) add_if_on_line(at);
  }
  add_if_on_line(q_);
}

}  // namespace tin::query
