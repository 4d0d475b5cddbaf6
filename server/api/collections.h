// The collections of a TIN as documents.
#pragma once

#include <array>
#include <optional>
#include <string>

#include "proto/messages.h"
#include "server/api/answer.h"
#include "server/api/feature_reader.h"

namespace server::api {

/// The extent in CRS84, from the corners and edges of the extent in the TIN's CRS; nothing when it is empty or has no CRS.
std::optional<std::array<double, 4>> geojson_bbox(const app::Summary& summary);

/// With relative links.
proto::CollectionDocument collection_document(const app::Tin& tin, const app::Summary& summary, FeatureKind kind);

}  // namespace server::api
