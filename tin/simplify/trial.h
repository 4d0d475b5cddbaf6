// What it would cost to remove a vertex.
#pragma once

#include <optional>

#include "tin/removal/remover.h"
#include "tin/simplify/patch.h"

namespace tin::simplify {

/// Tries removals without making them. One thread at a time.
class Trial {
 public:
  /// The largest error, rounded, over the star of `v` once it is gone; nothing when a sample would be over the tolerance.
  std::optional<double> cost_of_removing(const Patch& patch, mesh::VertexSlot v, double tolerance);

 private:
  removal::Remover remover_;
};

}  // namespace tin::simplify
