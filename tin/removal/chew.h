// `chew`: randomised refilling (Devillers 2002, section 4.1.3, after Chew 1986), in expected linear time.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "tin/removal/polygon.h"

namespace tin::removal {

/// Vertices leave the link in random order, then come back in reverse, each between the neighbours it had
/// when it left. The order is random by rounds, each of which takes every second of those that are left,
/// drawn by lot, and within a round follows the link: the expectation is the same but for a constant, and
/// memory is met in order. The draws are a fixed pseudo-random sequence; they decide on time, never on the
/// result. About 5 k in-circle tests.
class Chew {
 public:
  template <class Tally>
  std::span<const Ear> fill(const Star& star, Tally& tally);

 private:
  static constexpr std::uint32_t kAhead = 8;  // insertions
  static constexpr std::uint64_t kSeed = 0x9e3779b97f4a7c15ULL;

  void draw_order(std::uint32_t degree);
  void find_neighbours(std::uint32_t degree);

  std::uint64_t state_ = kSeed;
  std::vector<std::uint8_t> rounds_;   // by position
  std::vector<std::uint32_t> order_;   // of insertion
  std::vector<std::uint32_t> before_;  // by position: its predecessor when it comes back
  std::vector<std::uint32_t> after_;
  Polygon polygon_;
  std::vector<Ear> ears_;
};

}  // namespace tin::removal
