// The ear queue: the paper's algorithm (Devillers, "On Deletion in Delaunay Triangulations", IJCGA 2002,
// section 2.4), exact and canonical.
//
// Ears of the hole are cut off in the order in which an observer who rises from the lifted removed vertex
// crosses their planes: the smallest |power| first. (The paper's algorithm takes the minimum of -power, its
// lemma speaks of the maximum: the algorithm is right.) With the infinite vertex in the link all finite
// convex ears go in power order, and what is left is the new hull.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "tin/exact/power.h"
#include "tin/removal/star.h"

namespace tin::removal {

/// How a neighbour's power is found when an ear was cut off and one of its corners changed.
enum class Renewal {
  kCompute,  // anew, both neighbours: 3k - 8 computations at most
  kUpdate,   // section 3.2: the previous ear keeps two corners, and only its third is put in: k - 4 of them
             // are updates
};

class EarQueue {
 public:
  explicit EarQueue(Renewal renewal) : renewal_(renewal) {}

  /// Cuts ears off the hole until `stop` vertices are left (3: until it is filled), or, on the hull, until no
  /// finite ear is; then closes the hull. Cost: O(k log k) for degree k. Ears and remains are valid until the
  /// next call. Requires: stop >= 3; the star does not leave a line.
  template <class Tally>
  void run(const Star& star, std::uint32_t stop, Tally& tally);

  std::vector<Ear>& ears() { return ears_; }
  /// Positions left, in order, when run() stopped early; the hole is filled when it is empty.
  std::span<const std::uint32_t> remains() const { return remains_; }

 private:
  struct Node {
    std::uint32_t previous, next;
    std::uint32_t in_heap;  // index there, kNowhere if it is no ear
  };
  /// The present ear at a node, with its corners as they were when its power was found: between the renewals
  /// of two neighbours one of them is out of date, and the heap's order must not break.
  struct Candidate {
    exact::Power power;
    std::uint32_t previous, next;
  };
  struct Entry {
    double approximate;
    std::uint32_t node;
  };
  /// Each entry that moves writes to its node, wherever that is: a flat heap moves fewer.
  static constexpr std::size_t kArity = 4;
  static constexpr std::uint32_t kScanLimit = 12;  // up to this degree a scan beats the heap

  void begin(const Star& star);
  template <class Tally>
  void shell(const Star& star, std::uint32_t stop, Tally& tally);
  template <class Tally>
  void renew(const Star& star, std::uint32_t node, bool same_start, Tally& tally);
  template <class Tally>
  bool comes_before(const Star& star, const Entry& a, const Entry& b, Tally& tally) const;
  template <class Tally>
  std::uint32_t smallest(const Star& star, Tally& tally) const;
  template <class Tally>
  void place(const Star& star, const Entry& entry, Tally& tally);
  template <class Tally>
  void drop(const Star& star, std::uint32_t node, Tally& tally);
  template <class Tally>
  void sift(const Star& star, std::size_t hole, const Entry& entry, Tally& tally);
  template <class Tally>
  std::size_t climb(const Star& star, std::size_t hole, std::size_t top, const Entry& entry, Tally& tally);
  void put(std::size_t i, const Entry& entry);
  void cut(std::uint32_t node);

  Renewal renewal_;
  bool use_heap_ = false;
  std::uint32_t left_ = 0;
  std::uint32_t some_node_ = 0;  // a node that is still there
  std::vector<Node> ring_;
  std::vector<Candidate> candidates_;       // by node
  std::vector<exact::PowerMinors> minors_;  // by node, of the ear's first two corners; only when updating
  std::vector<Entry> heap_;                 // a heap, or just a set while scanning is cheaper
  std::vector<Ear> ears_;
  std::vector<std::uint32_t> remains_;
};

}  // namespace tin::removal
