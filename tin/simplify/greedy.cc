#include "tin/simplify/greedy.h"

#include <algorithm>
#include <cmath>

namespace tin::simplify {

using mesh::TriangleSlot;

Greedy::End Greedy::run(std::size_t budget, const Phase& phase) {
  if (!queue_all(phase)) return End::kCancelled;
  double progress = 0;
  for (;;) {
    const auto worst = take_worst();
    if (phase.cancelled()) return End::kCancelled;
    note_state(worst ? worst->error : 0);
    if (!worst) return End::kTargetMet;
    if (tin_.vertex_count() >= budget) return End::kBudgetSpent;
    const TriangleSlot t(worst->triangle);
    inserted_.push_back(tin_.insert(worst->sample, tin_.mesh().vertex(t, 0)));
    for (const TriangleSlot fresh : tin_.fresh_triangles()) queue(fresh);
    if (inserted_.size() % 256 != 0) continue;
    // On terrain the number of vertices grows about as error^-1.25.
    const double by_error = worst->error > 0 ? std::pow(target_ / worst->error, 1.25) : 0;
    const double by_count = static_cast<double>(tin_.vertex_count()) / static_cast<double>(budget);
    progress = std::clamp(std::max(by_error, by_count), progress, 1.0);
    phase.report(progress);
  }
}

bool Greedy::queue_all(const Phase& phase) {
  for (std::uint32_t i = 0; i < tin_.mesh().triangle_slots(); ++i) {
    if (phase.cancelled()) return false;
    if (tin_.mesh().is_alive(TriangleSlot(i))) queue(TriangleSlot(i));
  }
  return true;
}

void Greedy::queue(TriangleSlot t) {
  if (t.value() >= stamps_.size()) stamps_.resize(t.value() + 1, 0);
  const std::uint32_t stamp = ++stamps_[t.value()];
  if (tin_.mesh().is_infinite(t)) return;
  const Scan scan = tin_.scan(t, target_, Depth::kWorst);
  if (!scan.over) return;
  heap_.push_back({scan.error, scan.sample, t.value(), stamp});
  std::push_heap(heap_.begin(), heap_.end());
}

std::optional<Greedy::Candidate> Greedy::take_worst() {
  while (!heap_.empty()) {
    std::pop_heap(heap_.begin(), heap_.end());
    const Candidate candidate = heap_.back();
    heap_.pop_back();
    if (stamps_[candidate.triangle] == candidate.stamp) return candidate;
  }
  return std::nullopt;
}

void Greedy::note_state(double error) {
  if (error >= best_error_) return;
  best_error_ = error;
  best_count_ = inserted_.size();
}

double Greedy::return_to_best() {
  for (; inserted_.size() > best_count_; inserted_.pop_back()) tin_.remove(inserted_.back());
  return best_error_;
}

}  // namespace tin::simplify
