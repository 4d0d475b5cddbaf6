// Questions about the surface of a TIN and their answers: what GET, POST and processes have in common.
//
// Positions are x, y in the CRS that the question names, else in the TIN's own. Every answer says its units.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "proto/bbox.h"
#include "proto/json_read.h"
#include "proto/json_write.h"
#include "proto/messages.h"
#include "tin/query/gradient.h"
#include "tin/query/profile.h"
#include "tin/query/volume.h"

namespace proto {

// Questions ------------------------------------------------------------------------

/// "x,y,x,y,...", so many pairs at most. Errors: kMalformed, kNotFinite, kTooLarge.
tin::base::Result<std::vector<Position2>> parse_positions(std::string_view text, std::size_t max_positions,
                                                          std::string where);

/// What every question may say.
struct Manner {
  std::optional<std::string> crs;  // as parse_crs() gives it
  Voids voids = Voids::kKeep;
};

using Ring2 = std::vector<Position2>;

/// A part of the plane; at most one of the two, neither: everything.
struct AreaOfInterest {
  std::vector<Ring2> polygon;  // the outline, then holes
  std::optional<Bbox> box;
};

struct PositionsInputs {
  std::vector<Position2> positions;
  Manner manner;
};
struct SightInputs {
  Position2 observer, target;
  double observer_height = 0, target_height = 0;
  bool curvature = false;
  double refraction = 0.13;
  Manner manner;
};
struct ContourInputs {
  std::optional<double> interval;
  double base = 0;
  std::vector<double> levels;  // ascending, distinct; either these or an interval
  std::optional<Bbox> box;
  Manner manner;
};
struct AreaInputs {
  AreaOfInterest area;
  Manner manner;
};
struct VolumeInputs {
  double level = 0;
  AreaOfInterest area;
  Manner manner;
};

/// Members of a JSON object that is the question (or has it among others, which are not looked at). Errors:
/// kMalformed, kNotFinite, kInvalidValue, kTooLarge.
tin::base::Result<PositionsInputs> read_positions_inputs(const Object& object, std::size_t max_positions);
tin::base::Result<SightInputs> read_sight_inputs(const Object& object);
tin::base::Result<ContourInputs> read_contour_inputs(const Object& object, std::size_t max_levels);
tin::base::Result<AreaInputs> read_area_inputs(const Object& object, std::size_t max_positions);
tin::base::Result<VolumeInputs> read_volume_inputs(const Object& object, std::size_t max_positions);

/// Checks that hold for GET as well. Errors: kInvalidValue at `where` + the member's name.
tin::base::Result<void> check_contour_inputs(const ContourInputs& inputs, std::size_t max_levels,
                                             const std::string& where);
tin::base::Result<void> check_sight_inputs(const SightInputs& inputs, const std::string& where);

// Answers -------------------------------------------------------------------------

/// What lengths are counted in: metres, or for TINs in a local CRS the unit of that, which nobody knows.
struct Units {
  bool metres = true;
  std::string vertical;  // name of the unit of elevations; empty: not known
};

std::string slope_json(const std::optional<tin::query::Gradient>& gradient, std::uint64_t revision);
std::string slopes_json(std::span<const std::optional<tin::query::Gradient>> gradients,
                        std::uint64_t revision);

/// Positions in the CRS asked for, one for each point.
std::string profile_json(std::span<const tin::query::ProfilePoint> points, std::span<const Position2> at,
                         const Units& units, std::uint64_t revision);
/// `closest` and `blocked` in the CRS asked for.
std::string sight_json(const tin::query::Sight& sight, Position2 closest, std::optional<Position2> blocked,
                       const Units& units, std::uint64_t revision);
std::string volume_json(const tin::query::LevelVolumes& volumes, double level, const Units& units,
                        std::uint64_t revision);
std::string surface_area_json(const tin::query::SurfaceArea& area, const Units& units,
                              std::uint64_t revision);
std::string cut_fill_json(const tin::query::CutFill& volumes, const Units& units, std::uint64_t revision,
                          std::string_view after, std::uint64_t after_revision);

}  // namespace proto
