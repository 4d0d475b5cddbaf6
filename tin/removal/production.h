// `production`: what won the benchmark at each degree (tests/bench/README.md): decision trees up to degree seven, and
// randomised refilling above, so that no degree is worse than expected linear.
#pragma once

#include <array>
#include <span>

#include "tin/removal/chew.h"
#include "tin/removal/low_degree.h"

namespace tin::removal {

class Production {
 public:
  template <class Tally>
  std::span<const Ear> fill(const Star& star, Tally& tally) {
    if (star.degree() > kLowDegreeLimit) return chew_.fill(star, tally);
    LowDegree<Tally>(star, few_.data(), tally).fill_star();
    return std::span(few_).first(star.degree() - 2);
  }

 private:
  Chew chew_;
  std::array<Ear, kLowDegreeLimit - 2> few_{};
};

}  // namespace tin::removal
