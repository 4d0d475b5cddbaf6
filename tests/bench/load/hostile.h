// What clients who mean no good do to the others.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "tests/bench/load/client.h"

namespace tests::load {

/// How many of each kind there are, and how long each is borne.
struct HostileSizes {
  int idle = 5000;
  int slow_heads = 500;
  int slow_bodies = 500;
  int slow_readers = 100;
  Clock::duration time = std::chrono::seconds(5);
};

struct HostileResult {
  std::string name;  // "nobody else" first
  LoadResult others;
  std::uint64_t resident_bytes = 0;
};

/// What the server needs for it, as configuration.
std::string hostile_config();

/// Eight good clients ask for elevations of the TIN "t" of at least 100,000 vertices: alone, and beside each
/// kind of bad ones. `resident` tells the server's memory.
std::vector<HostileResult> run_hostile(std::uint16_t port, const HostileSizes& sizes,
                                       const std::function<std::uint64_t()>& resident);

}  // namespace tests::load
