// Deletion of vertices that a tolerance does not need, the cheapest first.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "tin/removal/remover.h"
#include "tin/simplify/phase.h"
#include "tin/simplify/working_tin.h"

namespace tin::simplify {

/// Removes vertices until each one left is needed. A vertex's cost is the largest error over its star once it
/// is gone: known from a trial deletion, and valid until its star changes.
class Decimation {
 public:
  /// Where samples are over the tolerance (finite, >= 0) already, vertices around them stay. Borrows `tin`.
  Decimation(WorkingTin& tin, double tolerance) : tin_(tin), tolerance_(tolerance) {}

  /// Ensures: no sample comes over the tolerance. False when cancelled.
  bool run(const Phase& phase);

 private:
  struct Candidate {
    double cost;
    SampleIndex sample;
    std::uint32_t vertex, stamp;
    /// For a heap with the least cost on top, then the smallest sample.
    friend bool operator<(const Candidate& a, const Candidate& b) {
      return a.cost != b.cost ? a.cost > b.cost : a.sample > b.sample;
    }
  };
  bool queue_all(const Phase& phase);
  void queue(mesh::VertexSlot v);
  std::optional<double> cost_of_removing(mesh::VertexSlot v);

  WorkingTin& tin_;
  double tolerance_;
  removal::Remover trial_;
  std::vector<Candidate> heap_;
  std::vector<std::uint32_t> stamps_;  // of each vertex: candidates with an older one are void
  std::vector<mesh::HalfEdge> link_;
};

}  // namespace tin::simplify
