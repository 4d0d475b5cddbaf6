#include "tin/simplify/decimate.h"

#include <algorithm>
#include <array>
#include <utility>

#include "tin/delaunay/hilbert.h"

namespace tin::simplify {

using mesh::kInfinite;
using mesh::VertexSlot;

namespace {
constexpr double kQueuingShare = 0.5;  // of the time: the first trial of every vertex
}

bool Decimation::run(const Phase& phase) {
  if (!queue_all(phase.part(0, kQueuingShare))) return false;
  const std::size_t at_first = std::max<std::size_t>(heap_.size(), 1);
  std::size_t removed = 0;
  std::vector<VertexSlot> neighbours;
  while (!heap_.empty()) {
    if (phase.cancelled()) return false;
    std::pop_heap(heap_.begin(), heap_.end());
    const Candidate candidate = heap_.back();
    heap_.pop_back();
    const VertexSlot v(candidate.vertex);
    if (stamps_[v.value()] != candidate.stamp) continue;
    tin_.mesh().link(v, link_);
    neighbours.clear();
    for (const mesh::HalfEdge e : link_) neighbours.push_back(tin_.mesh().origin(e));
    tin_.remove(v);
    ++stamps_[v.value()];
    for (const VertexSlot neighbour : neighbours) queue(neighbour);
    // About half of those that could go at first will.
    const double fraction = 2.0 * static_cast<double>(++removed) / static_cast<double>(at_first);
    if (removed % 64 == 0) phase.report(kQueuingShare + (1 - kQueuingShare) * std::min(fraction, 1.0));
  }
  return !phase.cancelled();
}

/// Along the Hilbert curve: what one trial fetches from memory, the next one uses. The order does not matter
/// otherwise.
bool Decimation::queue_all(const Phase& phase) {
  const std::uint32_t slots = tin_.mesh().vertex_slots();
  stamps_.assign(slots, 0);
  std::vector<std::pair<std::uint64_t, VertexSlot>> order;
  order.reserve(slots);
  for (std::uint32_t i = 1; i < slots; ++i) {
    const VertexSlot v(i);
    if (tin_.mesh().is_alive(v)) order.emplace_back(delaunay::hilbert_index(tin_.mesh().point(v)), v);
  }
  if (phase.cancelled()) return false;
  std::sort(order.begin(), order.end());
  for (std::size_t i = 0; i < order.size(); ++i) {
    if (phase.cancelled()) return false;
    queue(order[i].second);
    if (i % 256 == 0) phase.report(static_cast<double>(i) / static_cast<double>(order.size()));
  }
  return true;
}

/// Tries anew what the removal of `v` would cost.
void Decimation::queue(VertexSlot v) {
  if (v == kInfinite || tin_.is_corner(v)) return;
  const std::uint32_t stamp = ++stamps_[v.value()];
  const auto cost = cost_of_removing(v);
  if (!cost) return;
  heap_.push_back({*cost, tin_.site(v).sample, v.value(), stamp});
  std::push_heap(heap_.begin(), heap_.end());
}

/// Nothing when a sample would be over the tolerance.
std::optional<double> Decimation::cost_of_removing(VertexSlot v) {
  double cost = 0;
  for (const removal::Ear& ear : trial_.fill(tin_.mesh(), v)) {
    const std::array corners{trial_.link_vertex(ear.previous), trial_.link_vertex(ear.middle),
                             trial_.link_vertex(ear.next)};
    if (std::find(corners.begin(), corners.end(), kInfinite) != corners.end()) continue;
    const Scan scan = tin_.samples().scan(tin_.site(corners[0]), tin_.site(corners[1]), tin_.site(corners[2]),
                                          tolerance_, Depth::kFirstOver);
    if (scan.over) return std::nullopt;
    cost = std::max(cost, scan.error);
  }
  return cost;
}

}  // namespace tin::simplify
