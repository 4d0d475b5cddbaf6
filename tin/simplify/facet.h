// How far a sample is from a triangle, vertically, and whether that is within a tolerance: decided without
// rounding luck.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "tin/exact/point.h"
#include "tin/exact/predicates.h"

namespace tin::simplify {

/// floor(value * 2^shift * area), saturated at 2^120. Requires: value finite and >= 0, area in [0, 2^62).
exact::Int128 floor_product(double value, int shift, std::int64_t area);

/// What a comparison with a tolerance says.
struct Verdict {
  double error = 0;    // vertical distance, rounded: 0 if it is 0, and not above the tolerance when within
  bool within = true;  // exact
};

/// A part of a distance: weight * (plus - minus).
struct Term {
  std::int64_t weight;  // >= 0
  double plus, minus;
};
using Terms = std::array<Term, 3>;

/// |sum of the terms| / area against the tolerance, by integers where they suffice, else by rationals. Requires: weights up to
/// `area`, which is below 2^62; tolerance finite and >= 0.
Verdict judge_exactly(const Terms& terms, std::int64_t area, double tolerance);

/// The same, sooner where rounding is far from mattering.
inline Verdict judge_sum(const Terms& terms, std::int64_t area, double tolerance) {
  const auto magnitude = [](double x) { return x < 0 ? -x : x; };
  const double a = (terms[0].plus - terms[0].minus) * static_cast<double>(terms[0].weight),
               b = (terms[1].plus - terms[1].minus) * static_cast<double>(terms[1].weight),
               c = (terms[2].plus - terms[2].minus) * static_cast<double>(terms[2].weight);
  const double rounded_area = static_cast<double>(area);
  const double distance = magnitude(a + b + c), limit = tolerance * rounded_area;
  // Each of the three terms was rounded three times, their sum twice, the limit twice, and the difference
  // below once: 2^-49 is more than twice what that can come to. Where something overflows, no comparison
  // holds.
  const double noise = 0x1p-49 * (magnitude(a) + magnitude(b) + magnitude(c));
  const double slack = noise + 0x1p-49 * limit;
  if (distance - limit <= -slack && (distance > noise || distance == 0)) {
    const double error = distance / rounded_area;
    return {tolerance < error ? tolerance : error, true};
  }
  if (distance - limit > slack && slack < 0x1p+1000) return {distance / rounded_area, false};
  return judge_exactly(terms, area, tolerance);
}

/// A triangle in space over three lattice points.
class Facet {
 public:
  struct Corner {
    exact::Point at;
    double z = 0;
  };
  /// Twice the areas that a point in the triangle makes with its sides: the barycentric coordinates, whole.
  struct Weights {
    std::int64_t b = 0, c = 0;
  };

  /// Requires: not collinear; either turn.
  Facet(Corner a, Corner b, Corner c);

  /// Nothing when `p` lies outside the closed triangle.
  std::optional<Weights> weights(exact::Point p) const {
    const std::int64_t c = exact::orientation(a_.at, b_.at, p);
    if (c < 0) return std::nullopt;
    const std::int64_t b = exact::orientation(c_.at, a_.at, p);
    if (b < 0 || area_ - b - c < 0) return std::nullopt;
    return Weights{b, c};
  }

  /// Judges a sample of height `z` where the weights are `w`. Requires: tolerance finite and >= 0.
  Verdict judge(Weights w, double z, double tolerance) const { return judge_sum(terms(w, z), area_, tolerance); }
  /// The same without a first look by floating point.
  Verdict judge_exactly(Weights w, double z, double tolerance) const {
    return simplify::judge_exactly(terms(w, z), area_, tolerance);
  }

 private:
  Terms terms(Weights w, double z) const { return {{{w.b, b_.z, a_.z}, {w.c, c_.z, a_.z}, {area_, a_.z, z}}}; }

  Corner a_, b_, c_;   // counter-clockwise
  std::int64_t area_;  // twice
};

}  // namespace tin::simplify
