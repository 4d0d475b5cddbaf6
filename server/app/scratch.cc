#include "server/app/scratch.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <system_error>
#include <utility>

#include "tin/base/check.h"

namespace server::app {

using tin::base::Code;

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
    const bool full = reason == ENOSPC || reason == EDQUOT || reason == EFBIG;
    throw NoScratch(tin::base::error(full ? Code::kNoSpace : Code::kStorage,
                                     "no room for a temporary file in " + folder_.string() + ": " +
                                         std::generic_category().message(reason)));
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
  static const int statm = ::open("/proc/self/statm", O_RDONLY | O_CLOEXEC);
  static const auto page = static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE));
  std::array<char, 128> text{};
  if (statm < 0 || ::pread(statm, text.data(), text.size() - 1, 0) <= 0) return 0;
  unsigned long long size = 0, resident = 0, of_files = 0;
  if (std::sscanf(text.data(), "%llu %llu %llu", &size, &resident, &of_files) != 3) return 0;
  return of_files * page;
}

/// The mapped files of all memories here. The system knows how many pages of files are resident in the
/// process, not whose, so they have one bound together.
class Residents {
 public:
  static Residents& all() {
    static Residents one;
    return one;
  }

  void add(void* memory, std::size_t bytes, const void* owner, std::uint64_t share) {
    const std::lock_guard lock(mutex_);
    if (maps_.empty()) before_ = resident_of_files();
    maps_.emplace(memory, Map{bytes, owner});
    if (maps_of_[owner]++ == 0) allowed_ += share;
    left_ = slack();
  }

  /// Unmaps it. False when it is none of these.
  bool remove(void* memory, const void* owner, std::uint64_t share) {
    const std::lock_guard lock(mutex_);
    const auto map = maps_.find(memory);
    if (map == maps_.end()) return false;
    ::munmap(memory, map->second.bytes);
    maps_.erase(map);
    if (--maps_of_[owner] == 0) {
      maps_of_.erase(owner);
      allowed_ -= share;
    }
    return true;
  }

  /// Up to so many bytes more are resident than when anybody looked.
  void grow(std::uint64_t bytes) {
    const auto more = static_cast<std::int64_t>(bytes);
    if (left_.fetch_sub(more, std::memory_order_relaxed) <= more) look();
  }

  /// Lets go of all pages if too many are resident. (Those of a shared mapping that go from the process are
  /// the file's all the same, also what was written to them.) What is left then belongs to others.
  void look() {
    const std::lock_guard lock(mutex_);
    const std::uint64_t resident = resident_of_files(), most = before_ + allowed_;
    std::uint64_t room = resident < most ? most - resident : 0;
    if (room == 0) {
      for (const auto& [memory, map] : maps_) ::madvise(memory, map.bytes, MADV_DONTNEED);
      before_ = resident_of_files();
      room = allowed_;
    }
    left_ = std::max(static_cast<std::int64_t>(room), slack());
  }

 private:
  static constexpr std::uint64_t kSlackPart = 8;  // of what is allowed: looking more often would cost more

  struct Map {
    std::size_t bytes;
    const void* owner;
  };

  std::int64_t slack() const { return static_cast<std::int64_t>(allowed_ / kSlackPart); }

  std::mutex mutex_;
  std::map<void*, Map> maps_;
  std::map<const void*, std::size_t> maps_of_;  // each owner's
  std::uint64_t before_ = 0;                    // resident of other files
  std::uint64_t allowed_ = 0;                   // the owners' shares
  std::atomic<std::int64_t> left_{0};           // that may be touched before somebody has to look
};

/// What the system maps at a touch beside what was touched, at most: a read fault maps 64 KiB about it.
constexpr std::size_t kAround = std::size_t{2} << 16;

/// Of the files' pages that may be resident: with less, work spends its time on letting go of them.
constexpr std::uint64_t kLeastShare = std::uint64_t{8} << 20;

/// `own` bytes are the asker's already.
void reserve(ScratchQuota& quota, std::uint64_t bytes, std::uint64_t own) {
  if (quota.take(bytes)) return;
  if (own + bytes > quota.most()) {
    throw NoScratch(tin::base::error(
        Code::kTooLarge, "This takes temporary files of " + std::to_string(own + bytes) +
                             " bytes; the limit here is " + std::to_string(quota.most()) + " bytes."));
  }
  throw NoScratch(tin::base::error(
      Code::kTooMany, "Work under way takes all the room that temporary files may have at the moment."));
}

}  // namespace

ScratchMemory::~ScratchMemory() {
  TIN_CHECK(whole_ == 0 && in_files_ == 0);
}

std::uint64_t ScratchMemory::share() const { return std::max(limits_.bytes / 2, kLeastShare); }

void ScratchMemory::touched(std::size_t pieces, std::size_t bytes_each) {
  if (in_files() > 0) Residents::all().grow(pieces * (bytes_each + kAround));
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
  if (limits_.quota) reserve(*limits_.quota, bytes, in_files());
  void* const memory = map_file(bytes);
  Residents::all().add(memory, bytes, this, share());
  const std::lock_guard lock(mutex_);
  in_files_ += bytes;
  if (watcher_.joinable()) return memory;
  watcher_ = std::jthread([](const std::stop_token& stop) {
    while (!stop.stop_requested()) {
      std::this_thread::sleep_for(kLookEvery);
      Residents::all().look();
    }
  });
  return memory;
}

void ScratchMemory::do_deallocate(void* memory, std::size_t bytes, std::size_t alignment) {
  if (!Residents::all().remove(memory, this, share())) {
    const std::lock_guard lock(mutex_);
    whole_ -= bytes;
    std::pmr::new_delete_resource()->deallocate(memory, bytes, alignment);
    return;
  }
  if (limits_.quota) limits_.quota->give_back(bytes);
  std::jthread over;  // waited for without the lock
  const std::lock_guard lock(mutex_);
  in_files_ -= bytes;
  if (in_files_ == 0) over = std::move(watcher_);
}

/// What was reserved for it is given back when there is no room for it.
void* ScratchMemory::map_file(std::size_t bytes) {
  try {
    const NamelessFile file(limits_.folder, bytes);
    void* const memory = ::mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_SHARED, file.number(), 0);
    if (memory == MAP_FAILED) file.fail(errno);
    return memory;
  } catch (const std::bad_alloc&) {
    if (limits_.quota) limits_.quota->give_back(bytes);
    throw;
  }
}

std::uint64_t ScratchMemory::in_memory() const {
  const std::lock_guard lock(mutex_);
  return whole_ + std::min(in_files(), share());
}

}  // namespace server::app
