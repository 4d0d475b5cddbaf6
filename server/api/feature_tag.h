// Entity tags of single features: they change when the feature does, not with every edit of the TIN.
#pragma once

#include <string>

#include "server/api/answer.h"
#include "server/api/feature_reader.h"

namespace server::api {

/// The strong entity tag of a feature as a request shows it. `feature` is in the terrain's CRS.
std::string feature_tag(const app::Tin& tin, const Feature& feature, const Request& request);

/// Whether an If-Match field allows the present state of the feature, however it was shown.
bool matches(std::string_view if_match, const app::Tin& tin, const Feature& feature);

}  // namespace server::api
