#include "tin/query/natural_neighbours.h"

#include <algorithm>

#include "tin/exact/predicates.h"

namespace tin::query {

using exact::Int128;
using exact::orientation;
using exact::Point;
using mesh::HalfEdge;
using mesh::TriangleSlot;
using mesh::VertexSlot;

namespace {

// x87's 64 bits of mantissa: where a cell is long and thin its corners lie far out, and areas are small
// differences.
struct Corner {
  long double x, y;
};

struct Vector {
  std::int64_t x, y;
};

Vector between(Point from, Point to) {
  return {std::int64_t{to.x} - from.x, std::int64_t{to.y} - from.y};
}

/// The circumcentre of the origin, u and v, which are not collinear with it.
Corner centre_with_origin(Vector u, Vector v) {
  const std::int64_t uu = u.x * u.x + u.y * u.y, vv = v.x * v.x + v.y * v.y;
  const Int128 x = Int128{uu} * v.y - Int128{vv} * u.y, y = Int128{vv} * u.x - Int128{uu} * v.x;
  const auto twice = 2 * static_cast<long double>(u.x * v.y - u.y * v.x);
  return {static_cast<long double>(x) / twice, static_cast<long double>(y) / twice};
}

/// The circumcentre of a triangle, seen from p.
Corner centre(Point p, Point a, Point b, Point c) {
  const Corner from_a = centre_with_origin(between(a, b), between(a, c));
  const Vector offset = between(p, a);
  return {from_a.x + static_cast<long double>(offset.x), from_a.y + static_cast<long double>(offset.y)};
}

}  // namespace

std::span<const NaturalNeighbours::Weight> NaturalNeighbours::at(Point p, TriangleSlot t) {
  weights_.clear();
  if (at_corner_or_hull(p, t)) return weights_;
  carve(p, t);
  double sum = 0;
  for (std::size_t i = 0; i < rim_.size(); ++i) {
    const HalfEdge before = rim_[i == 0 ? rim_.size() - 1 : i - 1];
    const double area = stolen(p, before, rim_[i]);
    weights_.push_back({mesh_.origin(rim_[i]), area});
    sum += area;
  }
  for (Weight& w : weights_) w.weight /= sum;
  return weights_;
}

bool NaturalNeighbours::at_corner_or_hull(Point p, TriangleSlot t) {
  for (int i = 0; i < 3; ++i) {
    const VertexSlot v = mesh_.vertex(t, i);
    if (mesh_.point(v) != p) continue;
    weights_.push_back({v, 1});
    return true;
  }
  for (int i = 0; i < 3; ++i) {
    if (!mesh_.is_infinite(mesh_.twin(t, i).triangle())) continue;
    VertexSlot u = mesh_.vertex(t, mesh::next3(i)), v = mesh_.vertex(t, mesh::prev3(i));
    if (orientation(mesh_.point(u), mesh_.point(v), p) != 0) continue;
    if (mesh_.point(v) < mesh_.point(u)) std::swap(u, v);
    const Vector whole = between(mesh_.point(u), mesh_.point(v)), part = between(mesh_.point(u), p);
    const double along = whole.x != 0 ? static_cast<double>(part.x) / static_cast<double>(whole.x)
                                      : static_cast<double>(part.y) / static_cast<double>(whole.y);
    weights_.push_back({u, 1 - along});
    weights_.push_back({v, along});
    return true;
  }
  return false;
}

/// The triangles that an insertion of `p` would replace form a tree by adjacency, since no vertex is inside:
/// walking around it in order gives their outline in order.
void NaturalNeighbours::carve(Point p, TriangleSlot t) {
  rim_.clear();
  for (int i = 0; i < 3; ++i) expand(p, HalfEdge(t, i));
  const auto smaller = [this](HalfEdge a, HalfEdge b) {
    return mesh_.point(mesh_.origin(a)) < mesh_.point(mesh_.origin(b));
  };
  std::rotate(rim_.begin(), std::min_element(rim_.begin(), rim_.end(), smaller), rim_.end());
}

void NaturalNeighbours::expand(Point p, HalfEdge start) {
  to_cross_.assign(1, start);
  while (!to_cross_.empty()) {
    const HalfEdge edge = to_cross_.back(), beyond = mesh_.twin(edge);
    to_cross_.pop_back();
    const TriangleSlot t = beyond.triangle();
    const auto& v = mesh_.triangle(t).vertices;
    const bool makes_way =
        !mesh_.is_infinite(t) && exact::in_circle(mesh_.point(v[0]), mesh_.point(v[1]), mesh_.point(v[2]), p);
    if (!makes_way) {
      rim_.push_back(edge);
      continue;
    }
    // Counter-clockwise after the edge just crossed; the last in is the first out.
    to_cross_.push_back(HalfEdge(t, mesh::prev3(beyond.index())));
    to_cross_.push_back(HalfEdge(t, mesh::next3(beyond.index())));
  }
}

/// The area that p's cell takes from that of the vertex between two edges of the rim: the old cell's corners
/// around the vertex, from the triangle behind `after` to that behind `before`, and the new ones between p
/// and the vertex.
double NaturalNeighbours::stolen(Point p, HalfEdge before, HalfEdge after) const {
  const VertexSlot v = mesh_.origin(after);
  const auto from_p = [&](VertexSlot w) { return between(p, mesh_.point(w)); };
  const Corner first = centre_with_origin(from_p(v), from_p(mesh_.destination(after)));
  long double twice = 0;
  Corner last{0, 0};  // relative to `first`
  const auto add = [&](Corner c) {
    const Corner next{c.x - first.x, c.y - first.y};
    twice += last.x * next.y - last.y * next.x;
    last = next;
  };
  for (TriangleSlot t = after.triangle();;) {
    const int i = mesh_.index_of(t, v);
    add(centre(p, mesh_.point(v), mesh_.point(mesh_.vertex(t, mesh::next3(i))),
               mesh_.point(mesh_.vertex(t, mesh::prev3(i)))));
    if (t == before.triangle()) break;
    t = mesh_.twin(t, mesh::next3(i)).triangle();
  }
  add(centre_with_origin(from_p(mesh_.origin(before)), from_p(v)));
  return static_cast<double>(twice / 2);
}

}  // namespace tin::query
