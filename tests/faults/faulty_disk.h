// A disk that fails where a test wants it to, or remembers everything that was done to it: under SQLite as a
// VFS, and under the store's own files as its Disk.
//
//   FaultyDisk disk;
//   auto store = open_sqlite_store(folder, disk.options());
//   disk.fail_at(Operation::kSync, 3, Failure::kBroken);   // the third sync from now on
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "server/store/sqlite_store.h"

namespace tests::faults {

enum class Operation { kWrite, kSync };
enum class Failure {
  kBroken,  // an input or output error
  kFull,    // no room; writes only
};

/// Something that was done to a file, or that the tested program said to its clients.
struct Event {
  enum Kind { kWrite, kTruncate, kSync, kRemove, kRename, kSyncFolder, kAcknowledged };
  Kind kind;
  std::string path = {};
  std::string to = {};       // of a rename
  std::uint64_t offset = 0;  // or the size after a truncation, or the number acknowledged
  std::string bytes = {};
};

/// Thread-safe. At most one at a time uses the VFS.
class FaultyDisk {
 public:
  FaultyDisk();
  ~FaultyDisk();
  FaultyDisk(const FaultyDisk&) = delete;
  FaultyDisk& operator=(const FaultyDisk&) = delete;

  server::store::SqliteOptions options();

  /// The `nth` operation of this kind from now on fails, and only that one. 0: none does.
  void fail_at(Operation operation, std::uint64_t nth, Failure failure);
  /// From now on no write finds room, until this is called with false.
  void set_full(bool full);
  /// Whether the failure happened.
  bool failed() const;
  /// How many operations of this kind there were so far.
  std::uint64_t count(Operation operation) const;

  void start_recording();
  /// Notes that `number` was acknowledged after all that was recorded before.
  void acknowledged(std::uint64_t number);
  std::vector<Event> recorded() const;

  /// For the layers: whether this operation fails, and how.
  std::optional<Failure> strikes(Operation operation);
  void record(Event event);

 private:
  mutable std::mutex mutex_;
  std::uint64_t counts_[2] = {0, 0};
  std::uint64_t fail_at_[2] = {0, 0};
  Failure failure_ = Failure::kBroken;
  bool failed_ = false;
  bool full_ = false;
  bool recording_ = false;
  std::vector<Event> events_;
};

}  // namespace tests::faults
