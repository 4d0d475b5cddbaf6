// The triangulation of a part of the link while it grows by one vertex after another: what `flip` and `chew` share.
//
// A new vertex m comes in over the edge between its neighbours: the triangles there whose circles hold m make way for
// the star of m. They form a tree, so each is asked once. In terms of flips: the edges of these triangles are turned
// around to m, and m ends up with them. Triangles need not be planar; see Star::in_conflict.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "tin/removal/star.h"

namespace tin::removal {

class Polygon {
 public:
  /// Starts with the triangle of three link positions in order; `degree` is the link's.
  void start(std::uint32_t degree, std::uint32_t a, std::uint32_t b, std::uint32_t c);

  /// Inserts position `m` between `before` and its present successor. Cost: the number of triangles that make way.
  template <class Tally>
  void insert(const Star& star, std::uint32_t before, std::uint32_t m, Tally& tally);

  /// Appends the triangles as ears, in an order in which they can be cut.
  void append_ears(std::vector<Ear>& ears);

 private:
  /// Side j of triangle t as 4 t + j, opposite to corner j; kNowhere beyond the polygon's own edges.
  using Side = std::uint32_t;
  struct Triangle {
    std::array<std::uint32_t, 3> corners;
    std::array<Side, 3> twins;
  };
  /// An edge around the triangles that make way, and the side beyond it.
  struct Rim {
    std::uint32_t from, to;
    Side beyond;
  };

  template <class Tally>
  void find_cavity(const Star& star, std::uint32_t before, std::uint32_t m, Tally& tally);
  std::uint32_t from(Side s) const { return triangles_[s >> 2].corners[kNext[s & 3]]; }
  std::uint32_t to(Side s) const { return triangles_[s >> 2].corners[kPrevious[s & 3]]; }
  void link(Side a, Side b);

  static constexpr std::array<std::uint32_t, 3> kNext{1, 2, 0}, kPrevious{2, 0, 1};

  std::vector<Triangle> triangles_;
  std::vector<Side> edges_;  // by position: the side on the polygon's edge that starts there
  std::vector<std::uint32_t> cavity_;
  std::vector<Rim> rim_, to_cross_;
};

}  // namespace tin::removal
