#include "tin/removal/edge_completion.h"

#include <algorithm>

namespace tin::removal {

template <class Tally>
std::span<const Ear> EdgeCompletion::fill(const Star& star, Tally& tally) {
  ears_.clear();
  open_.assign(1, {0, star.degree() - 1});
  while (!open_.empty()) {
    const auto [first, last] = open_.back();
    open_.pop_back();
    std::uint32_t apex = first + 1;
    for (std::uint32_t i = first + 2; i < last; ++i) {
      if (star.in_conflict(first, apex, last, i, tally)) apex = i;
    }
    ears_.push_back({first, apex, last});
    if (apex > first + 1) open_.push_back({first, apex});
    if (last > apex + 1) open_.push_back({apex, last});
  }
  std::reverse(ears_.begin(), ears_.end());  // what lies behind a triangle's sides is cut before it
  return ears_;
}

template std::span<const Ear> EdgeCompletion::fill(const Star&, NoCounters&);
template std::span<const Ear> EdgeCompletion::fill(const Star&, Counters&);

}  // namespace tin::removal
