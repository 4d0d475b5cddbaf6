// What a decoder process takes from itself before it looks at a hostile file.
#pragma once

#include <cstdint>
#include <string>

#include "tin/base/result.h"

namespace server::gdal {

/// What a decoder may use up.
struct DecoderLimits {
  std::uint64_t memory_bytes = std::uint64_t{4}
                               << 30;  // of address space, its libraries (some 170 MB) included
  std::uint64_t file_bytes = std::uint64_t{8} << 30;    // of a file that it writes in its own folder
  int cpu_seconds = 300;
  int seconds = 600;  // in all, after which it is killed
};

/// Confines this process for good, and its threads to come: the limits; no new privileges; no core; the
/// system calls of one who reads, computes and writes to open descriptors (no sockets, programs or
/// processes); and, where the kernel has Landlock, no files but those in `folder`, the system's libraries and
/// PROJ's and GDAL's data, these to be read only.
///
/// Errors: kInternal: do not go on then. Landlock missing is no error: see landlock_works().
/// Requires: one thread.
tin::base::Result<void> confine_this_process(const DecoderLimits& limits, const std::string& folder);

/// Whether the kernel can confine files.
bool landlock_works();

}  // namespace server::gdal
