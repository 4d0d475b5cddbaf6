// `mixed:d`: `flip` below degree d, `ear5` from there on (Devillers 2002, section 4.3.1).
#pragma once

#include <span>

#include "tin/removal/ear3.h"
#include "tin/removal/flip.h"

namespace tin::removal {

class Mixed {
 public:
  explicit Mixed(std::uint32_t limit) : limit_(limit) {}
  template <class Tally>
  std::span<const Ear> fill(const Star& star, Tally& tally) {
    return star.degree() < limit_ ? flip_.fill(star, tally) : ear5_.fill(star, tally);
  }

 private:
  std::uint32_t limit_;
  Flip flip_;
  Ear5 ear5_;
};

}  // namespace tin::removal
