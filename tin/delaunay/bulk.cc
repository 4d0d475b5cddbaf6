// Insertion of many points: along the Hilbert curve in three rounds, every 64th point, every 8th, then all (a biased
// order that keeps walks short and cavities small, with no randomness in it).
#include <algorithm>
#include <array>

#include "tin/delaunay/hilbert.h"
#include "tin/delaunay/triangulation.h"

namespace tin::delaunay {
namespace {

struct Keyed {
  std::uint64_t key;
  std::uint32_t index;
};

/// Indices of `points` in the order in which to insert them.
std::vector<std::uint32_t> insertion_order(std::span<const exact::Point> points) {
  std::vector<Keyed> keyed(points.size());
  for (std::uint32_t i = 0; i < keyed.size(); ++i) keyed[i] = {hilbert_index(points[i]), i};
  std::sort(keyed.begin(), keyed.end(),
            [](const Keyed& a, const Keyed& b) { return a.key != b.key ? a.key < b.key : a.index < b.index; });
  std::vector<std::uint32_t> order;
  order.reserve(points.size());
  for (std::size_t i = 0; i < keyed.size(); i += 64) order.push_back(keyed[i].index);
  for (std::size_t i = 0; i < keyed.size(); i += 8) {
    if (i % 64 != 0) order.push_back(keyed[i].index);
  }
  for (std::size_t i = 0; i < keyed.size(); ++i) {
    if (i % 8 != 0) order.push_back(keyed[i].index);
  }
  return order;
}

}  // namespace

bool Triangulation::insert_many(std::span<const exact::Point> points, std::vector<mesh::VertexSlot>& slots,
                                base::Progress* progress) {
  slots.assign(points.size(), mesh::VertexSlot(mesh::kNone));
  mesh_.reserve(mesh_.vertex_count() + points.size());
  mesh::VertexSlot last{mesh::kNone};
  std::size_t done = 0;
  for (const std::uint32_t i : insertion_order(points)) {
    last = slots[i] = (last.value() == mesh::kNone ? insert(points[i]) : insert_near(points[i], last)).vertex;
    if (progress != nullptr && ++done % 4096 == 0) {
      if (progress->cancelled()) return false;
      progress->report(static_cast<double>(done) / static_cast<double>(points.size()));
    }
  }
  return true;
}

}  // namespace tin::delaunay
