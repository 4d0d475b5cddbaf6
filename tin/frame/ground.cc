#include "tin/frame/ground.h"

#include <GeographicLib/Constants.hpp>
#include <GeographicLib/Geodesic.hpp>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace tin::frame {

namespace {
constexpr double kRadian = std::numbers::pi / 180;
}

Ground::Ground(const Frame& frame, const GroundScale& scale)
    : x_(frame.x),
      y_(frame.y),
      geographic_(scale.geographic),
      vertical_m_(frame.vertical_unit_m),
      fixed_{frame.x.step() * scale.unit_m, frame.y.step() * scale.unit_m} {}

StepLengths Ground::steps_at(double y) const {
  if (!geographic_) return fixed_;
  const DegreeLengths degree = degree_lengths(latitude(y));
  return {x_.step() * degree.lon_m, y_.step() * degree.lat_m};
}

double Ground::distance(Place a, Place b) const {
  if (!geographic_) return std::hypot((b.x - a.x) * fixed_.x, (b.y - a.y) * fixed_.y);
  const auto on_globe = [](double degrees) { return std::clamp(degrees, -90.0, 90.0); };
  double metres = 0;
  GeographicLib::Geodesic::WGS84().Inverse(on_globe(latitude(a.y)), x_.world(a.x), on_globe(latitude(b.y)),
                                           x_.world(b.x), metres);
  return metres;
}

double Ground::area_at(double y) const {
  if (!geographic_) return fixed_.x * fixed_.y;
  // The product of the meridional radius of curvature and the radius of the circle of latitude:
  // a^2 (1 - e^2) cos / (1 - e^2 sin^2)^2.
  using Constants = GeographicLib::Constants;
  static const double a = Constants::WGS84_a(), f = Constants::WGS84_f();
  static const double e2 = f * (2 - f);
  const double degrees = latitude(y);
  if (std::abs(degrees) >= 90) return 0;
  const double sine = std::sin(degrees * kRadian), cosine = std::cos(degrees * kRadian);
  const double curved = 1 - e2 * sine * sine;
  return a * a * (1 - e2) * cosine / (curved * curved) * (x_.step() * kRadian) * (y_.step() * kRadian);
}

}  // namespace tin::frame
