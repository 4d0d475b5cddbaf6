// Memory for arrays as large as a raster: what goes past a limit lies in files, of which a part only is in
// memory at a time.
//
//   ScratchMemory scratch({.bytes = 1 << 30, .folder = "/data"});
//   tin::base::Array<std::int16_t> heights(count, &scratch);
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <mutex>
#include <new>
#include <thread>
#include <utility>

#include "tin/base/array.h"
#include "tin/base/result.h"

namespace server::app {

/// How many bytes temporary files may have that several memories make. Thread-safe.
class ScratchQuota {
 public:
  explicit ScratchQuota(std::uint64_t most) : most_(most) {}
  /// False, and nothing is taken, when there would be too many.
  bool take(std::uint64_t bytes) {
    if (taken_.fetch_add(bytes) + bytes <= most_) return true;
    taken_ -= bytes;
    return false;
  }
  void give_back(std::uint64_t bytes) { taken_ -= bytes; }
  std::uint64_t most() const { return most_; }
  std::uint64_t taken() const { return taken_; }

 private:
  const std::uint64_t most_;
  std::atomic<std::uint64_t> taken_{0};
};

struct ScratchLimits {
  std::uint64_t bytes = std::uint64_t{1} << 30;  // held in memory at a time, about
  std::filesystem::path folder;  // of the files, which have no names; on a disk, not in memory
  std::shared_ptr<ScratchQuota> quota = nullptr;  // of the files; null: no bound but the disk's
};

/// No room for a temporary file: kTooLarge (with those of the same memory it is above the quota), kTooMany
/// (with those of others), kNoSpace (the disk is full), kStorage.
class NoScratch : public std::bad_alloc {
 public:
  explicit NoScratch(tin::base::Error error) : error_(std::move(error)) {}
  const char* what() const noexcept override { return error_.message.c_str(); }
  const tin::base::Error& error() const { return error_; }

 private:
  tin::base::Error error_;
};

/// Half of the limit is for arrays that are in memory as a whole, given to those who ask first. All others
/// are mapped files, of which no more than the other half means to be resident: whoever works through them
/// says so (touched()), and when that may be too much, the process is looked at and lets go of all their
/// pages. (Contents stay: the system's page cache has them while there is room, and the disk after that.) Who
/// does not say so is found by a thread that looks every few milliseconds. The room on the disk is taken at
/// once, so a full disk is found out when memory is asked for.
///
/// Ensures: while all say what they touch, at most an eighth of the half too much is resident, and what each
/// thread touches between two words about it. Several of these share the sum of their halves.
/// allocate() throws NoScratch. Threads: any number at once.
class ScratchMemory final : public tin::base::PacedMemory {
 public:
  explicit ScratchMemory(ScratchLimits limits) : limits_(std::move(limits)) {}
  /// Requires: all has been given back.
  ~ScratchMemory() override;

  void touched(std::size_t pieces, std::size_t bytes_each) override;

  /// Bytes in files now.
  std::uint64_t in_files() const { return in_files_.load(std::memory_order_relaxed); }
  /// Bytes that it holds in memory now, at most.
  std::uint64_t in_memory() const;

 private:
  void* do_allocate(std::size_t bytes, std::size_t alignment) override;
  void do_deallocate(void* memory, std::size_t bytes, std::size_t alignment) override;
  bool do_is_equal(const memory_resource& other) const noexcept override { return this == &other; }

  void* map_file(std::size_t bytes);
  std::uint64_t share() const;  // of files' pages in memory

  const ScratchLimits limits_;
  mutable std::mutex mutex_;
  std::uint64_t whole_ = 0;  // bytes of arrays in memory
  std::atomic<std::uint64_t> in_files_{0};
  std::jthread watcher_;  // while there are any; under mutex_
};

}  // namespace server::app
