// How far a sample is from a triangle, vertically, and whether that is within a tolerance: decided without
// rounding luck.
#pragma once

#include <cstdint>
#include <optional>

#include "tin/exact/point.h"
#include "tin/exact/predicates.h"

namespace tin::simplify {

/// floor(value * 2^shift * area), saturated at 2^120. Requires: value finite and >= 0, area in [0, 2^62).
exact::Int128 floor_product(double value, int shift, std::int64_t area);

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
  struct Verdict {
    double error = 0;    // vertical distance, rounded: 0 if it is 0, and not above the tolerance when within
    bool within = true;  // exact: |interpolated - z| <= tolerance
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
  Verdict judge(Weights w, double z, double tolerance) const {
    const double from_b = (b_.z - a_.z) * static_cast<double>(w.b),
                 from_c = (c_.z - a_.z) * static_cast<double>(w.c);
    const double own = rounded_area_ * (z - a_.z);
    const double distance = magnitude(from_b + from_c - own), limit = tolerance * rounded_area_;
    // Each of the three terms was rounded three times, their sum twice, the limit twice, and the difference
    // below once: 2^-49 is more than twice what that can come to. Where something overflows, no comparison
    // holds.
    const double noise = 0x1p-49 * (magnitude(from_b) + magnitude(from_c) + magnitude(own));
    const double slack = noise + 0x1p-49 * limit;
    if (distance - limit <= -slack && (distance > noise || distance == 0)) {
      return {smaller(distance / rounded_area_, tolerance), true};
    }
    if (distance - limit > slack && slack < kHuge) return {distance / rounded_area_, false};
    return judge_exactly(w, z, tolerance);
  }

  /// The same by integers where they suffice, else by rationals.
  Verdict judge_exactly(Weights w, double z, double tolerance) const;

 private:
  static constexpr double kHuge = 0x1p+1000;
  static double magnitude(double x) { return x < 0 ? -x : x; }
  static double smaller(double x, double y) { return y < x ? y : x; }
  std::optional<Verdict> judge_by_integers(Weights w, double z, double tolerance) const;
  Verdict judge_by_rationals(Weights w, double z, double tolerance) const;

  Corner a_, b_, c_;   // counter-clockwise
  std::int64_t area_;  // twice
  double rounded_area_;
};

}  // namespace tin::simplify
