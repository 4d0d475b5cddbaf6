#include "server/store/files.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <fstream>
#include <new>
#include <random>
#include <system_error>
#include <utility>

#include "server/store/store.h"
#include "tin/codec/crc32c.h"

namespace server::store {
namespace {

using tin::base::Code;
using tin::base::Result;

constexpr std::size_t kPieceBytes = std::size_t{1} << 20;
constexpr std::string_view kAside = ".part";  // the end of a name while the file is written

tin::base::Error system_error(const std::string& what) {
  const int number = errno;
  const std::string detail = what + ": " + std::generic_category().message(number);
  const bool full = number == ENOSPC || number == EDQUOT || number == EFBIG;
  return full ? tin::base::error(Code::kNoSpace, std::string(kDiskFull) + ": " + detail)
              : tin::base::error(Code::kStorage, detail);
}

std::string random_name(std::string_view suffix) {
  std::random_device entropy;
  std::string name;
  for (int i = 0; i < 20; ++i) name += "abcdefghijklmnopqrstuvwxyz234567"[entropy() % 32];
  return name.append(1, '.').append(suffix);
}

}  // namespace

Result<int> Disk::create(const std::filesystem::path& path) {
  const int descriptor = ::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0644);
  if (descriptor < 0) return system_error("cannot make " + path.string());
  return descriptor;
}

Result<void> Disk::write(int descriptor, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(descriptor, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return system_error("cannot write");
    bytes.remove_prefix(static_cast<std::size_t>(written));
  }
  return {};
}

Result<void> Disk::sync(int descriptor) {
  if (::fsync(descriptor) != 0) return system_error("cannot sync");
  return {};
}

void Disk::close(int descriptor) {
  ::close(descriptor);
}

Result<void> Disk::rename(const std::filesystem::path& from, const std::filesystem::path& to) {
  if (::rename(from.c_str(), to.c_str()) != 0) return system_error("cannot rename " + from.string());
  return {};
}

Result<void> Disk::sync_folder(const std::filesystem::path& folder) {
  const int descriptor = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) return system_error("cannot open the folder " + folder.string());
  Result<void> result;
  if (::fsync(descriptor) != 0) result = system_error("cannot sync the folder " + folder.string());
  ::close(descriptor);
  return result;
}

void Disk::remove(const std::filesystem::path& path) {
  std::error_code ignored;
  std::filesystem::remove(path, ignored);
}

Result<Files> Files::open(const std::filesystem::path& folder, std::shared_ptr<Disk> disk) {
  if (auto made = ensure_folder(folder, *disk); !made) return made.error();
  return Files(folder, std::move(disk));
}

Result<FileReference> Files::put(const Pieces& pieces, std::string_view suffix) {
  FileReference file{random_name(suffix), 0, 0};
  const std::filesystem::path path = folder_ / file.name;
  const std::filesystem::path aside = path.string() + std::string(kAside);
  Result<void> done;
  try {
    done = write(aside, pieces, file);
  } catch (...) {  // whoever gives the pieces may run out of memory
    disk_->remove(aside);
    throw;
  }
  if (done) done = disk_->rename(aside, path);
  if (done) {
    done = disk_->sync_folder(folder_);
    if (!done) disk_->remove(path);
  } else {
    disk_->remove(aside);
  }
  if (!done) return done.error();
  return file;
}

Result<void> Files::write(const std::filesystem::path& path, const Pieces& pieces, FileReference& file) {
  const auto descriptor = disk_->create(path);
  if (!descriptor) return descriptor.error();
  struct Closed {
    Disk& disk;
    const int number;
    ~Closed() { disk.close(number); }
  } const closed{*disk_, *descriptor};
  auto done = pieces([&](std::string_view piece) -> Result<void> {
    file.bytes += piece.size();
    file.crc = tin::codec::crc32c(piece, file.crc);
    return disk_->write(*descriptor, piece);
  });
  return done ? disk_->sync(*descriptor) : done;
}

Result<void> Files::read(const FileReference& file, const Sink& sink) const {
  const std::filesystem::path path = folder_ / file.name;
  const auto damaged = [&](const std::string& what) {
    return tin::base::error(Code::kStorage, "the store is damaged: " + path.string() + " " + what);
  };
  std::error_code missing;
  const auto size = std::filesystem::file_size(path, missing);
  if (missing) return damaged("cannot be read: " + missing.message());
  if (size != file.bytes) return damaged("has another length than was written");
  std::ifstream in(path, std::ios::binary);
  std::string piece;
  std::uint32_t crc = 0;
  for (std::uint64_t left = file.bytes; left > 0; left -= piece.size()) {
    piece.resize(static_cast<std::size_t>(std::min<std::uint64_t>(left, kPieceBytes)));
    if (!in.read(piece.data(), static_cast<std::streamsize>(piece.size()))) return damaged("cannot be read");
    crc = tin::codec::crc32c(piece, crc);
    if (auto taken = sink(piece); !taken) return taken;
  }
  if (crc != file.crc) return damaged("does not match its checksum");
  return {};
}

Result<std::string> Files::get(const FileReference& file) const {
  std::string bytes;
  const auto read_all = read(file, [&](std::string_view piece) -> Result<void> {
    if (bytes.empty()) bytes.reserve(file.bytes);
    bytes += piece;
    return {};
  });
  if (!read_all) return read_all.error();
  return bytes;
}

void Files::remove(const std::string& name) noexcept {
  if (name.empty()) return;
  try {
    disk_->remove(folder_ / name);
  } catch (const std::bad_alloc&) {  // the next start removes what no row names
  }
}

void Files::remove_all_but(const std::vector<std::string>& kept) {
  std::error_code ignored;
  std::vector<std::filesystem::path> orphans;
  for (const auto& entry : std::filesystem::directory_iterator(folder_, ignored)) {
    if (!std::binary_search(kept.begin(), kept.end(), entry.path().filename().string()))
      orphans.push_back(entry.path());
  }
  for (const auto& path : orphans) disk_->remove(path);
}

Result<void> ensure_folder(const std::filesystem::path& folder, Disk& disk) {
  std::error_code failure;
  const bool made = std::filesystem::create_directory(folder, failure);
  if (failure) {
    return tin::base::error(Code::kStorage,
                            "cannot make the folder " + folder.string() + ": " + failure.message());
  }
  return made ? disk.sync_folder(std::filesystem::absolute(folder).lexically_normal().parent_path())
              : Result<void>();
}

}  // namespace server::store
