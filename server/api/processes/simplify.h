// What the process and other ways to simplify share.
#pragma once

#include "proto/processes/simplify.h"
#include "tin/simplify/simplify.h"

namespace server::api::processes {

tin::simplify::Effort effort_of(proto::SimplifyEffort effort);
tin::simplify::Elevations elevations_of(proto::SimplifyElevations elevations);
tin::simplify::Against against_of(proto::SimplifyAgainst against);

/// What a report says, on the wire; `terrain` is the one that was simplified, or what came of it.
proto::SimplifyResults results_of(const tin::simplify::Report& report, const tin::terrain::Terrain& terrain);

}  // namespace server::api::processes
