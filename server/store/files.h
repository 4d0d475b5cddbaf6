// The files that a store keeps beside its database: written once, whole and durable before anything names
// them.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "server/store/pieces.h"
#include "tin/base/result.h"

namespace server::store {

/// The steps of writing files, so that a test can let each of them fail. Thread-safe. Errors: kStorage;
/// kNoSpace when there is no room.
class Disk {
 public:
  virtual ~Disk() = default;

  /// A new file, to be written from its start; a descriptor.
  virtual tin::base::Result<int> create(const std::filesystem::path& path);
  virtual tin::base::Result<void> write(int descriptor, std::string_view bytes);
  virtual tin::base::Result<void> sync(int descriptor);
  virtual void close(int descriptor);
  virtual tin::base::Result<void> rename(const std::filesystem::path& from, const std::filesystem::path& to);
  /// A name in a folder is durable only once the folder is synced.
  virtual tin::base::Result<void> sync_folder(const std::filesystem::path& folder);
  virtual void remove(const std::filesystem::path& path);
};

/// What a row says of a file; an empty name is no file.
struct FileReference {
  std::string name;
  std::uint64_t bytes = 0;
  std::uint32_t crc = 0;
};

/// A folder of such files, each under a random name. Thread-safe.
class Files {
 public:
  /// Errors: kStorage.
  static tin::base::Result<Files> open(const std::filesystem::path& folder, std::shared_ptr<Disk> disk);

  /// Writes the pieces to a new file; `suffix` says what it is. It is durable, name and all, when this
  /// returns. Errors: kStorage, kNoSpace, those of `pieces`; then no file is left.
  tin::base::Result<FileReference> put(const Pieces& pieces, std::string_view suffix);
  /// Gives the bytes of the file to `sink` as they are read; nothing is known of them before this has
  /// returned. Errors: kStorage when the file is missing, or is not what was put; the sink's.
  tin::base::Result<void> read(const FileReference& file, const Sink& sink) const;
  /// All of them. Errors: as read().
  tin::base::Result<std::string> get(const FileReference& file) const;
  void remove(const std::string& name) noexcept;
  /// Removes all files but these: what a crash left between a file and its row. `kept` ascends.
  void remove_all_but(const std::vector<std::string>& kept);

  const std::filesystem::path& folder() const { return folder_; }

 private:
  Files(std::filesystem::path folder, std::shared_ptr<Disk> disk)
      : folder_(std::move(folder)), disk_(std::move(disk)) {}
  tin::base::Result<void> write(const std::filesystem::path& path, const Pieces& pieces, FileReference& file);

  std::filesystem::path folder_;
  std::shared_ptr<Disk> disk_;
};

/// Makes `folder` unless it is there, durably. Errors: kStorage.
tin::base::Result<void> ensure_folder(const std::filesystem::path& folder, Disk& disk);

}  // namespace server::store
