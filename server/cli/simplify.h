// tinsmith simplify: the engine without a server.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "server/cli/content.h"

namespace server::cli {

/// What stands on the command line.
struct SimplifyArguments {
  std::string input;
  std::string output;
  std::optional<double> tolerance;
  std::optional<std::uint64_t> max_vertices;
  std::optional<double> max_seconds;
  std::string effort = "balanced";
  std::string elevations = "source";
  std::string against = "samples";
  std::uint64_t keep_flat = 0;  // samples of a plateau; 0: plateaus may be tilted
  std::uint64_t seed = 1;
  unsigned threads = 0;        // 0: the processor's
  std::uint64_t memory = 1024;  // megabytes of a raster's samples that are held at a time
  std::string scratch;          // folder of temporary files; empty: the output's
  ContentArguments content;      // of the input
  std::string duplicates = "replace";
  bool json = false;     // the report as JSON
  bool quiet = false;    // neither report nor bar
};

/// Returns the exit status: 0; 1 when something is wrong; 2 when the arguments make no sense; 3 when --max-vertices got in the way of
/// --tolerance; 128 and the signal's number when one stopped it, and then nothing is written.
int simplify(const SimplifyArguments& arguments);

}  // namespace server::cli
