// What the process and other ways to simplify share.
#pragma once

#include <optional>
#include <string>

#include "proto/processes/simplify.h"
#include "server/api/routes.h"
#include "tin/simplify/simplify.h"

namespace server::api::processes {

tin::simplify::Effort effort_of(proto::SimplifyEffort effort);
tin::simplify::Elevations elevations_of(proto::SimplifyElevations elevations);
tin::simplify::Against against_of(proto::SimplifyAgainst against);

/// How long a simplification may take that asks for `seconds`, or does not say. Errors: kInvalidValue at `where` (more than the
/// server allows).
tin::base::Result<double> allowed_seconds(const Context& context, std::optional<double> seconds, std::string where);

/// What a report says, on the wire; `terrain` is the one that was simplified, or what came of it.
proto::SimplifyResults results_of(const tin::simplify::Report& report, const tin::terrain::Terrain& terrain);

}  // namespace server::api::processes
