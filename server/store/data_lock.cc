#include "server/store/data_lock.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <string>
#include <system_error>
#include <utility>

namespace server::store {
namespace {

using tin::base::Code;
using tin::base::Result;

tin::base::Error system_error(const std::string& what, const std::filesystem::path& path) {
  return tin::base::error(Code::kStorage,
                          what + " " + path.string() + ": " + std::generic_category().message(errno));
}

}  // namespace

Result<DataLock> DataLock::acquire(const std::filesystem::path& folder) {
  const std::filesystem::path path = folder / "lock";
  const int descriptor = ::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
  if (descriptor < 0) return system_error("cannot open", path);
  DataLock lock(descriptor);
  if (::flock(descriptor, LOCK_EX | LOCK_NB) != 0) {
    if (errno != EWOULDBLOCK) return system_error("cannot lock", path);
    return tin::base::error(Code::kConflict, "another tinsmith uses the data folder " + folder.string() +
                                                 " (it holds the lock on " + path.string() + ")");
  }
  return lock;
}

DataLock::DataLock(DataLock&& other) noexcept : descriptor_(std::exchange(other.descriptor_, -1)) {}

DataLock::~DataLock() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

}  // namespace server::store
