#include "tin/frame/frame.h"

#include <cmath>

namespace tin::frame {

base::Result<exact::Point> Frame::to_lattice(double world_x, double world_y) const {
  if (!std::isfinite(world_x) || !std::isfinite(world_y)) {
    return base::error(base::Code::kNotFinite, "A coordinate is not a finite number");
  }
  const double at_x = x.lattice(world_x);
  const double at_y = y.lattice(world_y);
  constexpr double kBeyond = static_cast<double>(exact::kLatticeHalf) + 1;
  if (std::abs(at_x) < kBeyond && std::abs(at_y) < kBeyond) {
    const std::int64_t i = std::llround(at_x);
    const std::int64_t j = std::llround(at_y);
    if (exact::in_lattice(i, j)) {
      return exact::Point{static_cast<std::int32_t>(i), static_cast<std::int32_t>(j)};
    }
  }
  return base::error(base::Code::kOutsideLattice,
                     "The position lies outside the area that this terrain can cover");
}

}  // namespace tin::frame
