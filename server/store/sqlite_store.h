// The store in one SQLite file: nothing to install or to start. WAL with synchronous=FULL, since NORMAL loses
// acknowledged commits when the power fails.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>

#include "server/store/files.h"
#include "server/store/store.h"
#include "tin/base/result.h"

namespace server::store {

struct SqliteOptions {
  /// The most that the database file may grow to, rounded up to pages; past it writes fail with kDiskFull. 0:
  /// no bound but the disk's.
  std::int64_t max_file_bytes = 0;
  /// Checkpoints up to this size stand in the database, larger ones are files.
  std::size_t checkpoint_row_bytes = std::size_t{1} << 20;
  /// SQLite's interface to the system, by name; empty: the usual one. Tests put faults here.
  std::string vfs = {};
  /// What writes the files beside the database; null: the system. Tests put faults here.
  std::shared_ptr<Disk> disk = nullptr;
};

/// Opens or creates the store of `folder`: tinsmith.sqlite3 with SQLite's files beside it, the folder "files"
/// for what is large, and the file "lock". The folder is made if its parent is there.
///
/// Errors: kConflict when the folder is open already, here or in another process; kUnsupported when a newer
///         version wrote it, or it is no store of ours; kStorage.
tin::base::Result<std::unique_ptr<Store>> open_sqlite_store(const std::filesystem::path& folder,
                                                            const SqliteOptions& options = {});

/// The store of a folder for reading, beside a server that may be writing it: what it holds at each call. It
/// takes no lock, repairs nothing, and refuses writes (kStorage). Errors: kNotFound when there is no store;
/// kUnsupported when another version wrote it; kStorage.
tin::base::Result<std::unique_ptr<Store>> open_sqlite_store_for_reading(const std::filesystem::path& folder);

}  // namespace server::store
