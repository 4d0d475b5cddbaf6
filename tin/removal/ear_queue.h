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
#include "tin/mesh/page_allocator.h"
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
  /// In a line of memory of its own: nodes are met in the order of their ears' powers.
  struct alignas(64) Node {
    std::uint32_t previous, next;
    std::uint32_t in_set;  // index there, kNowhere if it is no ear; only while scanning
    exact::Power power;    // of the present ear at the node
  };
  struct Entry {
    double approximate;
    std::uint32_t node;  // kNowhere: no ear
  };
  static constexpr Entry kNoEar{0x1p1000, kNowhere};  // after all that are
  static constexpr std::uint32_t kScanLimit = 12;     // up to this degree a scan beats the tree

  void begin(const Star& star);
  template <class Tally>
  void shell(const Star& star, std::uint32_t stop, Tally& tally);
  template <class Tally>
  void renew(const Star& star, std::uint32_t node, bool same_start, Tally& tally);
  template <class Tally>
  bool comes_before(const Star& star, const Entry& a, const Entry& b, Tally& tally) const;
  template <class Tally>
  std::uint32_t smallest(const Star& star, Tally& tally) const;
  bool is_ear(std::uint32_t node) const;
  void put(const Entry& entry);
  void withdraw(std::uint32_t node);
  template <class Tally>
  void play(const Star& star, std::size_t match, Tally& tally);
  template <class Tally>
  void settle(const Star& star, std::uint32_t a, std::uint32_t b, std::uint32_t c, Tally& tally);
  void fetch_ahead(const Star& star) const;
  void cut(std::uint32_t node);

  Renewal renewal_;
  std::uint32_t left_ = 0;
  std::uint32_t some_node_ = 0;  // a node that is still there
  mesh::PageVector<Node> ring_;
  std::vector<exact::PowerMinors> minors_;  // by node, of the ear's first two corners; only when updating
  std::vector<Entry> set_;                  // the ears, while scanning
  /// The priority queue of large holes, a tournament: node n's ear stands in leaves_ + n, and every inner
  /// place holds the winner of the two below it. What an ear meets on its way to the top depends on its node
  /// alone, so the ways of neighbours, which change together, soon become one, and memory is asked for all of
  /// it at once; a heap's entries move, and each tells its node where to, anywhere in memory.
  mesh::PageVector<Entry> tree_;
  std::size_t leaves_ = 0;  // a power of two; 0: scanning
  std::vector<Ear> ears_;
  std::vector<std::uint32_t> remains_;
};

}  // namespace tin::removal
