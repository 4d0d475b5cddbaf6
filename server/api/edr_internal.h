// What the two halves of OGC API EDR share. edr.cc reads a query and finds its coverages, edr_answer.cc
// writes them. For these two only.
#pragma once

#include <optional>
#include <vector>

#include "proto/edr.h"
#include "server/api/answer.h"
#include "server/api/feature_query.h"
#include "server/api/routes.h"
#include "server/app/version.h"

namespace server::api::edr {

enum class Format { kCoverageJson, kGeoJson, kPage };

/// What all queries have in common.
struct Asked {
  app::Version version;
  WireCrs crs;
  std::optional<proto::Levels> levels;
  proto::SurfaceParameters parameters;
  Format format = Format::kCoverageJson;
};

/// Coverages that answer a query. A trajectory's places have distances; nothing lies between a place without
/// elevation and the next.
using Coverages = std::vector<proto::SurfaceCoverage>;

/// Where the i-th node of a side lies.
double node(const proto::SurfaceCoverage::Axis& axis, std::int64_t i);

/// x and y in the order of the CRS's authority, or back.
proto::Position2 swapped_if(bool swap, proto::Position2 at);

/// The coverages in the format asked for; `collection`: as one, however many they are.
Response answer(const Context& context, const app::Tin& tin, const Request& request, const Asked& asked,
                const Coverages& coverages, bool collection);

}  // namespace server::api::edr
