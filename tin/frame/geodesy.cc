#include <GeographicLib/Ellipsoid.hpp>
#include <algorithm>
#include <numbers>

#include "tin/frame/frame.h"

namespace tin::frame {

DegreeLengths degree_lengths(double latitude_deg) {
  constexpr double kNearestToPole = 89;
  constexpr double kRadian = std::numbers::pi / 180;
  const double latitude = std::clamp(latitude_deg, -kNearestToPole, kNearestToPole);
  const GeographicLib::Ellipsoid& wgs84 = GeographicLib::Ellipsoid::WGS84();
  return {wgs84.CircleRadius(latitude) * kRadian, wgs84.MeridionalCurvatureRadius(latitude) * kRadian};
}

}  // namespace tin::frame
