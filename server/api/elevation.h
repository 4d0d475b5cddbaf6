// Elevations at many positions.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "proto/messages.h"
#include "tin/base/result.h"
#include "tin/query/elevation.h"
#include "tin/terrain/terrain.h"

namespace server::api {

/// How positions between samples get their elevation.
struct ElevationManner {
  proto::Voids voids = proto::Voids::kKeep;
  tin::query::Interpolation by = tin::query::Interpolation::kLinear;
};

/// Elevations at positions of `crs`, easting or longitude first; nothing where there is none. Errors: as
/// Positions::between(), at `where`. Requires: x and y of equal length.
tin::base::Result<std::vector<std::optional<double>>> elevations_at(const tin::terrain::Terrain& terrain,
                                                                    std::string_view crs, std::string where,
                                                                    const ElevationManner& manner,
                                                                    std::vector<double> x,
                                                                    std::vector<double> y);

}  // namespace server::api
