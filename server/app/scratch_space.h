// How much of large rasters a server holds in memory, and where the rest lies.
#pragma once

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <memory>

#include "server/app/scratch.h"

namespace server::app {

/// What its memories have in common. Thread-safe.
class ScratchSpace {
 public:
  struct Limits {
    std::filesystem::path folder;    // of temporary files; empty: there are none, and everything is in memory
    std::uint64_t memory_bytes = 0;  // of each piece of work, at a time
    std::uint64_t file_bytes = 0;    // of all temporary files; 0: there are none
  };

  explicit ScratchSpace(Limits limits)
      : limits_(std::move(limits)), quota_(std::make_shared<ScratchQuota>(limits_.file_bytes)) {}

  /// For the arrays of one piece of work; makes the folder.
  std::unique_ptr<ScratchMemory> memory() const;
  /// What such a memory holds at most, of arrays that are so long together.
  std::uint64_t bytes_in_memory(std::uint64_t bytes) const {
    return has_files() ? std::min(bytes, limits_.memory_bytes) : bytes;
  }
  /// Of all temporary files, now.
  std::uint64_t bytes_in_files() const { return quota_->taken(); }

 private:
  bool has_files() const { return !limits_.folder.empty() && limits_.file_bytes > 0; }

  const Limits limits_;
  const std::shared_ptr<ScratchQuota> quota_;
};

}  // namespace server::app
