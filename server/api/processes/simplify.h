// What the process and other ways to simplify share.
#pragma once

#include "proto/processes/simplify.h"
#include "tin/simplify/simplify.h"

namespace server::api::processes {

tin::simplify::Effort effort_of(proto::SimplifyEffort effort);

}  // namespace server::api::processes
