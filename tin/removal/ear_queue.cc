#include "tin/removal/ear_queue.h"

#include <algorithm>

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
    candidates_.resize(k);
    if (renewal_ == Renewal::kUpdate) minors_.resize(k);
  }
  heap_.clear();
  ears_.clear();
  remains_.clear();
  for (std::uint32_t i = 0; i < k; ++i) ring_[i] = {i == 0 ? k - 1 : i - 1, i + 1 == k ? 0 : i + 1, kNowhere};
  use_heap_ = k > kScanLimit;
  left_ = k;
  some_node_ = 0;
}

template <class Tally>
void EarQueue::shell(const Star& star, std::uint32_t stop, Tally& tally) {
  for (std::uint32_t i = 0; i < left_; ++i) renew(star, i, false, tally);
  while (!heap_.empty()) {
    const std::uint32_t node = smallest(star, tally);
    const std::uint32_t previous = ring_[node].previous, next = ring_[node].next;
    drop(star, node, tally);
    cut(node);
    if (left_ == stop) return;
    renew(star, previous, true, tally);
    renew(star, next, false, tally);
  }
}

/// Makes the present ear at `node`, if its corners are finite and turn left. `same_start`: only its third
/// corner changed.
template <class Tally>
void EarQueue::renew(const Star& star, std::uint32_t node, bool same_start, Tally& tally) {
  const auto [previous, next, in_heap] = ring_[node];
  const std::uint32_t infinite = star.infinite();
  const bool finite = node != infinite && previous != infinite && next != infinite;
  const std::int64_t turn = finite ? exact::orientation(star.at(previous), star.at(node), star.at(next)) : 0;
  if (turn <= 0) {
    drop(star, node, tally);
    return;
  }
  Candidate& ear = candidates_[node];
  const exact::Lifted &a = star.at(previous), &b = star.at(node), &c = star.at(next);
  if (renewal_ == Renewal::kCompute) {
    tally.power_computation();
    ear.power = exact::make_power(exact::in_circle_determinant(a, b, c), turn);
  } else {
    const bool update = same_start && in_heap != kNowhere;  // else there are no minors to start from
    if (update) tally.power_update(); else tally.power_computation();
    if (!update) minors_[node] = exact::power_minors(a, b);
    ear.power = exact::make_power(exact::in_circle_determinant(minors_[node], c), turn);
  }
  ear.previous = previous;
  ear.next = next;
  place(star, {ear.power.approximate, node}, tally);
}

/// The shelling order: smaller |power|; if equal, smaller perturbed |power|.
template <class Tally>
bool EarQueue::comes_before(const Star& star, const Entry& a, const Entry& b, Tally& tally) const {
  tally.comparison();
  if (const int sign = exact::compare_filtered(a.approximate, b.approximate); sign != 0) return sign < 0;
  tally.filter_failure();
  const Candidate &l = candidates_[a.node], &r = candidates_[b.node];
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

template <class Tally>
std::uint32_t EarQueue::smallest(const Star& star, Tally& tally) const {
  std::size_t best = 0;
  for (std::size_t i = 1; !use_heap_ && i < heap_.size(); ++i) {
    if (comes_before(star, heap_[i], heap_[best], tally)) best = i;
  }
  return heap_[best].node;
}

void EarQueue::put(std::size_t i, const Entry& entry) {
  heap_[i] = entry;
  ring_[entry.node].in_heap = static_cast<std::uint32_t>(i);
}

/// Puts a new or changed entry where it belongs.
template <class Tally>
void EarQueue::place(const Star& star, const Entry& entry, Tally& tally) {
  std::size_t i = ring_[entry.node].in_heap;
  if (i == kNowhere) {
    i = heap_.size();
    heap_.push_back(entry);
  }
  sift(star, i, entry, tally);
}

template <class Tally>
void EarQueue::drop(const Star& star, std::uint32_t node, Tally& tally) {
  const std::uint32_t i = ring_[node].in_heap;
  if (i == kNowhere) return;
  ring_[node].in_heap = kNowhere;
  const Entry last = heap_.back();
  heap_.pop_back();
  if (last.node != node) sift(star, i, last, tally);
}

/// Moves the hole to where `entry` belongs: up, or else down along the smaller children to a leaf and from
/// there up again, which asks about half as often as comparing with `entry` on the way down.
template <class Tally>
void EarQueue::sift(const Star& star, std::size_t hole, const Entry& entry, Tally& tally) {
  if (!use_heap_) return put(hole, entry);
  const std::size_t start = climb(star, hole, 0, entry, tally);
  if (start != hole) return put(start, entry);
  for (std::size_t child; (child = kArity * hole + 1) < heap_.size(); hole = child) {
    const std::size_t end = std::min(child + kArity, heap_.size());
    for (std::size_t other = child + 1; other < end; ++other) {
      if (comes_before(star, heap_[other], heap_[child], tally)) child = other;
    }
    put(hole, heap_[child]);
  }
  put(climb(star, hole, start, entry, tally), entry);
}

/// Moves the hole up, not above `top`, while its parent comes after `entry`.
template <class Tally>
std::size_t EarQueue::climb(const Star& star, std::size_t hole, std::size_t top, const Entry& entry,
                            Tally& tally) {
  for (std::size_t parent;
       hole > top && comes_before(star, entry, heap_[parent = (hole - 1) / kArity], tally); hole = parent) {
    put(hole, heap_[parent]);
  }
  return hole;
}

void EarQueue::cut(std::uint32_t node) {
  const auto [previous, next, in_heap] = ring_[node];
  ears_.push_back({previous, node, next});
  ring_[previous].next = next;
  ring_[next].previous = previous;
  some_node_ = previous;
  --left_;
}

template void EarQueue::run(const Star&, std::uint32_t, NoCounters&);
template void EarQueue::run(const Star&, std::uint32_t, Counters&);

}  // namespace tin::removal
