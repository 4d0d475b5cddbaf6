#include "tin/delaunay/start_grid.h"

#include <algorithm>
#include <cmath>

namespace tin::delaunay {

using exact::Point;
using mesh::kInfinite;
using mesh::kNone;
using mesh::Mesh;
using mesh::TriangleSlot;
using mesh::VertexSlot;

namespace {

constexpr double kVerticesPerCell = 1.5;  // finer is hardly quicker, and keeps no 72 bytes per vertex
constexpr std::uint8_t kCrowd = 64;       // vertices in a cell from which on the hierarchy is the quicker way
constexpr std::uint32_t kCrowded = kNone - 1;      // in a cell without a hint

/// Calls f for each of `count` vertices: all slots, or else the alive ones.
template <class F>
void each_vertex(const Mesh& mesh, std::size_t count, const F& f) {
  const bool all = count + 1 == mesh.vertex_slots();
  for (std::uint32_t i = 1; i < mesh.vertex_slots(); ++i) {
    if (all || mesh.is_alive(VertexSlot(i))) f(VertexSlot(i));
  }
}

}  // namespace

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
void StartGrid::fit(const Mesh& mesh, std::size_t vertices) {
  Point low{exact::kLatticeHalf, exact::kLatticeHalf}, high{-exact::kLatticeHalf, -exact::kLatticeHalf};
  each_vertex(mesh, vertices, [&](VertexSlot v) {
    const Point p = mesh.point(v);
    low = {std::min(low.x, p.x), std::min(low.y, p.y)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y)};
  });
  const double width = double(high.x) - low.x + 1, height = double(high.y) - low.y + 1;
  const double side = std::max(std::sqrt(width * height * kVerticesPerCell / double(vertices)), 1.0);
  x_ = make_axis(low.x, high.x, side);
  y_ = make_axis(low.y, high.y, side);
  reach_ = static_cast<std::int64_t>(4 * side) + 1;
}

/// At most as many cells as whole sides fit, so that the product of both counts stays near the number of
/// vertices.
StartGrid::Axis StartGrid::make_axis(std::int64_t low, std::int64_t high, double side) {
  Axis axis{low, high - low, 1, 0};
  axis.count = static_cast<std::uint32_t>(std::max(1.0, double(axis.last + 1) / side));
  // Rounded down, so that the last unit falls into the last cell. Fits: an axis has fewer than 2^31 units and
  // cells.
  axis.scale = (std::uint64_t{axis.count} << 32) / static_cast<std::uint64_t>(axis.last + 1);
  return axis;
}

void StartGrid::lay_out(const Mesh& mesh, std::size_t vertices) {
  hints_.clear();
  if (vertices == 0) return;
  fit(mesh, vertices);
  std::vector<std::uint8_t> count(std::size_t{x_.count} * y_.count, 0);
  each_vertex(mesh, vertices, [&](VertexSlot v) {
    const std::size_t c = cell(mesh.point(v));
    if (count[c] < kCrowd) ++count[c];
  });
  hints_.resize(count.size());
  std::transform(count.begin(), count.end(), hints_.begin(),
                 [](std::uint8_t n) { return n == kCrowd ? kCrowded : kNone; });
}

void StartGrid::fill(const Mesh& mesh) {
  outgrown_at_ = std::max<std::size_t>(16, 2 * mesh.vertex_count());
  too_large_at_ = mesh.vertex_count() / 4;
  if (mesh.dimension() < 2) hints_.clear();
  if (hints_.empty()) return;
  each_vertex(mesh, mesh.vertex_count(), [&](VertexSlot v) {
    std::uint32_t& hint = hints_[cell(mesh.point(v))];
    if (hint != kCrowded) hint = mesh.triangle_at(v).value();
  });
  // Empty cells take over the hint before them: near enough where cells are empty by chance.
  std::uint32_t last = kNone;
  for (std::uint32_t& hint : hints_) {
    if (hint == kNone) hint = last;
    if (hint != kCrowded) last = hint;
  }
}

TriangleSlot StartGrid::near(const Mesh& mesh, Point p) const {
  const TriangleSlot none{kNone};
  if (hints_.empty()) return none;
  const TriangleSlot t{hints_[cell(p)]};
  if (t.value() >= mesh.triangle_slots()) return none;
  mesh.prefetch_around(t);
  if (!mesh.is_alive(t)) return none;
  const auto& vertices = mesh.triangle(t).vertices;
  const Point q = mesh.point(vertices[0] == kInfinite ? vertices[1] : vertices[0]);
  const std::int64_t dx = std::int64_t{p.x} - q.x, dy = std::int64_t{p.y} - q.y;
  return std::max(dx, -dx) <= reach_ && std::max(dy, -dy) <= reach_ ? t : none;
}

}  // namespace tin::delaunay
