// Terrains to ask about, for the benchmarks of tin/query.
#pragma once

#include <cstdint>
#include <string>

#include "tin/terrain/terrain.h"

namespace bench {

/// A terrain of make_input()'s points with heights of waves and noise (0 to about 1000), one lattice step a
/// metre.
tin::terrain::Terrain wavy_terrain(const std::string& input, std::size_t points, std::uint64_t seed);

}  // namespace bench
