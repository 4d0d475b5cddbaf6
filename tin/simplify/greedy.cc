#include "tin/simplify/greedy.h"

#include <algorithm>
#include <cmath>

#include "tin/base/check.h"

namespace tin::simplify {

using mesh::TriangleSlot;

Greedy::End Greedy::run(std::size_t budget, const Phase& phase, const std::function<bool(TriangleSlot)>& suspect) {
  if (!queue_all(phase, suspect)) return End::kCancelled;
  double progress = 0;
  for (;;) {
    const auto worst = take_worst();
    if (phase.cancelled()) return End::kCancelled;
    note_state(worst ? worst->error : 0);
    if (!worst) return End::kTargetMet;
    if (patch_.mesh().vertex_count() >= budget) return End::kBudgetSpent;
    const auto v = grant(*worst);
    if (!v) continue;
    inserted_.push_back(*v);
    for (const TriangleSlot fresh : patch_.fresh()) queue(fresh);
    if (inserted_.size() % 256 != 0) continue;
    // On terrain the number of vertices grows about as error^-1.25.
    const double by_error = worst->error > 0 ? std::pow(target_ / worst->error, 1.25) : 0;
    const double by_count = static_cast<double>(patch_.mesh().vertex_count()) / static_cast<double>(budget);
    progress = std::clamp(std::max(by_error, by_count), progress, 1.0);
    phase.report(progress);
  }
}

bool Greedy::queue_all(const Phase& phase, const std::function<bool(TriangleSlot)>& suspect) {
  const std::uint32_t slots = patch_.mesh().triangle_slots();
  stamps_.assign(slots, 0);
  for (std::uint32_t i = 0; i < slots; ++i) {
    if (phase.cancelled()) return false;
    if (suspect && !suspect(TriangleSlot(i))) continue;
    if (patch_.owns(TriangleSlot(i))) queue(TriangleSlot(i));
  }
  return true;
}

std::optional<mesh::VertexSlot> Greedy::grant(const Candidate& wish) {
  const TriangleSlot t(wish.triangle);
  if (const auto v = patch_.insert(patch_.samples().site(wish.sample), t)) return v;
  if (!patch_.samples().has_surface()) return std::nullopt;
  // An edge of the samples' surface, whose nearer end is a vertex.
  const Scan again = patch_.scan(t, target_, Depth::kWorst);
  return again.other == kNoSample ? std::nullopt : patch_.insert(patch_.samples().site(again.other), t);
}

void Greedy::queue(TriangleSlot t) {
  if (t.value() >= stamps_.size()) stamps_.resize(t.value() + 1);
  const std::uint32_t stamp = ++stamps_[t.value()];
  if (patch_.mesh().is_infinite(t)) return;
  const Scan scan = patch_.scan(t, target_, Depth::kWorst);
  if (!scan.over) return;
  queue_.push({scan.error, scan.sample, t.value(), stamp});
}

/// A triangle's wish is granted or refused once.
std::optional<Candidate> Greedy::take_worst() {
  const auto worst =
      queue_.pop([this](const Candidate& candidate) { return stamps_[candidate.triangle] == candidate.stamp; });
  if (worst) ++stamps_[worst->triangle];
  return worst;
}

void Greedy::note_state(double error) {
  if (error >= best_error_) return;
  best_error_ = error;
  best_count_ = inserted_.size();
}

double Greedy::return_to_best() {
  for (; inserted_.size() > best_count_; inserted_.pop_back()) TIN_CHECK(patch_.remove(inserted_.back()));
  return best_error_;
}

}  // namespace tin::simplify
