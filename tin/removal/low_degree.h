// Holes of three to seven corners, by decision trees of in-circle tests written out (Devillers, "Vertex removal in two
// dimensional Delaunay triangulation: speed-up by low degrees optimization", CGTA 2011). Almost every vertex of a random
// triangulation has such a degree (97 % are below nine).
#pragma once

#include <cstdint>
#include <span>

#include "tin/removal/star.h"

namespace tin::removal {

/// Degrees up to this one are filled by LowDegree.
inline constexpr std::uint32_t kLowDegreeLimit = 7;

/// Fills the chains of link positions it is given, each with its closing edge, and collects the ears: every corner but a
/// chain's first and last is cut off. Tests made: none, 1, 2 or 3, 4 to 6 for three to six corners.
template <class Tally>
class LowDegree {
 public:
  /// Appends to `out`, which has room for the ears: two less than there are corners.
  LowDegree(const Star& star, Ear* out, Tally& tally) : star_(star), out_(out), tally_(tally) {}

  /// Fills the whole star. Requires: 3 <= degree <= kLowDegreeLimit.
  void fill_star() {
    switch (star_.degree()) {
      case 3: return triangle(0, 1, 2);
      case 4: return quadrilateral(0, 1, 2, 3);
      case 5: return pentagon(0, 1, 2, 3, 4);
      case 6: return hexagon(0, 1, 2, 3, 4, 5);
      default: return heptagon(0, 1, 2, 3, 4, 5, 6);
    }
  }

  void triangle(std::uint32_t a, std::uint32_t b, std::uint32_t c) { *out_++ = {a, b, c}; }

  void quadrilateral(std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
    if (holds(a, b, c, d)) {
      triangle(b, c, d);
      triangle(a, b, d);
    } else {
      triangle(a, b, c);
      triangle(a, c, d);
    }
  }

  /// e is put into the triangulation of the other four: it sees the triangle on da, and perhaps the other one.
  void pentagon(std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d, std::uint32_t e) {
    if (holds(a, b, c, d)) {
      if (!holds(a, b, d, e)) return emit({b, c, d}, {a, b, d}, {a, d, e});
      if (!holds(b, c, d, e)) return emit({b, c, d}, {b, d, e}, {a, b, e});
    } else {
      if (!holds(a, c, d, e)) return emit({a, b, c}, {a, c, d}, {a, d, e});
      if (!holds(a, b, c, e)) return emit({a, b, c}, {c, d, e}, {a, c, e});
    }
    emit({c, d, e}, {b, c, e}, {a, b, e});
  }

  /// The corner over the edge fa comes first: what is left on both sides has three to five corners.
  void hexagon(std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d, std::uint32_t e, std::uint32_t f) {
    const std::uint32_t left = holds(a, b, f, c) ? c : b;
    const std::uint32_t right = holds(a, d, f, e) ? e : d;
    if (!holds(a, left, f, right)) {
      if (left == b) {
        pentagon(b, c, d, e, f);
      } else {
        triangle(a, b, c);
        quadrilateral(c, d, e, f);
      }
      return triangle(a, left, f);
    }
    if (right == e) {
      pentagon(a, b, c, d, e);
    } else {
      quadrilateral(a, b, c, d);
      triangle(d, e, f);
    }
    triangle(a, right, f);
  }

  void heptagon(std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d, std::uint32_t e, std::uint32_t f,
                std::uint32_t g) {
    std::uint32_t apex = holds(a, b, g, c) ? c : b;
    const std::uint32_t right = holds(a, e, g, f) ? f : e;
    if (holds(a, apex, g, d)) apex = d;
    if (holds(a, apex, g, right)) apex = right;
    if (apex == b) {
      hexagon(b, c, d, e, f, g);
    } else if (apex == c) {
      triangle(a, b, c);
      pentagon(c, d, e, f, g);
    } else if (apex == d) {
      quadrilateral(a, b, c, d);
      quadrilateral(d, e, f, g);
    } else if (apex == e) {
      pentagon(a, b, c, d, e);
      triangle(e, f, g);
    } else {
      hexagon(a, b, c, d, e, f);
    }
    triangle(a, apex, g);
  }

 private:
  bool holds(std::uint32_t i, std::uint32_t j, std::uint32_t k, std::uint32_t l) {
    return star_.in_conflict(i, j, k, l, tally_);
  }
  void emit(const Ear& first, const Ear& second, const Ear& third) {
    out_[0] = first;
    out_[1] = second;
    out_[2] = third;
    out_ += 3;
  }

  const Star& star_;
  Ear* out_;
  Tally& tally_;
};

}  // namespace tin::removal
