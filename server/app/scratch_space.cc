#include "server/app/scratch_space.h"

#include <system_error>

namespace server::app {

std::unique_ptr<ScratchMemory> ScratchSpace::memory() const {
  if (!has_files()) return std::make_unique<ScratchMemory>(ScratchLimits{UINT64_MAX, {}, nullptr});
  std::error_code unmade;  // then its first file says so
  std::filesystem::create_directories(limits_.folder, unmade);
  return std::make_unique<ScratchMemory>(ScratchLimits{limits_.memory_bytes, limits_.folder, quota_});
}

}  // namespace server::app
