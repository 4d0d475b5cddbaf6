#include "tin/delaunay/layer.h"

#include <algorithm>

#include "tin/base/check.h"
#include "tin/exact/predicates.h"

namespace tin::delaunay {

using exact::orientation;
using exact::Point;
using mesh::HalfEdge;
using mesh::kInfinite;
using mesh::TriangleSlot;
using mesh::VertexSlot;

Layer::Inserted Layer::insert(Point p, const Stop& stop) {
  VertexSlot there;
  if (at_vertex(stop, there)) return {there, false};
  cavity_.carve(mesh_, p, stop, Everywhere{});
  // Slots near those around: what is near on the ground stays near in memory.
  const VertexSlot v = mesh_.add_vertex(p, stop.b.vertex);
  const TriangleSlot extra = mesh_.claim_triangle(cavity_.some_triangle());
  cavity_.fill(mesh_, v, extra, mesh_.claim_triangle(extra));
  fresh_.assign(cavity_.star().begin(), cavity_.star().end());
  return {v, true};
}

Layer::Inserted Layer::insert_below_plane(Point p) {
  fresh_.clear();
  auto& line = mesh_.mutable_line();
  const auto at = std::lower_bound(line.begin(), line.end(), p,
                                   [this](VertexSlot v, Point q) { return mesh_.point(v) < q; });
  if (at != line.end() && mesh_.point(*at) == p) return {*at, false};
  const bool leaves_line =
      line.size() >= 2 && orientation(mesh_.point(line.front()), mesh_.point(line.back()), p) != 0;
  const VertexSlot v = mesh_.add_vertex(p);
  if (leaves_line) {
    raise_to_plane(v);
  } else {
    line.insert(at, v);
  }
  return {v, true};
}

/// The first vertex off the line: a fan from it over the line, and infinite triangles around.
void Layer::raise_to_plane(VertexSlot apex) {
  std::vector<VertexSlot> line;
  line.swap(mesh_.mutable_line());
  if (orientation(mesh_.point(line[0]), mesh_.point(line[1]), mesh_.point(apex)) < 0)
    std::reverse(line.begin(), line.end());
  // Triangles (inf, b, a) over the hull edges a -> b, counter-clockwise: along the line, then line.back() ->
  // apex -> line[0].
  for (std::size_t i = 0; i + 1 < line.size(); ++i) {
    const TriangleSlot inner = mesh_.add_triangle(line[i], line[i + 1], apex);
    const TriangleSlot outer = mesh_.add_triangle(kInfinite, line[i + 1], line[i]);
    mesh_.join(HalfEdge(inner, 2), HalfEdge(outer, 0));
    fresh_.push_back(inner);
    fresh_.push_back(outer);
    if (i == 0) continue;
    mesh_.join(HalfEdge(fresh_[fresh_.size() - 4], 0), HalfEdge(inner, 1));
    mesh_.join(HalfEdge(outer, 1), HalfEdge(fresh_[fresh_.size() - 3], 2));
  }
  const TriangleSlot first_inner = fresh_[0], first_outer = fresh_[1];
  const TriangleSlot last_inner = fresh_[fresh_.size() - 2], last_outer = fresh_[fresh_.size() - 1];
  const TriangleSlot up = mesh_.add_triangle(kInfinite, apex, line.back());
  const TriangleSlot down = mesh_.add_triangle(kInfinite, line.front(), apex);
  mesh_.join(HalfEdge(last_inner, 0), HalfEdge(up, 0));
  mesh_.join(HalfEdge(first_inner, 1), HalfEdge(down, 0));
  mesh_.join(HalfEdge(first_outer, 1), HalfEdge(down, 2));
  mesh_.join(HalfEdge(down, 1), HalfEdge(up, 2));
  mesh_.join(HalfEdge(up, 1), HalfEdge(last_outer, 2));
  fresh_.push_back(up);
  fresh_.push_back(down);
}

void Layer::remove(VertexSlot v) {
  TIN_DCHECK(v != kInfinite && mesh_.is_alive(v));
  if (mesh_.dimension() < 2) {
    fresh_.clear();
    std::erase(mesh_.mutable_line(), v);
    mesh_.release_vertex(v);
    return;
  }
  if (!remover_.remove(mesh_, v, fresh_)) drop_to_line(v);
}

/// All vertices but `gone` are collinear: they become a line again.
void Layer::drop_to_line(VertexSlot gone) {
  mesh_.clear_triangles();
  mesh_.release_vertex(gone);
  auto& line = mesh_.mutable_line();
  line.clear();
  for (std::uint32_t i = 1; i < mesh_.vertex_slots(); ++i) {
    if (mesh_.is_alive(VertexSlot(i))) line.push_back(VertexSlot(i));
  }
  std::sort(line.begin(), line.end(),
            [this](VertexSlot a, VertexSlot b) { return mesh_.point(a) < mesh_.point(b); });
}

}  // namespace tin::delaunay
