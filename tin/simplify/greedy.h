// Greedy insertion: the sample furthest from the TIN becomes a vertex, again and again.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <vector>

#include "tin/simplify/patch.h"
#include "tin/simplify/phase.h"
#include "tin/simplify/worst_first.h"

namespace tin::simplify {

/// One run of insertions. Only triangles with a sample over the target are queued.
class Greedy {
 public:
  static constexpr std::size_t kNoBudget = std::numeric_limits<std::size_t>::max();
  enum class End { kTargetMet, kBudgetSpent, kCancelled };

  /// Requires: target finite and >= 0. Borrows `patch`.
  Greedy(Patch& patch, double target) : patch_(patch), target_(target), queue_(target) {}

  /// Inserts until every sample over the patch's own triangles is within the target (exactly), but for those that
  /// could not become vertices without touching foreign triangles; or until `budget` vertices stand. With `suspect`, only the
  /// triangles that it says true of are asked at first, the others being known to be within.
  End run(std::size_t budget, const Phase& phase, const std::function<bool(mesh::TriangleSlot)>& suspect = {});

  /// After kBudgetSpent: removes again what came after the state of the least largest error, since that error
  /// does not fall steadily. Returns it, rounded.
  double return_to_best();

 private:
  bool queue_all(const Phase& phase, const std::function<bool(mesh::TriangleSlot)>& suspect);
  std::optional<mesh::VertexSlot> grant(const Candidate& wish);
  void queue(mesh::TriangleSlot t);
  std::optional<Candidate> take_worst();
  void note_state(double error);

  Patch& patch_;
  double target_;
  WorstFirst queue_;
  std::vector<std::uint32_t> stamps_;  // of each triangle: candidates with an older one are void
  std::vector<mesh::VertexSlot> inserted_;
  double best_error_ = std::numeric_limits<double>::infinity();
  std::size_t best_count_ = 0;  // of inserted_
};

}  // namespace tin::simplify
