// The free slots of an array, as bits in a tree of 64-bit words: taking the one nearest to a wanted place
// keeps what is near on the ground near in memory through any history of edits, at an eighth of a byte per
// slot.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace tin::mesh {

class SlotSet {
 public:
  static constexpr std::uint32_t kNothing = 0xffffffffU;

  bool empty() const { return size_ == 0; }
  std::size_t size() const { return size_; }
  std::size_t bytes() const;

  /// Requires: not in the set.
  void add(std::uint32_t slot) {
    if (levels_.empty() || slot / 64 >= levels_[0].size()) [[unlikely]] grow(slot);
    ++size_;
    std::uint64_t& word = levels_[0][slot / 64];
    const bool known_above = word != 0;
    word |= std::uint64_t{1} << slot % 64;
    if (!known_above) add_above(slot / 64);
  }
  /// Takes a slot out: the nearest among the 64 around `wanted`, else the next above, else the lowest.
  /// Requires: not empty. Cost: O(log64 of the largest slot).
  std::uint32_t take_near(std::uint32_t wanted);
  void clear();

 private:
  using Words = std::vector<std::uint64_t>;

  void grow(std::uint32_t slot);
  void add_above(std::uint32_t word);
  std::uint32_t in_word_of(std::uint32_t wanted) const;
  std::uint32_t next_from(std::uint32_t wanted) const;
  void erase(std::uint32_t slot);

  std::vector<Words> levels_;  // bit i of level l + 1: word i of level l has a bit
  std::size_t size_ = 0;
};

}  // namespace tin::mesh
