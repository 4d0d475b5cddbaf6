// Terrain of any size, made up: octaves of noise over a sea, written row by row.
#pragma once

#include <cstdint>
#include <string>

namespace bench {

/// Writes a GeoTIFF (16 bits, tiled, DEFLATE, pixels of 30 m) of `side` by `side` heights: mountains of some
/// 1,500 m with detail down to four pixels, a third of it sea at 0. Equal seeds give equal terrain. Throws
/// std::runtime_error when it can't be written.
void write_fractal(const std::string& path, std::int32_t side, std::uint64_t seed);

}  // namespace bench
