// The reading of an uploaded file by a process of its own, which has nothing to lose: no network, no files
// but this one, bounded memory and time. A file that breaks its decoder is refused; the server goes on.
//
//   Decoder decoder{"/proc/self/exe", limits};
//   auto import = decoder.import_file("/data/uploads/17", options, &progress);
//
// The program runs itself again as `tinsmith decode`, which is run_decoder().
#pragma once

#include <filesystem>
#include <string>

#include "server/gdal/import.h"
#include "server/gdal/sandbox.h"

namespace server::gdal {

struct Decoder {
  std::string program;  // that knows the command `decode`; empty: files are read in this process
  DecoderLimits limits;

  /// As server::gdal::import_file(), and kInvalidValue when the file broke the decoder, kTooLarge when it
  /// took more time or memory than the limits, kStorage or kInternal when no decoder could be started.
  /// Cancellation kills the decoder at once. Threads: any number at once.
  tin::base::Result<Import> import_file(const std::filesystem::path& uploaded, const ImportOptions& options,
                                        tin::base::Progress* progress) const;
};

/// The decoder's side: confines itself, reads the order and the file "upload" in the working folder, and
/// sends what it finds to standard output. Returns the exit status.
int run_decoder();

}  // namespace server::gdal
