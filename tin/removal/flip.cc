#include "tin/removal/flip.h"

namespace tin::removal {

template <class Tally>
std::span<const Ear> Flip::fill(const Star& star, Tally& tally) {
  polygon_.start(star.degree(), 0, 1, 2);
  for (std::uint32_t i = 3; i < star.degree(); ++i) polygon_.insert(star, i - 1, i, tally);
  ears_.clear();
  polygon_.append_ears(ears_);
  return ears_;
}

template std::span<const Ear> Flip::fill(const Star&, NoCounters&);
template std::span<const Ear> Flip::fill(const Star&, Counters&);

}  // namespace tin::removal
