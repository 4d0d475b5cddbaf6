// Memory for arrays as large as a raster: what goes past a limit lies in files, of which a part only is in
// memory at a time.
//
//   ScratchMemory scratch({.bytes = 1 << 30, .folder = "/data"});
//   tin::base::Array<std::int16_t> heights(count, &scratch);
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory_resource>
#include <mutex>
#include <new>
#include <string>
#include <thread>

namespace server::app {

struct ScratchLimits {
  std::uint64_t bytes = std::uint64_t{1} << 30;  // held in memory at a time, about
  std::filesystem::path folder;  // of the files, which have no names; on a disk, not in memory
};

/// No room, in memory or on the disk: says which.
class NoScratch : public std::bad_alloc {
 public:
  explicit NoScratch(std::string what) : what_(std::move(what)) {}
  const char* what() const noexcept override { return what_.c_str(); }

 private:
  std::string what_;
};

/// Half of the limit is for arrays that are in memory as a whole, given to those who ask first. All others
/// are mapped files; while there are any, a thread looks every few milliseconds how much of them is resident,
/// and lets go of all pages once that is the other half. (Contents stay: the system's page cache has them
/// while there is room, and the disk after that.) The room on the disk is taken at once, so a full disk is
/// found out when memory is asked for.
///
/// allocate() throws NoScratch. Threads: any number at once.
class ScratchMemory final : public std::pmr::memory_resource {
 public:
  explicit ScratchMemory(ScratchLimits limits) : limits_(std::move(limits)) {}
  /// Requires: all has been given back.
  ~ScratchMemory() override;

  /// Bytes in files now.
  std::uint64_t in_files() const;

 private:
  void* do_allocate(std::size_t bytes, std::size_t alignment) override;
  void do_deallocate(void* memory, std::size_t bytes, std::size_t alignment) override;
  bool do_is_equal(const memory_resource& other) const noexcept override { return this == &other; }

  void* map_file(std::size_t bytes);
  void keep_watch(const std::stop_token& stop, std::uint64_t resident_before);
  void let_go();

  const ScratchLimits limits_;
  mutable std::mutex mutex_;
  std::uint64_t whole_ = 0;            // bytes of arrays in memory
  std::map<void*, std::size_t> maps_;  // and of those in files
  std::jthread watcher_;               // while there are any
};

}  // namespace server::app
