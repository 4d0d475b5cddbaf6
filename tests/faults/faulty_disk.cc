#include "tests/faults/faulty_disk.h"

#include <sqlite3.h>
#include <unistd.h>

#include <cstring>
#include <map>

namespace tests::faults {
namespace {

using server::store::kDiskFull;
using tin::base::Code;
using tin::base::Result;

constexpr const char* kVfsName = "faulty";

FaultyDisk* present = nullptr;

int code_of(Failure failure, int broken) {
  return failure == Failure::kFull ? SQLITE_FULL : broken;
}

// SQLite asks for szOsFile bytes per file: ours, and behind it the file of the VFS below.
struct File {
  sqlite3_file base;
  char* path;
  sqlite3_file* below() { return reinterpret_cast<sqlite3_file*>(this + 1); }
};
File* of(sqlite3_file* file) {
  return reinterpret_cast<File*>(file);
}
sqlite3_file* below(sqlite3_file* file) {
  return of(file)->below();
}
sqlite3_vfs* below_vfs() {
  return sqlite3_vfs_find("unix");
}

int close_file(sqlite3_file* file) {
  const int code = below(file)->pMethods->xClose(below(file));
  sqlite3_free(of(file)->path);
  of(file)->path = nullptr;
  return code;
}
int write_file(sqlite3_file* file, const void* bytes, int size, sqlite3_int64 offset) {
  if (const auto failure = present->strikes(Operation::kWrite)) return code_of(*failure, SQLITE_IOERR_WRITE);
  if (of(file)->path != nullptr) {
    present->record({.kind = Event::kWrite,
                     .path = of(file)->path,
                     .offset = static_cast<std::uint64_t>(offset),
                     .bytes = std::string(static_cast<const char*>(bytes), static_cast<std::size_t>(size))});
  }
  return below(file)->pMethods->xWrite(below(file), bytes, size, offset);
}
int truncate_file(sqlite3_file* file, sqlite3_int64 size) {
  if (const auto failure = present->strikes(Operation::kWrite))
    return code_of(*failure, SQLITE_IOERR_TRUNCATE);
  if (of(file)->path != nullptr) {
    present->record(
        {.kind = Event::kTruncate, .path = of(file)->path, .offset = static_cast<std::uint64_t>(size)});
  }
  return below(file)->pMethods->xTruncate(below(file), size);
}
int sync_file(sqlite3_file* file, int flags) {
  if (present->strikes(Operation::kSync)) return SQLITE_IOERR_FSYNC;
  if (of(file)->path != nullptr) present->record({.kind = Event::kSync, .path = of(file)->path});
  return below(file)->pMethods->xSync(below(file), flags);
}

const sqlite3_io_methods kMethods = {
    3,
    close_file,
    [](sqlite3_file* f, void* b, int n, sqlite3_int64 o) {
      return below(f)->pMethods->xRead(below(f), b, n, o);
    },
    write_file,
    truncate_file,
    sync_file,
    [](sqlite3_file* f, sqlite3_int64* n) { return below(f)->pMethods->xFileSize(below(f), n); },
    [](sqlite3_file* f, int l) { return below(f)->pMethods->xLock(below(f), l); },
    [](sqlite3_file* f, int l) { return below(f)->pMethods->xUnlock(below(f), l); },
    [](sqlite3_file* f, int* r) { return below(f)->pMethods->xCheckReservedLock(below(f), r); },
    [](sqlite3_file* f, int op, void* arg) { return below(f)->pMethods->xFileControl(below(f), op, arg); },
    [](sqlite3_file* f) { return below(f)->pMethods->xSectorSize(below(f)); },
    [](sqlite3_file* f) { return below(f)->pMethods->xDeviceCharacteristics(below(f)); },
    [](sqlite3_file* f, int p, int s, int e, void volatile** m) {
      return below(f)->pMethods->xShmMap(below(f), p, s, e, m);
    },
    [](sqlite3_file* f, int o, int n, int l) { return below(f)->pMethods->xShmLock(below(f), o, n, l); },
    [](sqlite3_file* f) { below(f)->pMethods->xShmBarrier(below(f)); },
    [](sqlite3_file* f, int d) { return below(f)->pMethods->xShmUnmap(below(f), d); },
    [](sqlite3_file*, sqlite3_int64, int, void** p) {
      *p = nullptr;  // nothing is mapped: every write passes here
      return SQLITE_OK;
    },
    [](sqlite3_file*, sqlite3_int64, void*) { return SQLITE_OK; },
};

int open_file(sqlite3_vfs*, const char* name, sqlite3_file* file, int flags, int* out_flags) {
  File* ours = of(file);
  std::memset(ours, 0, sizeof(File));
  const int code = below_vfs()->xOpen(below_vfs(), name, ours->below(), flags, out_flags);
  if (ours->below()->pMethods == nullptr) return code;
  if (name != nullptr) ours->path = sqlite3_mprintf("%s", name);
  ours->base.pMethods = &kMethods;
  return code;
}

int delete_file(sqlite3_vfs*, const char* name, int sync_folder) {
  present->record({.kind = Event::kRemove, .path = name});
  return below_vfs()->xDelete(below_vfs(), name, sync_folder);
}

void register_vfs() {
  static sqlite3_vfs vfs;
  vfs = *below_vfs();
  vfs.szOsFile += static_cast<int>(sizeof(File));
  vfs.zName = kVfsName;
  vfs.pNext = nullptr;
  vfs.xOpen = open_file;
  vfs.xDelete = delete_file;
  sqlite3_vfs_register(&vfs, 0);
}

/// The store's own files.
class Layer : public server::store::Disk {
 public:
  explicit Layer(FaultyDisk& disk) : disk_(disk) {}

  Result<int> create(const std::filesystem::path& path) override {
    if (const auto failure = disk_.strikes(Operation::kWrite)) return error(*failure);
    auto made = Disk::create(path);
    const std::lock_guard guard(mutex_);
    if (made.ok()) open_[*made] = {path, 0};
    return made;
  }
  Result<void> write(int descriptor, std::string_view bytes) override {
    if (const auto failure = disk_.strikes(Operation::kWrite)) {
      static_cast<void>(Disk::write(descriptor, bytes.substr(0, bytes.size() / 2)));  // as a full disk does
      return error(*failure);
    }
    const std::lock_guard guard(mutex_);
    auto& [path, size] = open_[descriptor];
    disk_.record({.kind = Event::kWrite, .path = path, .offset = size, .bytes = std::string(bytes)});
    size += bytes.size();
    return Disk::write(descriptor, bytes);
  }
  Result<void> sync(int descriptor) override {
    if (const auto failure = disk_.strikes(Operation::kSync)) return error(*failure);
    const std::lock_guard guard(mutex_);
    disk_.record({.kind = Event::kSync, .path = open_[descriptor].first});
    return Disk::sync(descriptor);
  }
  void close(int descriptor) override {
    const std::lock_guard guard(mutex_);
    open_.erase(descriptor);
    Disk::close(descriptor);
  }
  Result<void> rename(const std::filesystem::path& from, const std::filesystem::path& to) override {
    if (const auto failure = disk_.strikes(Operation::kWrite)) return error(*failure);
    disk_.record({.kind = Event::kRename, .path = from, .to = to});
    return Disk::rename(from, to);
  }
  Result<void> sync_folder(const std::filesystem::path& folder) override {
    if (const auto failure = disk_.strikes(Operation::kSync)) return error(*failure);
    disk_.record({.kind = Event::kSyncFolder, .path = folder});
    return Disk::sync_folder(folder);
  }
  void remove(const std::filesystem::path& path) override {
    disk_.record({.kind = Event::kRemove, .path = path});
    Disk::remove(path);
  }

 private:
  static tin::base::Error error(Failure failure) {
    if (failure == Failure::kFull) return tin::base::error(Code::kNoSpace, std::string(kDiskFull));
    return tin::base::error(Code::kStorage, "a fault was injected");
  }

  FaultyDisk& disk_;
  std::mutex mutex_;
  std::map<int, std::pair<std::string, std::uint64_t>> open_;
};

}  // namespace

FaultyDisk::FaultyDisk() {
  present = this;
  register_vfs();
}

FaultyDisk::~FaultyDisk() {
  sqlite3_vfs_unregister(sqlite3_vfs_find(kVfsName));
  present = nullptr;
}

server::store::SqliteOptions FaultyDisk::options() {
  server::store::SqliteOptions options;
  options.vfs = kVfsName;
  options.disk = std::make_shared<Layer>(*this);
  options.checkpoint_row_bytes = 2000;  // so that small tests write files, too
  return options;
}

void FaultyDisk::fail_at(Operation operation, std::uint64_t nth, Failure failure) {
  const std::lock_guard guard(mutex_);
  const auto kind = static_cast<std::size_t>(operation);
  fail_at_[kind] = nth == 0 ? 0 : counts_[kind] + nth;
  failure_ = failure;
  failed_ = false;
}

void FaultyDisk::set_full(bool full) {
  const std::lock_guard guard(mutex_);
  full_ = full;
}

bool FaultyDisk::failed() const {
  const std::lock_guard guard(mutex_);
  return failed_;
}

std::uint64_t FaultyDisk::count(Operation operation) const {
  const std::lock_guard guard(mutex_);
  return counts_[static_cast<std::size_t>(operation)];
}

std::optional<Failure> FaultyDisk::strikes(Operation operation) {
  const std::lock_guard guard(mutex_);
  const auto kind = static_cast<std::size_t>(operation);
  ++counts_[kind];
  if (full_ && operation == Operation::kWrite) return Failure::kFull;
  if (counts_[kind] != fail_at_[kind]) return std::nullopt;
  failed_ = true;
  return failure_;
}

void FaultyDisk::start_recording() {
  const std::lock_guard guard(mutex_);
  recording_ = true;
}

void FaultyDisk::record(Event event) {
  const std::lock_guard guard(mutex_);
  if (recording_) events_.push_back(std::move(event));
}

void FaultyDisk::acknowledged(std::uint64_t number) {
  record({.kind = Event::kAcknowledged, .offset = number});
}

std::vector<Event> FaultyDisk::recorded() const {
  const std::lock_guard guard(mutex_);
  return events_;
}

}  // namespace tests::faults
