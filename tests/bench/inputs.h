// Points to measure with: made from a seed, or read from a file.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "tin/exact/point.h"

namespace bench {

/// `kind`: uniform; grid (a square one, steps of 1000); strips (eight overlapping flight strips of jittered scan lines, with
/// dense clusters); or a file of "x y" lines on the lattice, of which the first `count` are taken. Distinct, shuffled by `seed`.
/// Throws std::runtime_error when the file can't be read.
std::vector<tin::exact::Point> make_input(const std::string& kind, std::size_t count, std::uint64_t seed);

}  // namespace bench
