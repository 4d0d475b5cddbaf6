#include "tin/delaunay/start_grid.h"

#include <algorithm>

namespace tin::delaunay {

using exact::Point;
using mesh::kInfinite;
using mesh::kNone;
using mesh::Mesh;
using mesh::TriangleSlot;
using mesh::VertexSlot;

namespace {

constexpr std::size_t kVerticesPerCell = 2;
constexpr std::uint8_t kCrowd = 64;                // vertices in a cell from which on the hierarchy is the quicker way
constexpr std::uint32_t kCrowded = kNone - 1;      // in a cell without a hint

template <class F>
void each_vertex(const Mesh& mesh, const F& f) {
  for (std::uint32_t i = 1; i < mesh.vertex_slots(); ++i) {
    if (mesh.is_alive(VertexSlot(i))) f(VertexSlot(i));
  }
}

}  // namespace

std::size_t StartGrid::cell(Point p) const {
  const auto clamp = [this](std::int64_t offset, std::uint32_t count) {
    return static_cast<std::size_t>(std::clamp<std::int64_t>(offset >> shift_, 0, std::int64_t{count} - 1));
  };
  return clamp(std::int64_t{p.y} - low_.y, rows_) * columns_ + clamp(std::int64_t{p.x} - low_.x, columns_);
}

void StartGrid::remember(const Mesh& mesh, Point p, TriangleSlot t) {
  if (outdated(mesh)) rebuild(mesh);
  if (hints_.empty()) return;
  std::uint32_t& hint = hints_[cell(p)];
  if (hint != kCrowded) hint = t.value();
}

void StartGrid::give_up(Point p) {
  if (!hints_.empty()) hints_[cell(p)] = kCrowded;
}

/// Lays square cells over the vertices' extent.
void StartGrid::fit(const Mesh& mesh) {
  Point low{exact::kLatticeHalf, exact::kLatticeHalf}, high{-exact::kLatticeHalf, -exact::kLatticeHalf};
  each_vertex(mesh, [&](VertexSlot v) {
    const Point p = mesh.point(v);
    low = {std::min(low.x, p.x), std::min(low.y, p.y)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y)};
  });
  const auto width = static_cast<std::uint64_t>(std::int64_t{high.x} - low.x);
  const auto height = static_cast<std::uint64_t>(std::int64_t{high.y} - low.y);
  const std::size_t cells = std::max<std::size_t>(1, mesh.vertex_count() / kVerticesPerCell);
  low_ = low;
  shift_ = 0;
  while (((width >> shift_) + 1) * ((height >> shift_) + 1) > cells) ++shift_;
  columns_ = static_cast<std::uint32_t>((width >> shift_) + 1);
  rows_ = static_cast<std::uint32_t>((height >> shift_) + 1);
}

void StartGrid::rebuild(const Mesh& mesh) {
  outgrown_at_ = std::max<std::size_t>(16, 2 * mesh.vertex_count());
  too_large_at_ = mesh.vertex_count() / 4;
  hints_.clear();
  if (mesh.dimension() < 2) return;
  fit(mesh);
  hints_.assign(std::size_t{columns_} * rows_, kNone);
  each_vertex(mesh, [&](VertexSlot v) { hints_[cell(mesh.point(v))] = mesh.triangle_at(v).value(); });
  // Empty cells take over the hint before them: near enough where cells are empty by chance.
  std::uint32_t last = kNone;
  for (std::uint32_t& hint : hints_) last = hint = hint == kNone ? last : hint;
  mark_crowded_cells(mesh);
}

void StartGrid::mark_crowded_cells(const Mesh& mesh) {
  std::vector<std::uint8_t> count(hints_.size(), 0);
  each_vertex(mesh, [&](VertexSlot v) {
    const std::size_t c = cell(mesh.point(v));
    if (count[c] < kCrowd) ++count[c];
  });
  for (std::size_t c = 0; c < count.size(); ++c) {
    if (count[c] == kCrowd) hints_[c] = kCrowded;
  }
}

TriangleSlot StartGrid::near(const Mesh& mesh, Point p) const {
  const TriangleSlot none{kNone};
  if (hints_.empty()) return none;
  const TriangleSlot t{hints_[cell(p)]};
  if (t.value() >= mesh.triangle_slots() || !mesh.is_alive(t)) return none;
  const auto& vertices = mesh.triangle(t).vertices;
  const Point q = mesh.point(vertices[0] == kInfinite ? vertices[1] : vertices[0]);
  const std::int64_t reach = std::int64_t{4} << shift_;
  const std::int64_t dx = std::int64_t{p.x} - q.x, dy = std::int64_t{p.y} - q.y;
  return std::max(dx, -dx) <= reach && std::max(dy, -dy) <= reach ? t : none;
}

}  // namespace tin::delaunay
