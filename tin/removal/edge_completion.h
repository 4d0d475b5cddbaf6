// `edge-completion`: the Delaunay triangle on an edge of the hole, then both sides of it (Devillers 2002,
// section 4.1.2).
#pragma once

#include <span>
#include <vector>

#include "tin/removal/star.h"

namespace tin::removal {

/// In-circle tests: k - 3 for the first triangle, (k - 2) (k - 3) / 2 at most in all.
class EdgeCompletion {
 public:
  template <class Tally>
  std::span<const Ear> fill(const Star& star, Tally& tally);

 private:
  /// The part of the link from `first` to `last`, closed by the edge between them.
  struct Chain {
    std::uint32_t first, last;
  };
  std::vector<Chain> open_;
  std::vector<Ear> ears_;
};

}  // namespace tin::removal
