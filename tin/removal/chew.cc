#include "tin/removal/chew.h"

#include <algorithm>
#include <array>
#include <bit>

namespace tin::removal {

template <class Tally>
std::span<const Ear> Chew::fill(const Star& star, Tally& tally) {
  const std::uint32_t k = star.degree();
  draw_order(k);
  find_neighbours(k);
  polygon_.start(k, order_[0], order_[1], order_[2]);
  for (std::uint32_t i = 3; i < k; ++i) {
    if (i + kAhead < k) polygon_.prefetch(star, before_[order_[i + kAhead]], order_[i + kAhead]);
    polygon_.insert(star, before_[order_[i]], order_[i], tally);
  }
  ears_.clear();
  polygon_.append_ears(ears_);
  return ears_;
}

/// A position's round is the number of heads before the first tail; the latest round comes back first.
void Chew::draw_order(std::uint32_t degree) {
  constexpr std::uint32_t kRounds = 33;
  std::array<std::uint32_t, kRounds + 1> ends{};
  rounds_.resize(degree);
  for (std::uint32_t i = 0; i < degree; ++i) {
    state_ ^= state_ << 13;  // xorshift: never zero, so there are fewer than 64 heads
    state_ ^= state_ >> 7;
    state_ ^= state_ << 17;
    const auto heads = std::min(
        static_cast<std::uint32_t>(std::countr_zero(state_ >> 20 | std::uint64_t{1} << 32)), kRounds - 1);
    rounds_[i] = static_cast<std::uint8_t>(kRounds - 1 - heads);
    ++ends[rounds_[i] + 1];
  }
  for (std::uint32_t r = 0; r < kRounds; ++r) ends[r + 1] += ends[r];
  order_.resize(degree);
  for (std::uint32_t i = 0; i < degree; ++i) order_[ends[rounds_[i]]++] = i;
  std::sort(order_.begin(), order_.begin() + 3);
}

void Chew::find_neighbours(std::uint32_t degree) {
  before_.resize(degree);
  after_.resize(degree);
  for (std::uint32_t i = 0; i < degree; ++i) {
    before_[i] = i == 0 ? degree - 1 : i - 1;
    after_[i] = i + 1 == degree ? 0 : i + 1;
  }
  for (std::uint32_t i = degree; i > 3; --i) {
    const std::uint32_t m = order_[i - 1];
    after_[before_[m]] = after_[m];
    before_[after_[m]] = before_[m];
  }
}

template std::span<const Ear> Chew::fill(const Star&, NoCounters&);
template std::span<const Ear> Chew::fill(const Star&, Counters&);

}  // namespace tin::removal
