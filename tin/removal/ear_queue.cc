#include "tin/removal/ear_queue.h"

#include <algorithm>
#include <bit>

#include "tin/base/check.h"

namespace tin::removal {

using exact::Corners;

template <class Tally>
void EarQueue::run(const Star& star, std::uint32_t stop, Tally& tally) {
  begin(star);
  if (left_ > stop) shell(star, stop, tally);
  if (left_ > stop) {
    // No left turn on the finite chain: each of its edges lies on the new hull.
    TIN_CHECK(star.is_on_hull());
    while (left_ > 3) cut(ring_[star.infinite()].next);
  }
  if (left_ == 3) {
    cut(ring_[some_node_].next);
    return;
  }
  for (std::uint32_t i = 0, node = some_node_; i < left_; ++i, node = ring_[node].next)
    remains_.push_back(node);
}

void EarQueue::begin(const Star& star) {
  const std::uint32_t k = star.degree();
  if (ring_.size() < k) {
    ring_.resize(k);
    if (renewal_ == Renewal::kUpdate) minors_.resize(k);
  }
  set_.clear();
  ears_.clear();
  remains_.clear();
  for (std::uint32_t i = 0; i < k; ++i)
    ring_[i] = {i == 0 ? k - 1 : i - 1, i + 1 == k ? 0 : i + 1, kNowhere, {}};
  leaves_ = k > kScanLimit ? std::bit_ceil(std::size_t{k}) : 0;
  if (tree_.size() < 2 * leaves_) tree_.resize(2 * leaves_);
  std::fill_n(tree_.begin() + static_cast<std::ptrdiff_t>(leaves_), leaves_, kNoEar);
  left_ = k;
  some_node_ = 0;
}

template <class Tally>
void EarQueue::shell(const Star& star, std::uint32_t stop, Tally& tally) {
  for (std::uint32_t i = 0; i < left_; ++i) renew(star, i, false, tally);
  for (std::size_t match = leaves_; match-- > 1;) play(star, match, tally);
  for (std::uint32_t node; (node = smallest(star, tally)) != kNowhere;) {
    const std::uint32_t previous = ring_[node].previous, next = ring_[node].next;
    withdraw(node);
    cut(node);
    if (left_ == stop) return;
    renew(star, previous, true, tally);
    renew(star, next, false, tally);
    if (leaves_ != 0) {
      settle(star, previous, node, next, tally);
      fetch_ahead(star);
    }
  }
}

/// Makes the present ear at `node`, if its corners are finite and turn left. `same_start`: only its third
/// corner changed.
template <class Tally>
void EarQueue::renew(const Star& star, std::uint32_t node, bool same_start, Tally& tally) {
  const std::uint32_t previous = ring_[node].previous, next = ring_[node].next;
  const std::uint32_t infinite = star.infinite();
  const bool finite = node != infinite && previous != infinite && next != infinite;
  const std::int64_t turn = finite ? exact::orientation(star.at(previous), star.at(node), star.at(next)) : 0;
  if (turn <= 0) {
    withdraw(node);
    return;
  }
  exact::Power& power = ring_[node].power;
  const exact::Lifted &a = star.at(previous), &b = star.at(node), &c = star.at(next);
  if (renewal_ == Renewal::kCompute) {
    tally.power_computation();
    power = exact::make_power(exact::in_circle_determinant(a, b, c), turn);
  } else {
    const bool update = same_start && is_ear(node);  // else there are no minors to start from
    if (update)
      tally.power_update();
    else
      tally.power_computation();
    if (!update) minors_[node] = exact::power_minors(a, b);
    power = exact::make_power(exact::in_circle_determinant(minors_[node], c), turn);
  }
  put({power.approximate, node});
}

/// The shelling order: smaller |power|; if equal, smaller perturbed |power|.
template <class Tally>
bool EarQueue::comes_before(const Star& star, const Entry& a, const Entry& b, Tally& tally) const {
  tally.comparison();
  if (const int sign = exact::compare_filtered(a.approximate, b.approximate); sign != 0) return sign < 0;
  tally.filter_failure();
  const Node &l = ring_[a.node], &r = ring_[b.node];
  tally.exact_evaluation();
  auto sign = exact::compare_in_128_bits(l.power, r.power);
  if (!sign) {
    tally.gmp_evaluation();
    sign = exact::compare_by_gmp(l.power, r.power);
  }
  if (*sign != 0) return *sign < 0;
  tally.power_tie();
  const Corners left{star.at(l.previous), star.at(a.node), star.at(l.next)};
  const Corners right{star.at(r.previous), star.at(b.node), star.at(r.next)};
  return exact::compare_perturbed(left, l.power.orientation, right, r.power.orientation) < 0;
}

/// The node of the ear that comes first; kNowhere if there is none.
template <class Tally>
std::uint32_t EarQueue::smallest(const Star& star, Tally& tally) const {
  if (leaves_ != 0) return tree_[1].node;
  if (set_.empty()) return kNowhere;
  std::size_t best = 0;
  for (std::size_t i = 1; i < set_.size(); ++i) {
    if (comes_before(star, set_[i], set_[best], tally)) best = i;
  }
  return set_[best].node;
}

bool EarQueue::is_ear(std::uint32_t node) const {
  return (leaves_ != 0 ? tree_[leaves_ + node].node : ring_[node].in_set) != kNowhere;
}

/// Notes a new or changed ear. In the tree it wins nothing before settle().
void EarQueue::put(const Entry& entry) {
  if (leaves_ != 0) {
    tree_[leaves_ + entry.node] = entry;
    return;
  }
  std::uint32_t& i = ring_[entry.node].in_set;
  if (i != kNowhere) {
    set_[i] = entry;
    return;
  }
  i = static_cast<std::uint32_t>(set_.size());
  set_.push_back(entry);
}

void EarQueue::withdraw(std::uint32_t node) {
  if (leaves_ != 0) {
    tree_[leaves_ + node] = kNoEar;
    return;
  }
  const std::uint32_t i = ring_[node].in_set;
  if (i == kNowhere) return;
  set_[i] = set_.back();
  ring_[set_[i].node].in_set = i;
  set_.pop_back();
  ring_[node].in_set = kNowhere;
}

/// Nobody can tell beforehand which of two ears wins, so no branch depends on it unless it is in doubt.
template <class Tally>
void EarQueue::play(const Star& star, std::size_t match, Tally& tally) {
  const Entry* const pair = &tree_[2 * match];
  const int sign = exact::compare_filtered(pair[1].approximate, pair[0].approximate);
  if (sign == 0) [[unlikely]] {
    const bool both = pair[0].node != kNowhere && pair[1].node != kNowhere;
    const bool second = both ? comes_before(star, pair[1], pair[0], tally) : pair[0].node == kNowhere;
    tree_[match] = pair[second ? 1 : 0];
    return;
  }
  if (pair[0].node != kNowhere && pair[1].node != kNowhere) tally.comparison();
  tree_[match] = pair[sign < 0 ? 1 : 0];
}

/// Plays the matches anew in which the ears of three nodes take part.
template <class Tally>
void EarQueue::settle(const Star& star, std::uint32_t a, std::uint32_t b, std::uint32_t c, Tally& tally) {
  std::size_t i = leaves_ + a, j = leaves_ + b, k = leaves_ + c;
  while (i != j || j != k) {
    i /= 2, j /= 2, k /= 2;
    play(star, i, tally);
    if (j != i) play(star, j, tally);
    if (k != j && k != i) play(star, k, tally);
  }
  while ((i /= 2) >= 1) play(star, i, tally);
}

/// Asks memory for what the ears need that lost the last matches: one of them comes soon, if not next.
void EarQueue::fetch_ahead(const Star& star) const {
  constexpr std::size_t kFrom = 4;  // the matches of the round before the last two
  for (std::size_t match = kFrom; match < 2 * kFrom; ++match) {
    const std::uint32_t node = tree_[match].node;
    if (node == kNowhere) continue;
    __builtin_prefetch(&ring_[node]);
    __builtin_prefetch(&star.at(node));
    std::size_t place = leaves_ + node;
    for (int round = 0; round < 3; ++round, place /= 2) __builtin_prefetch(&tree_[place]);
  }
}

void EarQueue::cut(std::uint32_t node) {
  const std::uint32_t previous = ring_[node].previous, next = ring_[node].next;
  ears_.push_back({previous, node, next});
  ring_[previous].next = next;
  ring_[next].previous = previous;
  some_node_ = previous;
  --left_;
}

template void EarQueue::run(const Star&, std::uint32_t, NoCounters&);
template void EarQueue::run(const Star&, std::uint32_t, Counters&);

}  // namespace tin::removal
