// Which heights a corner of a triangle may have, when each sample over it must stay within a tolerance.
#pragma once

#include <algorithm>
#include <cstdint>

#include "tin/exact/predicates.h"
#include "tin/simplify/samples.h"

namespace tin::simplify {

/// A sample of height z, where the corner's weight is `own` and the others make up `rest`, both times the
/// area, allows the corner what lies between (area * (z - tolerance) - rest) / own and (area * (z +
/// tolerance) - rest) / own. The strictest quotients are found without dividing.
class Narrowing {
 public:
  Narrowing(double area, double tolerance) : area_(area), reach_(area * tolerance) {}

  void take(double own, double rest, double z) {
    if (!(own > 0)) return;
    const double at = area_ * z - rest, above = at + reach_, below = at - reach_;
    if (above * high_weight_ < high_ * own) {
      high_ = above;
      high_weight_ = own;
    }
    if (below * low_weight_ > low_ * own) {
      low_ = below;
      low_weight_ = own;
    }
  }
  bool any() const { return low_ * high_weight_ <= high_ * low_weight_; }
  /// Requires: heights taken were times `scale`.
  void narrow(Heights& heights, double scale = 1) const {
    if (high_weight_ > 0) heights.high = std::min(heights.high, high_ / high_weight_ / scale);
    if (low_weight_ > 0) heights.low = std::max(heights.low, low_ / low_weight_ / scale);
  }

 private:
  double area_, reach_;
  // As fractions; at first 1/0 and -1/0.
  double high_ = 1, high_weight_ = 0, low_ = -1, low_weight_ = 0;
};

/// The same over a triangle of lattice points, for samples anywhere.
class LatticeNarrowing {
 public:
  /// Requires: not collinear.
  LatticeNarrowing(const Site& a, const Site& b, const Site& c, double tolerance)
      : a_(a), b_(b), c_(c), area_(exact::orientation(a.at, b.at, c.at)) {
    if (area_ < 0) {
      std::swap(b_, c_);
      area_ = -area_;
    }
    found_ = Narrowing(static_cast<double>(area_), tolerance);
  }

  void take(exact::Point p, double z) {
    const std::int64_t b = exact::orientation(c_.at, a_.at, p), c = exact::orientation(a_.at, b_.at, p);
    if (b < 0 || c < 0 || area_ - b - c < 0) return;
    found_.take(static_cast<double>(area_ - b - c),
                static_cast<double>(b) * b_.z + static_cast<double>(c) * c_.z, z);
  }
  bool any() const { return found_.any(); }
  void narrow(Heights& heights) const { found_.narrow(heights); }

 private:
  Site a_, b_, c_;
  std::int64_t area_;
  Narrowing found_{1, 0};
};

}  // namespace tin::simplify
