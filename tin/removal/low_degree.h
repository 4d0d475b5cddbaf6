// Small holes (after Devillers, "Vertex removal in two dimensional Delaunay triangulation: speed-up by low
// degrees optimization", CGTA 2011). Almost every vertex of a random triangulation has a low degree (97 % are
// below nine).
//
// What a test finds is as good as random, and a branch on it is mispredicted every other time, which costs
// more than a test. So little here branches: the corner over an edge is found by a tournament, and a pentagon
// is one of five fans, looked up.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "tin/removal/star.h"

namespace tin::removal {

/// Fills stars, and chains of link positions with their closing edge, by edge completion (Devillers 2002,
/// section 4.1.2) down to pentagons. In-circle tests: none, 1, 3, 3 to 6, 5 to 10 for three to seven corners;
/// (k - 2) (k - 3) / 2 at most.
template <class Tally>
class LowDegree {
 public:
  /// Appends to `out`, which has room for the ears: two less than there are corners.
  LowDegree(const Star& star, Ear* out, Tally& tally) : star_(star), out_(out), tally_(tally) {}

  void fill_star() { fill(0, star_.degree() - 1); }

 private:
  /// Every corner but `first` and `last` is cut off.
  void fill(std::uint32_t first, std::uint32_t last) {
    switch (last - first) {
      case 0:
      case 1: return;
      case 2: return triangle(first, first + 1, last);
      case 3: return quadrilateral(first);
      case 4: return pentagon(first);
      case 5: return hexagon(first);
      case 6: return heptagon(first);
      default: break;
    }
    const std::uint32_t middle = first + (last - first) / 2;
    const std::uint32_t left = tournament(first, last, first + 1, middle);
    const std::uint32_t apex = better(first, last, left, tournament(first, last, middle, last));
    fill(first, apex);
    fill(apex, last);
    triangle(first, apex, last);
  }

  void triangle(std::uint32_t a, std::uint32_t b, std::uint32_t c) { *out_++ = {a, b, c}; }

  void quadrilateral(std::uint32_t a) {
    const std::uint32_t turned = holds(a, a + 1, a + 2, a + 3) ? 1 : 0;
    triangle(a + turned, a + 1 + turned, a + 2 + turned);
    triangle(a, a + 2 - turned, a + 3);
  }

  /// The last corner is put into the triangulation of the other four: it sees the triangle on its side, and
  /// perhaps the other one.
  void pentagon(std::uint32_t a) {
    const std::uint32_t turned = holds(a, a + 1, a + 2, a + 3) ? 1 : 0;
    const std::uint32_t near = holds(a, a + 2 - turned, a + 3, a + 4) ? 1 : 0;
    const std::uint32_t far = holds(a + turned, a + 1 + turned, a + 2 + turned, a + 4) ? 1 : 0;
    for (const auto& ear : kFans[turned + 2 * near + 4 * far]) triangle(a + ear[0], a + ear[1], a + ear[2]);
  }

  void hexagon(std::uint32_t a) {
    const std::uint32_t f = a + 5;
    const std::uint32_t apex = better(a, f, better(a, f, a + 1, a + 2), better(a, f, a + 3, a + 4));
    if (apex == a + 1 || apex == f - 1) {
      pentagon(apex == a + 1 ? apex : a);
    } else {
      const bool is_left = apex == a + 2;
      triangle(is_left ? a : apex, is_left ? a + 1 : a + 4, is_left ? apex : f);
      quadrilateral(is_left ? apex : a);
    }
    triangle(a, apex, f);
  }

  void heptagon(std::uint32_t a) {
    const std::uint32_t g = a + 6;
    const std::uint32_t outer = better(a, g, better(a, g, a + 1, a + 2), better(a, g, a + 4, a + 5));
    const std::uint32_t apex = better(a, g, outer, a + 3);
    if (apex == a + 3) {
      quadrilateral(a);
      quadrilateral(apex);
    } else if (apex == a + 1 || apex == g - 1) {
      hexagon(apex == a + 1 ? apex : a);
    } else {
      const bool is_left = apex == a + 2;
      triangle(is_left ? a : apex, is_left ? a + 1 : a + 5, is_left ? apex : g);
      pentagon(is_left ? apex : a);
    }
    triangle(a, apex, g);
  }

  /// Of the corners from `begin` to before `end` the one that makes a Delaunay triangle with the edge from
  /// `last` to `first`, if one of them does.
  std::uint32_t tournament(std::uint32_t first, std::uint32_t last, std::uint32_t begin, std::uint32_t end) {
    std::uint32_t apex = begin;
    for (std::uint32_t i = begin + 1; i < end; ++i) apex = better(first, last, apex, i);
    return apex;
  }

  /// Which of two corners makes a triangle with the edge whose circle does not hold the other.
  std::uint32_t better(std::uint32_t first, std::uint32_t last, std::uint32_t i, std::uint32_t j) {
    const std::uint32_t holds_j = holds(first, i, last, j) ? 0xffffffffU : 0;
    return i ^ ((i ^ j) & holds_j);
  }

  bool holds(std::uint32_t i, std::uint32_t j, std::uint32_t k, std::uint32_t l) {
    return star_.in_conflict(i, j, k, l, tally_);
  }

  using Fan = std::array<std::array<std::uint8_t, 3>, 3>;
  static constexpr Fan kFromA{{{0, 1, 2}, {0, 2, 3}, {0, 3, 4}}}, kFromB{{{1, 2, 3}, {1, 3, 4}, {0, 1, 4}}},
      kFromC{{{0, 1, 2}, {2, 3, 4}, {0, 2, 4}}}, kFromD{{{1, 2, 3}, {0, 1, 3}, {0, 3, 4}}},
      kFromE{{{2, 3, 4}, {1, 2, 4}, {0, 1, 4}}};
  static constexpr std::array<Fan, 8> kFans{kFromA, kFromD, kFromC, kFromB, kFromA, kFromD, kFromE, kFromE};

  const Star& star_;
  Ear* out_;
  Tally& tally_;
};

}  // namespace tin::removal
