// The triangulation of a part of the link while it grows by one vertex after another: what `flip` and `chew`
// share.
//
// A new vertex m comes in over the edge between its neighbours: the triangles there whose circles hold m make
// way for the star of m. They form a tree, so each is asked once. In terms of flips: the edges of these
// triangles are turned around to m, and m ends up with them. Triangles need not be planar; see
// Star::in_conflict.
//
// Of a large link little is in the caches at a time. Each vertex brings one triangle, which is stored in the
// vertex's place, so work that follows the link follows memory. Tests use differences to m, which are
// computed once per vertex.
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

  /// Inserts position `m` between `before` and its present successor. Cost: the number of triangles that make
  /// way.
  template <class Tally>
  void insert(const Star& star, std::uint32_t before, std::uint32_t m, Tally& tally);

  /// Asks memory for what the insertion of `m` needs first.
  void prefetch(const Star& star, std::uint32_t before, std::uint32_t m) const {
    __builtin_prefetch(&star.at(m));
    __builtin_prefetch(&edges_[before]);
    __builtin_prefetch(&triangles_[m]);
  }

  /// Appends the triangles as ears, in an order in which they can be cut.
  void append_ears(std::vector<Ear>& ears);

 private:
  /// Side j of triangle t as 4 t + j, opposite to corner j; kNowhere beyond the polygon's own edges.
  using Side = std::uint32_t;
  struct Triangle {
    std::array<std::uint32_t, 3> corners;
    std::array<Side, 3> twins;
  };
  /// A corner of the cavity as seen from m; the infinite vertex stands straight up.
  struct Corner {
    std::int64_t x, y, z;
    std::uint32_t position;
  };
  /// An edge of the cavity as it was at some time, and the side beyond it.
  struct Edge {
    std::int64_t cross;
    Side beyond;
    std::uint32_t from, to;  // in corners_
  };
  /// By corner, the last edge that began there.
  struct Rim {
    Side beyond;
    std::uint32_t to;
  };

  template <class Tally>
  std::size_t find_cavity(const Star& star, std::uint32_t before, std::uint32_t m, Tally& tally);
  static void see(const Star& star, std::uint32_t position, std::uint32_t m, Corner& corner);
  void enlarge();
  std::uint32_t from(Side s) const { return triangles_[s >> 2].corners[kNext[s & 3]]; }
  std::uint32_t to(Side s) const { return triangles_[s >> 2].corners[kPrevious[s & 3]]; }
  void link(Side a, Side b);

  static constexpr std::array<std::uint32_t, 3> kNext{1, 2, 0}, kPrevious{2, 0, 1};

  std::vector<Triangle> triangles_;  // by position of the vertex that brought them
  std::vector<Side> edges_;          // by position: the side on the polygon's edge that starts there
  std::uint32_t first_ = 0;          // a triangle

  // The cavity: with t triangles there are t + 2 corners and 2 t + 1 edges.
  std::size_t room_ = 0;
  std::vector<std::uint32_t> cavity_;
  std::vector<Corner> corners_;
  std::vector<Edge> to_cross_;
  std::vector<Rim> rim_;
  std::vector<Side> stack_;
};

}  // namespace tin::removal
