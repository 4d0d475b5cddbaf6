#include <algorithm>
#include <cmath>

#include "tin/query/elevation.h"
#include "tin/query/profile.h"

namespace tin::query {

using base::Code;
using base::error;
using base::Result;
using frame::Place;

namespace {

constexpr double kEarthRadius = 6'371'008.8;  // mean radius R1 of the ellipsoid's axes, in metres

/// The line between two eyes, seen from a ground that is straight (and bulges in between, with curvature).
class SightLine {
 public:
  SightLine(double from_z, double to_z, double distance, double bulge)
      : from_z_(from_z),
        rise_(distance > 0 ? (to_z - from_z) / distance : 0),
        distance_(distance),
        bulge_(bulge) {}

  /// Of a point at this distance with this elevation.
  double clearance(double d, double z) const {
    return from_z_ + rise_ * d - z - bulge_ * d * (distance_ - d);
  }
  /// Where between a and b the clearance is least.
  double lowest(const ProfilePoint& a, const ProfilePoint& b) const {
    const double slope = (*b.z - *a.z) / (b.distance - a.distance);
    const double at = bulge_ > 0 ? distance_ / 2 + (slope - rise_) / (2 * bulge_) : a.distance;
    if (at > a.distance && at < b.distance) return at;
    return clearance(a.distance, *a.z) <= clearance(b.distance, *b.z) ? a.distance : b.distance;
  }

 private:
  double from_z_, rise_, distance_, bulge_;
};

double z_between(const ProfilePoint& a, const ProfilePoint& b, double d) {
  if (d == a.distance) return *a.z;
  if (d == b.distance) return *b.z;
  return *a.z + (*b.z - *a.z) * (d - a.distance) / (b.distance - a.distance);
}

SightPoint sight_point(const SightLine& line, const ProfilePoint& a, const ProfilePoint& b, double d) {
  const double part = b.distance > a.distance ? (d - a.distance) / (b.distance - a.distance) : 0;
  const double z = z_between(a, b, d);
  return {d, {a.at.x + part * (b.at.x - a.at.x), a.at.y + part * (b.at.y - a.at.y)}, z, line.clearance(d, z)};
}

/// Where the clearance falls below `least` between a (where it has not) and the lowest place after it.
double first_below(const SightLine& line, const ProfilePoint& a, const ProfilePoint& b, double lowest,
                   double least) {
  double above = a.distance, below = lowest;
  if (line.clearance(above, *a.z) < least) return above;
  for (int i = 0; i < 200 && above < below; ++i) {
    const double middle = (above + below) / 2;
    if (middle == above || middle == below) break;
    (line.clearance(middle, z_between(a, b, middle)) < least ? below : above) = middle;
  }
  return below;
}

}  // namespace

Result<Sight> line_of_sight(const terrain::Terrain& terrain, const frame::Ground& ground,
                            const SightRequest& request, std::size_t max_points) {
  ElevationQuery query(terrain, request.voids);
  const auto from = query.at(request.observer), to = query.at(request.target);
  if (!from) return error(Code::kInvalidValue, "There is no surface at the observer.", "observer");
  if (!to) return error(Code::kInvalidValue, "There is no surface at the target.", "target");
  const std::array ends{request.observer, request.target};
  const auto points = profile(terrain, ground, ends, request.voids, max_points);
  if (!points) return points.error();

  Sight sight;
  sight.distance = points->back().distance;
  sight.observer_z = from->z + request.observer_height;
  sight.target_z = to->z + request.target_height;
  const double bulge =
      request.curvature ? (1 - request.refraction) / (2 * kEarthRadius) / ground.vertical_m() : 0;
  const SightLine line(sight.observer_z, sight.target_z, sight.distance, bulge);
  const double touch = -1e-9 * std::max({1.0, std::abs(sight.observer_z), std::abs(sight.target_z)});
  const ProfilePoint& first = points->front();
  sight.closest = {0, first.at, from->z, request.observer_height};
  for (std::size_t i = 1; i < points->size(); ++i) {
    const ProfilePoint &a = (*points)[i - 1], &b = (*points)[i];
    sight.crosses_gap = sight.crosses_gap || !a.z || !b.z;
    if (!a.z || !b.z) continue;
    const double lowest = line.lowest(a, b);
    const SightPoint here = sight_point(line, a, b, lowest);
    if (here.clearance < sight.closest.clearance) sight.closest = here;
    if (here.clearance < touch && !sight.blocked_at) {
      sight.blocked_at = sight_point(line, a, b, first_below(line, a, b, lowest, touch));
    }
  }
  // A gap may end in the target alone.
  const double at_target = request.target_height;
  if (at_target < sight.closest.clearance)
    sight.closest = {sight.distance, points->back().at, to->z, at_target};
  sight.visible = !sight.blocked_at;
  return sight;
}

}  // namespace tin::query
