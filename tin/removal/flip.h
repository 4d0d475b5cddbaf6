// `flip`: non-redundant flipping around q0 (Devillers 2002, section 4.1.1, after Snoeyink).
#pragma once

#include <span>
#include <vector>

#include "tin/removal/polygon.h"

namespace tin::removal {

/// All q_i are linked to q0. Then the fan is gone through once: with each next q_j the edges that turned out
/// illegal are flipped around to it, which triangulates q0 ... q_j. Triangles of the fan that were not
/// reached yet may overlap the others, and nobody looks at them. In-circle tests: (k - 2) (k - 3) / 2 at
/// most, about 1.5 k on random links.
class Flip {
 public:
  template <class Tally>
  std::span<const Ear> fill(const Star& star, Tally& tally);

 private:
  Polygon polygon_;
  std::vector<Ear> ears_;
};

}  // namespace tin::removal
