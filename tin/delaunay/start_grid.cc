#include "tin/delaunay/start_grid.h"

#include <algorithm>
#include <bit>

namespace tin::delaunay {

using exact::Point;
using mesh::Mesh;
using mesh::VertexSlot;

namespace {
constexpr std::size_t kVerticesPerCell = 4;
constexpr std::uint32_t kSamples = 24;  // vertices looked at when a cell has no hint

std::uint64_t squared_distance(Point a, Point b) {
  const std::int64_t dx = std::int64_t{a.x} - b.x, dy = std::int64_t{a.y} - b.y;
  return static_cast<std::uint64_t>(dx * dx) + static_cast<std::uint64_t>(dy * dy);
}

std::uint64_t scramble(std::uint64_t x) {
  x = (x ^ (x >> 31)) * 0x7fb5d329728ea185ULL;
  x = (x ^ (x >> 27)) * 0x81dadef4bc2dd44dULL;
  return x ^ (x >> 33);
}
}  // namespace

bool StartGrid::usable(const Mesh& mesh, std::uint32_t slot) const { return slot != 0 && mesh.is_alive(VertexSlot(slot)); }

std::size_t StartGrid::cell(Point p) const {
  const auto clamp = [](std::int64_t offset, int shift, std::uint32_t count) {
    return static_cast<std::size_t>(std::clamp<std::int64_t>(offset >> shift, 0, std::int64_t{count} - 1));
  };
  return clamp(std::int64_t{p.y} - low_.y, shift_y_, rows_) * columns_ + clamp(std::int64_t{p.x} - low_.x, shift_x_, columns_);
}

void StartGrid::remember(const Mesh& mesh, VertexSlot v) {
  if (mesh.vertex_count() > outgrown_at_) rebuild(mesh);
  if (!hints_.empty()) hints_[cell(mesh.point(v))] = v.value();
}

void StartGrid::rebuild(const Mesh& mesh) {
  Point low{exact::kLatticeHalf, exact::kLatticeHalf}, high{-exact::kLatticeHalf, -exact::kLatticeHalf};
  for (std::uint32_t i = 1; i < mesh.vertex_slots(); ++i) {
    if (!mesh.is_alive(VertexSlot(i))) continue;
    const Point p = mesh.point(VertexSlot(i));
    low = {std::min(low.x, p.x), std::min(low.y, p.y)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y)};
  }
  const std::uint64_t width = static_cast<std::uint64_t>(std::int64_t{high.x} - low.x) + 1;
  const std::uint64_t height = static_cast<std::uint64_t>(std::int64_t{high.y} - low.y) + 1;
  const std::size_t cells = std::max<std::size_t>(1, 2 * mesh.vertex_count() / kVerticesPerCell);
  int shift = 0;
  while (((width >> shift) + 1) * ((height >> shift) + 1) > cells) ++shift;
  low_ = low;
  shift_x_ = shift_y_ = shift;
  columns_ = static_cast<std::uint32_t>(((width - 1) >> shift) + 1);
  rows_ = static_cast<std::uint32_t>(((height - 1) >> shift) + 1);
  outgrown_at_ = std::max<std::size_t>(64, 2 * mesh.vertex_count());
  hints_.assign(std::size_t{columns_} * rows_, 0);
  for (std::uint32_t i = 1; i < mesh.vertex_slots(); ++i) {
    if (mesh.is_alive(VertexSlot(i))) hints_[cell(mesh.point(VertexSlot(i)))] = i;
  }
}

VertexSlot StartGrid::near(const Mesh& mesh, Point p) const {
  std::uint32_t best = 0;
  if (!hints_.empty()) {
    const std::uint32_t hint = hints_[cell(p)];
    // A slot used again elsewhere makes a stale hint; only one that is still near is worth following.
    const std::uint64_t reach = std::uint64_t{2} << std::max(shift_x_, shift_y_);
    if (usable(mesh, hint) && squared_distance(mesh.point(VertexSlot(hint)), p) <= reach * reach) return VertexSlot(hint);
  }
  std::uint64_t best_distance = ~std::uint64_t{0};
  std::uint64_t state = static_cast<std::uint64_t>(static_cast<std::uint32_t>(p.x)) << 32 | static_cast<std::uint32_t>(p.y);
  const std::uint32_t slots = mesh.vertex_slots();
  for (std::uint32_t tries = 0; tries < kSamples || best == 0; ++tries) {
    state = scramble(state + tries + 1);
    // After many misses go through the slots in order: an alive one exists.
    const std::uint32_t slot = tries < 64 ? 1 + static_cast<std::uint32_t>(state % (slots - 1)) : 1 + (tries - 64) % (slots - 1);
    if (!usable(mesh, slot)) continue;
    const std::uint64_t distance = squared_distance(mesh.point(VertexSlot(slot)), p);
    if (distance < best_distance) {
      best = slot;
      best_distance = distance;
    }
  }
  return VertexSlot(best);
}

}  // namespace tin::delaunay
