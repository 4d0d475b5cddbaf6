#include "server/app/scratch.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <system_error>
#include <utility>

#include "tin/base/check.h"

namespace server::app {

namespace {

constexpr std::chrono::milliseconds kLookEvery{10};

/// A file without a name, of such a size on the disk.
class NamelessFile {
 public:
  NamelessFile(const std::filesystem::path& folder, std::size_t bytes) : folder_(folder) {
    number_ = ::open(folder.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, 0600);
    if (number_ < 0 && (errno == EOPNOTSUPP || errno == EISDIR)) number_ = named_for_a_moment();
    if (number_ < 0) fail(errno);
    if (const int failed = ::posix_fallocate(number_, 0, static_cast<off_t>(bytes)); failed != 0) {
      ::close(number_);
      fail(failed);
    }
  }
  ~NamelessFile() { ::close(number_); }
  NamelessFile(const NamelessFile&) = delete;
  NamelessFile& operator=(const NamelessFile&) = delete;

  int number() const { return number_; }
  [[noreturn]] void fail(int reason) const {
    throw NoScratch("no room for a temporary file in " + folder_.string() + ": " +
                    std::generic_category().message(reason));
  }

 private:
  /// Where a file system knows no others.
  int named_for_a_moment() const {
    std::string name = folder_ / ".tinsmith-XXXXXX";
    const int number = ::mkostemp(name.data(), O_CLOEXEC);
    if (number >= 0) ::unlink(name.c_str());
    return number;
  }

  const std::filesystem::path& folder_;
  int number_ = -1;
};

/// Bytes of the process that are resident and belong to files; 0 where the system does not say.
std::uint64_t resident_of_files() {
  unsigned long long size = 0, resident = 0, of_files = 0;
  std::FILE* const file = std::fopen("/proc/self/statm", "re");
  if (file == nullptr) return 0;
  const bool good = std::fscanf(file, "%llu %llu %llu", &size, &resident, &of_files) == 3;
  std::fclose(file);
  return good ? of_files * static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE)) : 0;
}

}  // namespace

ScratchMemory::~ScratchMemory() {
  TIN_CHECK(whole_ == 0 && maps_.empty());
}

std::uint64_t ScratchMemory::in_files() const {
  const std::lock_guard lock(mutex_);
  std::uint64_t sum = 0;
  for (const auto& [memory, bytes] : maps_) sum += bytes;
  return sum;
}

void* ScratchMemory::do_allocate(std::size_t bytes, std::size_t alignment) {
  {
    const std::lock_guard lock(mutex_);
    if (whole_ + bytes <= limits_.bytes / 2) {
      void* const memory = std::pmr::new_delete_resource()->allocate(bytes, alignment);
      whole_ += bytes;
      return memory;
    }
  }
  void* const memory = map_file(bytes);
  const std::lock_guard lock(mutex_);
  maps_.emplace(memory, bytes);
  if (watcher_.joinable()) return memory;
  watcher_ = std::jthread(
      [this, before = resident_of_files()](const std::stop_token& stop) { keep_watch(stop, before); });
  return memory;
}

void ScratchMemory::do_deallocate(void* memory, std::size_t bytes, std::size_t alignment) {
  std::jthread over;  // waited for without the lock
  {
    const std::lock_guard lock(mutex_);
    const auto map = maps_.find(memory);
    if (map == maps_.end()) {
      whole_ -= bytes;
      std::pmr::new_delete_resource()->deallocate(memory, bytes, alignment);
      return;
    }
    ::munmap(memory, map->second);
    maps_.erase(map);
    if (maps_.empty()) over = std::move(watcher_);
  }
}

void* ScratchMemory::map_file(std::size_t bytes) {
  const NamelessFile file(limits_.folder, bytes);
  void* const memory = ::mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_SHARED, file.number(), 0);
  if (memory == MAP_FAILED) file.fail(errno);
  return memory;
}

void ScratchMemory::keep_watch(const std::stop_token& stop, std::uint64_t resident_before) {
  while (!stop.stop_requested()) {
    std::this_thread::sleep_for(kLookEvery);
    const std::uint64_t resident = resident_of_files();
    if (resident > resident_before && resident - resident_before > limits_.bytes / 2) let_go();
  }
}

/// Pages of a shared mapping that go from the process are the file's all the same, also what was written to
/// them.
void ScratchMemory::let_go() {
  const std::lock_guard lock(mutex_);
  for (const auto& [memory, bytes] : maps_) ::madvise(memory, bytes, MADV_DONTNEED);
}

}  // namespace server::app
