#include "tests/support/stars.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace support {
namespace {

constexpr double kEccentricity = 1.7, kLargestSpread = 0.2;

/// The radius at `angle`, where neighbours are `step` apart.
double radius(StarShape shape, std::size_t i, double angle, double step, Random& random) {
  // A circle through the origin and two points at radius 1 reaches 1 + step^2 / 2 half-way when these are 2 steps apart.
  std::uniform_real_distribution<double> spread(0, std::min(kLargestSpread, step * step / 4));
  switch (shape) {
    case StarShape::kAlternating: return i % 2 == 0 ? 1 : 1 + spread(random);
    case StarShape::kRandom: return 1 + spread(random);
    case StarShape::kEllipse: return std::hypot(std::cos(angle), kEccentricity * std::sin(angle));
  }
  return 1;
}

}  // namespace

std::vector<tin::exact::Point> star_ring(StarShape shape, StarCentre centre, std::size_t degree, Random& random) {
  const auto count = static_cast<double>(degree);
  const double step = centre == StarCentre::kInside ? 2 * std::numbers::pi / count : std::numbers::pi / (count - 1);
  // As large as fits on the lattice: rounding moves the points the less.
  const double unit = 0x1p29 / (1e-6 + (shape == StarShape::kEllipse ? kEccentricity : 1 + std::min(kLargestSpread, step * step / 4)));
  std::vector<tin::exact::Point> ring;
  ring.reserve(degree);
  for (std::size_t i = 0; i < degree; ++i) {
    const double angle = static_cast<double>(i) * step;
    const double r = unit * radius(shape, i, angle, step, random);
    ring.push_back({static_cast<std::int32_t>(std::lround(r * std::cos(angle))),
                    static_cast<std::int32_t>(std::lround(r * std::sin(angle)))});
  }
  return ring;
}

}  // namespace support
