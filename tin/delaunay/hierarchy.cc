#include "tin/delaunay/hierarchy.h"

#include <algorithm>

#include "tin/base/check.h"
#include "tin/delaunay/bulk.h"

namespace tin::delaunay {

using exact::Point;
using mesh::kInfinite;
using mesh::kNone;
using mesh::Mesh;
using mesh::VertexSlot;

namespace {

double squared_length(const Corner& c) {
  const auto x = static_cast<double>(c.x), y = static_cast<double>(c.y);
  return x * x + y * y;
}

VertexSlot nearest_corner(const Stop& stop) {
  const Corner* best = &stop.a;
  if (squared_length(stop.b) < squared_length(*best)) best = &stop.b;
  if (stop.kind == Stop::Kind::kInside && squared_length(stop.c) < squared_length(*best)) best = &stop.c;
  return best->vertex;
}

}  // namespace

/// The vertex of a level nearest to where a walk to `p` stops. `from`: a vertex to start at, or kNone.
Hierarchy::Found Hierarchy::find(const Mesh& mesh, Point p, VertexSlot from, std::uint64_t& steps) {
  if (mesh.dimension() < 2) {
    const auto line = mesh.line();
    if (line.empty()) return {VertexSlot(kNone), false};
    const auto at = std::lower_bound(line.begin(), line.end(), p,
                                     [&](VertexSlot v, Point q) { return mesh.point(v) < q; });
    const VertexSlot v = at == line.end() ? line.back() : *at;
    return {v, mesh.point(v) == p};
  }
  const auto start = mesh.triangle_at(from.value() == kNone ? kInfinite : from);
  const Stop stop = walk(mesh, p, finite_start(mesh, start), Everywhere{});
  steps += stop.steps;
  const VertexSlot v = nearest_corner(stop);
  return {v, mesh.point(v) == p};
}

template <class Visit>
VertexSlot Hierarchy::descend(Point p, std::uint64_t& steps, const Visit& visit) const {
  VertexSlot v{kNone};
  for (std::size_t k = levels_.size(); k-- > 0;) {
    const Found found = find(levels_[k].layer.mesh(), p, v, steps);
    visit(k, found);
    v = found.vertex.value() == kNone ? found.vertex : levels_[k].below[found.vertex.value()];
  }
  return v;
}

VertexSlot Hierarchy::near(Point p, std::uint64_t& steps) const {
  return descend(p, steps, [](std::size_t, const Found&) {});
}

void Hierarchy::add_to_levels(Point p, VertexSlot slot, std::size_t height) {
  if (levels_.size() < height) levels_.resize(height);
  std::vector<VertexSlot> nearest(levels_.size());
  std::uint64_t steps = 0;
  descend(p, steps, [&](std::size_t k, const Found& found) { nearest[k] = found.vertex; });
  VertexSlot below = slot;
  for (std::size_t k = 0; k < height; ++k) {
    auto& [layer, below_of] = levels_[k];
    const Mesh& mesh = layer.mesh();
    const auto start = [&] { return finite_start(mesh, mesh.triangle_at(nearest[k])); };
    const auto [v, fresh] = mesh.dimension() < 2 ? layer.insert_below_plane(p)
                                                 : layer.insert(p, walk(mesh, p, start(), Everywhere{}));
    TIN_CHECK(fresh);
    if (v.value() >= below_of.size()) below_of.resize(v.value() + 1);
    below_of[v.value()] = below;
    below = v;
  }
}

void Hierarchy::remove_from_levels(Point p, std::size_t height) {
  std::vector<VertexSlot> gone(height);
  std::uint64_t steps = 0;
  descend(p, steps, [&](std::size_t k, const Found& found) {
    if (k >= height) return;
    TIN_CHECK(found.exact);
    gone[k] = found.vertex;
  });
  for (std::size_t k = 0; k < height; ++k) levels_[k].layer.remove(gone[k]);
}

void Hierarchy::build(const Mesh& base) {
  levels_.clear();
  const Mesh* lower = &base;
  for (std::size_t height = 1;; ++height) {
    Level level;
    level.below.assign(1, kInfinite);
    for (std::uint32_t i = 1; i < lower->vertex_slots(); ++i) {
      if (height_of(lower->point(VertexSlot(i))) >= height) level.below.push_back(VertexSlot(i));
    }
    const std::size_t count = level.below.size() - 1;
    if (count == 0) return;
    Mesh& mesh = level.layer.mutable_mesh();
    mesh.begin_bulk(count);
    for (std::uint32_t i = 1; i <= count; ++i) mesh.set_point(VertexSlot(i), lower->point(level.below[i]));
    build_bulk(mesh, 1, nullptr);
    levels_.push_back(std::move(level));
    lower = &levels_.back().layer.mesh();
  }
}

void Hierarchy::renumber(const std::vector<VertexSlot>& new_of_old) {
  if (levels_.empty()) return;
  Level& lowest = levels_[0];
  for (std::uint32_t i = 1; i < lowest.layer.mesh().vertex_slots(); ++i) {
    if (lowest.layer.mesh().is_alive(VertexSlot(i))) lowest.below[i] = new_of_old[lowest.below[i].value()];
  }
}

std::size_t Hierarchy::bytes() const {
  std::size_t sum = levels_.capacity() * sizeof(Level);
  for (const Level& level : levels_)
    sum += level.layer.mesh().bytes() + level.below.capacity() * sizeof(VertexSlot);
  return sum;
}

}  // namespace tin::delaunay
