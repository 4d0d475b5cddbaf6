// `production`: what won the benchmark at each degree (tests/bench/README.md): edge completion that branches
// little while its square is small, and randomised refilling above, so that no degree is worse than expected
// linear.
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
    if (star.degree() > kSquareLimit) return chew_.fill(star, tally);
    LowDegree<Tally>(star, few_.data(), tally).fill_star();
    return std::span(few_).first(star.degree() - 2);
  }

 private:
  static constexpr std::uint32_t kSquareLimit = 20;  // 5 to 9 in-circle tests per edge up to here

  Chew chew_;
  std::array<Ear, kSquareLimit - 2> few_{};
};

}  // namespace tin::removal
