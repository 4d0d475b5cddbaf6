// The lock on a data folder: two servers writing one folder would each serve half of the truth.
#pragma once

#include <filesystem>

#include "tin/base/result.h"

namespace server::store {

/// Holds an exclusive lock on FOLDER/lock until destroyed; the system lets go of it when the process dies.
class DataLock {
 public:
  /// Errors: kConflict when somebody holds it; kStorage when the file cannot be made.
  static tin::base::Result<DataLock> acquire(const std::filesystem::path& folder);

  DataLock(DataLock&& other) noexcept;
  DataLock& operator=(DataLock&&) = delete;
  ~DataLock();

 private:
  explicit DataLock(int descriptor) : descriptor_(descriptor) {}

  int descriptor_;
};

}  // namespace server::store
