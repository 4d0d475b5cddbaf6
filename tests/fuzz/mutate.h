// Changes that turn a good input into one that nobody meant.
#pragma once

#include <cstddef>
#include <random>
#include <string>
#include <vector>

namespace tests::fuzz {

/// `input` with one to eight changes: bits flipped, bytes set, pieces cut, repeated, moved or taken from
/// another seed, and integers at the edges of their ranges put in. Never longer than `most` bytes.
std::string mutate(std::string input, const std::vector<std::string>& seeds, std::mt19937_64& random,
                   std::size_t most = 1 << 16);

}  // namespace tests::fuzz
