// What it would cost to remove a vertex.
#pragma once

#include <optional>

#include "tin/removal/remover.h"
#include "tin/simplify/patch.h"

namespace tin::simplify {

/// Tries removals without making them. One thread at a time.
class Trial {
 public:
  /// The largest error, rounded, over the star of `v` once it is gone; nothing when a sample would be over
  /// the tolerance.
  std::optional<double> cost_of_removing(const Patch& patch, mesh::VertexSlot v, double tolerance);

  /// Calls visit(a, b, c) for each finite triangle that would fill the hole, counter-clockwise.
  template <class Visit>
  void visit_hole(const Patch& patch, mesh::VertexSlot v, const Visit& visit) {
    for (const removal::Ear& ear : remover_.fill(patch.mesh(), v)) {
      const mesh::VertexSlot a = remover_.link_vertex(ear.previous), b = remover_.link_vertex(ear.middle),
                             c = remover_.link_vertex(ear.next);
      if (a != mesh::kInfinite && b != mesh::kInfinite && c != mesh::kInfinite) visit(a, b, c);
    }
  }

 private:
  removal::Remover remover_;
};

}  // namespace tin::simplify
