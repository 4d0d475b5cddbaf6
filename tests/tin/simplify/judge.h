// The judge of a simplification: searches and measures with rationals, and shares no code with what it
// judges.
#pragma once

#include <optional>
#include <string>

#include "tin/terrain/terrain.h"

namespace support {

/// Whether every vertex of `source` lies on the ground covered by `result` and within `tolerance` of it,
/// vertically and exactly; the first that does not, in words. Goes through all triangles for every vertex:
/// for small terrains.
std::optional<std::string> judge(const tin::terrain::Terrain& source, const tin::terrain::Terrain& result,
                                 double tolerance);

/// The same for the surface of `source` where its edges cross those of `result`: with judge(), everywhere. Goes through all pairs
/// of edges.
std::optional<std::string> judge_surface(const tin::terrain::Terrain& source, const tin::terrain::Terrain& result,
                                         double tolerance);

}  // namespace support
