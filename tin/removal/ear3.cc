#include "tin/removal/ear3.h"

#include "tin/removal/low_degree.h"

namespace tin::removal {

template <class Tally>
std::span<const Ear> Ear3::fill(const Star& star, Tally& tally) {
  queue_.run(star, 3, tally);
  return queue_.ears();
}

template <class Tally>
std::span<const Ear> Ear5::fill(const Star& star, Tally& tally) {
  if (star.degree() <= 5) {
    LowDegree<Tally>(star, few_.data(), tally).fill_star();
    return std::span(few_).first(star.degree() - 2);
  }
  queue_.run(star, 5, tally);
  auto& ears = queue_.ears();
  if (const auto left = queue_.remains(); !left.empty()) {
    ears.resize(ears.size() + 3);
    LowDegree<Tally>(star, &ears[ears.size() - 3], tally).pentagon(left[0], left[1], left[2], left[3], left[4]);
  }
  return ears;
}

template std::span<const Ear> Ear3::fill(const Star&, NoCounters&);
template std::span<const Ear> Ear3::fill(const Star&, Counters&);
template std::span<const Ear> Ear5::fill(const Star&, NoCounters&);
template std::span<const Ear> Ear5::fill(const Star&, Counters&);

}  // namespace tin::removal
