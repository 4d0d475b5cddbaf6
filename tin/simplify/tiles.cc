#include "tin/simplify/tiles.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <mutex>

#include "tin/delaunay/threads.h"

namespace tin::simplify {

using exact::Point;
using mesh::TriangleSlot;
using mesh::VertexSlot;

namespace {

/// Lines between `count` tiles over low..high, each a whole number of steps from `low`.
std::vector<std::int64_t> lines(std::int64_t low, std::int64_t high, std::int64_t step, std::size_t count, double shift) {
  const double steps = static_cast<double>(high - low) / static_cast<double>(step), tile = steps / static_cast<double>(count);
  std::vector<std::int64_t> out{low};
  for (std::size_t i = 0; i <= count; ++i) {
    const auto line = low + step * static_cast<std::int64_t>(std::llround((static_cast<double>(i) + shift) * tile));
    if (line > out.back() && line < high) out.push_back(line);
  }
  if (high > low) out.push_back(high);
  if (out.size() == 1) out.push_back(low + 1);
  return out;
}

std::size_t interval(const std::vector<std::int64_t>& lines, std::int64_t x) {
  const auto after = std::upper_bound(lines.begin() + 1, lines.end() - 1, x);
  return static_cast<std::size_t>(after - lines.begin()) - 1;
}

}  // namespace

Tiling::Tiling(const Extent& extent, std::size_t columns, std::size_t rows, double shift_x, double shift_y)
    : xs_(lines(extent.box.min.x, extent.box.max.x, extent.step_x, columns, shift_x)),
      ys_(lines(extent.box.min.y, extent.box.max.y, extent.step_y, rows, shift_y)) {}

Tiling Tiling::of_about(const Extent& extent, std::size_t count, double shift_x, double shift_y) {
  const double width = (static_cast<double>(extent.box.max.x) - extent.box.min.x) / static_cast<double>(extent.step_x) + 1;
  const double height = (static_cast<double>(extent.box.max.y) - extent.box.min.y) / static_cast<double>(extent.step_y) + 1;
  const double side = std::sqrt(width * height / static_cast<double>(std::max<std::size_t>(count, 1)));
  const auto parts = [side](double length) {
    return static_cast<std::size_t>(std::max(1.0, std::min(std::round(length / side), 65536.0)));
  };
  return {extent, parts(width), parts(height), shift_x, shift_y};
}

terrain::Box Tiling::box(std::size_t tile) const {
  const std::size_t columns = xs_.size() - 1, column = tile % columns, row = tile / columns;
  const auto at = [](std::int64_t x) { return static_cast<std::int32_t>(x); };
  return {{at(xs_[column]), at(ys_[row])}, {at(xs_[column + 1]), at(ys_[row + 1])}};
}

std::size_t Tiling::tile_of(Point p) const {
  return interval(ys_, p.y) * (xs_.size() - 1) + interval(xs_, p.x);
}

bool Tiling::is_inside(std::size_t tile, Point p) const {
  const std::size_t columns = xs_.size() - 1, column = tile % columns, row = tile / columns;
  return p.x > xs_[column] && p.x < xs_[column + 1] && p.y > ys_[row] && p.y < ys_[row + 1];
}

bool for_each_tile(std::size_t count, unsigned threads, const Phase& phase, const std::function<void(std::size_t)>& work) {
  std::atomic<std::size_t> next{0};
  std::mutex reporting;
  std::size_t done = 0;
  delaunay::on_threads(static_cast<unsigned>(std::clamp<std::size_t>(count, 1, std::max(threads, 1U))), [&](unsigned) {
    for (std::size_t tile = next++; tile < count && !phase.cancelled(); tile = next++) {
      work(tile);
      const std::lock_guard lock(reporting);
      phase.report(static_cast<double>(++done) / static_cast<double>(count));
    }
  });
  return !phase.cancelled();
}

namespace {

/// Which vertices each patch owns, and which it only looks at.
struct Division {
  std::vector<std::vector<Pin>> owned, frozen;
};

Division divide(const Patch& whole, const Tiling& tiling) {
  const mesh::Mesh& mesh = whole.mesh();
  Division out{std::vector<std::vector<Pin>>(tiling.size()), std::vector<std::vector<Pin>>(tiling.size())};
  std::vector<std::uint32_t> tile_of(mesh.vertex_slots());
  const auto pin = [&whole](VertexSlot v) {
    return Pin{whole.site(v).z, whole.site(v).sample, whole.is_fixed(v), whole.is_settled(v)};
  };
  for (std::uint32_t i = 1; i < mesh.vertex_slots(); ++i) {
    const VertexSlot v(i);
    if (!mesh.is_alive(v)) continue;
    tile_of[i] = static_cast<std::uint32_t>(tiling.tile_of(mesh.point(v)));
    out.owned[tile_of[i]].push_back(pin(v));
  }
  for (std::uint32_t i = 0; i < mesh.triangle_slots(); ++i) {
    const TriangleSlot t(i);
    if (!mesh.is_alive(t)) continue;
    for (const VertexSlot v : mesh.triangle(t).vertices) {
      for (const VertexSlot other : mesh.triangle(t).vertices) {
        if (v == mesh::kInfinite || other == mesh::kInfinite || tile_of[v.value()] == tile_of[other.value()]) continue;
        out.frozen[tile_of[v.value()]].push_back(pin(other));
      }
    }
  }
  for (auto& pins_of : out.frozen) {
    std::sort(pins_of.begin(), pins_of.end(), [](const Pin& a, const Pin& b) { return a.sample < b.sample; });
    const auto same = [](const Pin& a, const Pin& b) { return a.sample == b.sample; };
    pins_of.erase(std::unique(pins_of.begin(), pins_of.end(), same), pins_of.end());
  }
  return out;
}

}  // namespace

std::size_t patch_count(std::size_t vertices) {
  constexpr std::size_t kVerticesPerPatch = 4096;
  return vertices / kVerticesPerPatch;
}

bool work_in_patches(std::unique_ptr<Patch>& tin, const Tiling& tiling, unsigned threads, const Phase& phase,
                     const std::function<void(Patch&, std::size_t tile)>& work) {
  const Samples& samples = tin->samples();
  Division division = divide(*tin, tiling);
  tin.reset();
  const bool finished = for_each_tile(tiling.size(), threads, phase, [&](std::size_t tile) {
    Patch patch(samples, division.frozen[tile], division.owned[tile]);
    std::vector<Pin>().swap(division.frozen[tile]);
    work(patch, tile);
    division.owned[tile].clear();
    patch.collect(division.owned[tile]);
  });
  if (!finished) return false;
  std::vector<Pin> pins;
  for (auto& left : division.owned) {
    pins.insert(pins.end(), left.begin(), left.end());
    std::vector<Pin>().swap(left);
  }
  tin = std::make_unique<Patch>(samples, std::span<const Pin>(), pins, threads);
  return true;
}

}  // namespace tin::simplify
