// Deletion of vertices that a tolerance does not need, the cheapest first.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "tin/simplify/patch.h"
#include "tin/simplify/phase.h"
#include "tin/simplify/trial.h"

namespace tin::simplify {

/// Removes vertices of a patch until each one left whose star is its own is needed. A vertex's cost is the largest
/// error over its star once it is gone: known from a trial deletion, and valid until its star changes.
class Decimation {
 public:
  /// Where samples are over the tolerance (finite, >= 0) already, vertices around them stay. Borrows `patch`.
  Decimation(Patch& patch, double tolerance) : patch_(patch), tolerance_(tolerance) {}

  /// Tries the vertices that are not settled, and settles those that stay.
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

  Patch& patch_;
  double tolerance_;
  Trial trial_;
  std::vector<Candidate> heap_;
  std::vector<std::uint32_t> stamps_;  // of each vertex: candidates with an older one are void
  std::vector<mesh::HalfEdge> link_;
};

}  // namespace tin::simplify
