// The surface along a line, and whether one place can be seen from another.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "tin/base/result.h"
#include "tin/frame/ground.h"
#include "tin/query/voids.h"
#include "tin/terrain/terrain.h"

namespace tin::query {

struct ProfilePoint {
  double distance = 0;  // metres on the ground from the line's start, along the line
  frame::Place at;
  /// In the vertical unit; nothing: there is no surface from here to the next point (outside the hull, void).
  std::optional<double> z;
  friend bool operator==(const ProfilePoint&, const ProfilePoint&) = default;
};

/// The profile along a line of lattice points: its own points, and every place where it crosses an edge or
/// passes a vertex of the TIN, so that between two points with elevations the surface is straight. Where the
/// surface ends or has a gap, a point without elevation follows at the same place. Equal for every history of
/// the same set. Errors: kInvalidValue (an empty line), kTooLarge (more than `max_points`). Cost:
/// O(crossings), for each segment that starts outside also the hull's size; geodesic distances 1 us each.
base::Result<std::vector<ProfilePoint>> profile(const terrain::Terrain& terrain, const frame::Ground& ground,
                                                std::span<const exact::Point> line, Voids voids,
                                                std::size_t max_points);

struct SightRequest {
  exact::Point observer, target;
  double observer_height = 0, target_height = 0;  // above the surface, in the vertical unit
  bool curvature = false;    // whether the earth falls away from the horizontal, on a sphere of 6371008.8 m
  double refraction = 0.13;  // how much of that the bending of light takes back; used with `curvature`
  Voids voids = Voids::kKeep;
};

/// A place where the ground comes into the line of sight, or nearest to it.
struct SightPoint {
  double distance = 0;  // metres from the observer
  frame::Place at;
  double z = 0;          // of the surface
  double clearance = 0;  // of the line of sight above it; both in the vertical unit
};

struct Sight {
  bool visible = false;
  double distance = 0;                   // metres between observer and target on the ground
  double observer_z = 0, target_z = 0;   // with their heights
  std::optional<SightPoint> blocked_at;  // where the ground first rises above the line
  SightPoint closest;                    // where the clearance is least; negative when blocked
  bool crosses_gap = false;  // the line runs outside the surface or over a void: nothing there blocks it
};

/// Whether the target can be seen. Touching the ground does not block; clearances within 1e-9 of the
/// elevations count as touching. With curvature the clearance is exact also between crossings, where the
/// ground bulges. Errors: kInvalidValue at "observer" or "target" when there is no surface; kTooLarge as
/// profile().
base::Result<Sight> line_of_sight(const terrain::Terrain& terrain, const frame::Ground& ground,
                                  const SightRequest& request, std::size_t max_points);

}  // namespace tin::query
