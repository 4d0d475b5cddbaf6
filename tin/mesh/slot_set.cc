#include "tin/mesh/slot_set.h"

#include <bit>

#include "tin/base/check.h"

namespace tin::mesh {

/// The i-th word of level 0 has a bit now.
void SlotSet::add_above(std::uint32_t i) {
  for (std::size_t level = 1; level < levels_.size(); ++level) {
    std::uint64_t& word = levels_[level][i / 64];
    const bool known_above = word != 0;
    word |= std::uint64_t{1} << i % 64;
    if (known_above) return;
    i /= 64;
  }
}

/// Makes room for `slot`: each level twice as large as needed, and a last level of one word.
void SlotSet::grow(std::uint32_t slot) {
  std::size_t words = 2 * (std::size_t{slot} / 64 + 1);
  for (std::size_t level = 0;; ++level) {
    if (level == levels_.size()) {
      levels_.emplace_back();
      levels_.back().resize(words);
      if (level > 0) {
        for (std::size_t i = 0; i < levels_[level - 1].size(); ++i) {
          if (levels_[level - 1][i] != 0) levels_[level][i / 64] |= std::uint64_t{1} << i % 64;
        }
      }
    } else if (levels_[level].size() < words) {
      levels_[level].resize(words);
    }
    if (words == 1) return;
    words = (words + 63) / 64;
  }
}

std::uint32_t SlotSet::take_near(std::uint32_t wanted) {
  TIN_DCHECK(size_ > 0);
  std::uint32_t slot = in_word_of(wanted);
  if (slot == kNothing) slot = next_from(wanted);
  if (slot == kNothing) slot = next_from(0);
  erase(slot);
  return slot;
}

std::uint32_t SlotSet::in_word_of(std::uint32_t wanted) const {
  if (wanted / 64 >= levels_[0].size()) return kNothing;
  const std::uint64_t word = levels_[0][wanted / 64];
  if (word == 0) return kNothing;
  const std::uint32_t base = wanted / 64 * 64, bit = wanted % 64;
  const std::uint64_t above = word >> bit;
  const std::uint64_t below = bit == 0 ? 0 : word << (64 - bit);
  const int up = std::countr_zero(above), down = std::countl_zero(below) + 1;
  if (above != 0 && (below == 0 || up <= down)) return base + bit + static_cast<std::uint32_t>(up);
  return base + bit - static_cast<std::uint32_t>(down);
}

/// The smallest slot >= `wanted`: up the tree until a word has a bit further on, then down its lowest bits.
std::uint32_t SlotSet::next_from(std::uint32_t wanted) const {
  std::uint64_t i = wanted;
  for (std::size_t level = 0; level < levels_.size(); ++level) {
    if (i / 64 >= levels_[level].size()) return kNothing;
    const std::uint64_t word = levels_[level][i / 64] >> i % 64;
    if (word != 0) {
      i += static_cast<std::uint64_t>(std::countr_zero(word));
      while (level-- > 0) i = i * 64 + static_cast<std::uint64_t>(std::countr_zero(levels_[level][i]));
      return static_cast<std::uint32_t>(i);
    }
    i = i / 64 + 1;
  }
  return kNothing;
}

void SlotSet::erase(std::uint32_t slot) {
  --size_;
  std::uint32_t i = slot;
  for (Words& words : levels_) {
    std::uint64_t& word = words[i / 64];
    word &= ~(std::uint64_t{1} << i % 64);
    if (word != 0) return;
    i /= 64;
  }
}

void SlotSet::clear() {
  levels_.clear();
  size_ = 0;
}

std::size_t SlotSet::bytes() const {
  std::size_t sum = 0;
  for (const Words& words : levels_) sum += words.capacity() * sizeof(std::uint64_t);
  return sum;
}

}  // namespace tin::mesh
