#include "tin/simplify/decimate.h"

#include <algorithm>
#include <utility>

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
    patch_.mesh().link(v, link_);
    neighbours.clear();
    for (const mesh::HalfEdge e : link_) neighbours.push_back(patch_.mesh().origin(e));
    ++stamps_[v.value()];
    if (!patch_.remove(v)) continue;
    for (const VertexSlot neighbour : neighbours) queue(neighbour);
    // About half of those that could go at first will.
    const double fraction = 2.0 * static_cast<double>(++removed) / static_cast<double>(at_first);
    if (removed % 64 == 0) phase.report(kQueuingShare + (1 - kQueuingShare) * std::min(fraction, 1.0));
  }
  return !phase.cancelled();
}

/// By slot, which is along the Hilbert curve for most: what one trial fetches from memory, the next one uses.
bool Decimation::queue_all(const Phase& phase) {
  const std::uint32_t slots = patch_.mesh().vertex_slots();
  stamps_.assign(slots, 0);
  for (std::uint32_t i = patch_.first_owned(); i < slots; ++i) {
    if (phase.cancelled()) return false;
    const VertexSlot v(i);
    if (patch_.mesh().is_alive(v) && !patch_.is_settled(v)) queue(v);
    if (i % 256 == 0) phase.report(static_cast<double>(i) / static_cast<double>(slots));
  }
  return true;
}

/// Tries anew what the removal of `v` would cost.
void Decimation::queue(VertexSlot v) {
  if (v == kInfinite) return;
  const std::uint32_t stamp = ++stamps_[v.value()];
  if (!patch_.is_removable(v)) return;
  const auto cost = trial_.cost_of_removing(patch_, v, tolerance_);
  if (!cost) return patch_.settle(v);
  heap_.push_back({*cost, patch_.site(v).sample, v.value(), stamp});
  std::push_heap(heap_.begin(), heap_.end());
}

}  // namespace tin::simplify
