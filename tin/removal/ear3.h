// `ear3` and `ear5`: the ear queue down to the last triangle, or down to a pentagon (Devillers 2002,
// section 4.3.1).
#pragma once

#include <array>
#include <span>

#include "tin/removal/ear_queue.h"

namespace tin::removal {

/// 3k - 8 power computations at most, or 2k - 4 and k - 4 updates. Cost: O(k log k).
class Ear3 {
 public:
  explicit Ear3(Renewal renewal = Renewal::kCompute) : queue_(renewal) {}
  template <class Tally>
  std::span<const Ear> fill(const Star& star, Tally& tally);

 private:
  EarQueue queue_;
};

/// The queue stops at five vertices, and two or three in-circle tests do the rest; degrees three, four and
/// five need no queue at all.
class Ear5 {
 public:
  template <class Tally>
  std::span<const Ear> fill(const Star& star, Tally& tally);

 private:
  EarQueue queue_{Renewal::kCompute};
  std::array<Ear, 3> few_{};  // of degrees up to five
};

}  // namespace tin::removal
