// The queue of greedy insertion: the candidate of the largest error comes first.
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "tin/simplify/samples.h"

namespace tin::simplify {

/// A sample over the tolerance, and the triangle that it lies over.
struct Candidate {
  double error = 0;
  SampleIndex sample = 0;
  std::uint32_t triangle = 0;
  std::uint32_t stamp = 0;  // tells it from others that were queued for the same triangle
};

/// Candidates are strewn over buckets by the leading bits of their errors. Only the first bucket is kept in order, as a
/// heap that fits the first cache; what is out of date by the time its bucket becomes the first was never sorted.
class WorstFirst {
 public:
  /// Errors below `least` are allowed, but share a bucket.
  explicit WorstFirst(double least) : lowest_(rank(least)), heads_(kBuckets, kNone) {}

  void push(const Candidate& candidate) {
    const std::size_t bucket = bucket_of(candidate.error);
    if (bucket >= first_) return push_first(candidate);
    const std::uint32_t node = claim();
    nodes_[node] = {candidate, heads_[bucket]};
    heads_[bucket] = node;
    next_ = std::max(next_, bucket);
  }

  /// Takes out the candidate with the largest error, the smallest sample of equals, of those that `is_valid` says
  /// true of; others are forgotten. Nothing when none is left.
  template <class IsValid>
  std::optional<Candidate> pop(const IsValid& is_valid) {
    for (;;) {
      while (!heap_.empty()) {
        std::pop_heap(heap_.begin(), heap_.end(), comes_later);
        const Candidate out = heap_.back();
        heap_.pop_back();
        if (is_valid(out)) return out;
      }
      while (next_ > 0 && heads_[next_] == kNone) --next_;
      if (heads_[next_] == kNone) {
        first_ = kBuckets;
        return std::nullopt;
      }
      first_ = next_;
      for (std::uint32_t node = heads_[first_]; node != kNone;) {
        if (is_valid(nodes_[node].candidate)) heap_.push_back(nodes_[node].candidate);
        const std::uint32_t after = nodes_[node].next;
        nodes_[node].next = free_;
        free_ = node;
        node = after;
      }
      heads_[first_] = kNone;
      std::make_heap(heap_.begin(), heap_.end(), comes_later);
    }
  }

 private:
  static constexpr std::uint32_t kNone = 0xffffffff;
  static constexpr int kLeadingBits = 8;  // of the mantissa: 256 buckets for each octave
  static constexpr std::size_t kBuckets = 8192;

  struct Node {
    Candidate candidate;
    std::uint32_t next;
  };

  static bool comes_later(const Candidate& a, const Candidate& b) {
    return a.error != b.error ? a.error < b.error : a.sample > b.sample;
  }
  /// Grows with the error. Requires: error >= 0.
  static std::uint64_t rank(double error) { return std::bit_cast<std::uint64_t>(error) >> (52 - kLeadingBits); }
  std::size_t bucket_of(double error) const {
    const std::uint64_t of = rank(error);
    return of <= lowest_ ? 0 : std::min<std::uint64_t>(of - lowest_, kBuckets - 1);
  }
  void push_first(const Candidate& candidate) {
    heap_.push_back(candidate);
    std::push_heap(heap_.begin(), heap_.end(), comes_later);
  }
  std::uint32_t claim() {
    if (free_ == kNone) {
      nodes_.emplace_back();
      return static_cast<std::uint32_t>(nodes_.size() - 1);
    }
    const std::uint32_t node = free_;
    free_ = nodes_[node].next;
    return node;
  }

  std::uint64_t lowest_;
  std::vector<std::uint32_t> heads_;  // of each bucket's list
  std::vector<Node> nodes_;
  std::uint32_t free_ = kNone;    // the first node without a candidate
  std::size_t first_ = kBuckets;  // candidates from this bucket on stand in the heap
  std::size_t next_ = 0;          // no bucket below first_ and above this one has any
  std::vector<Candidate> heap_;
};

}  // namespace tin::simplify
