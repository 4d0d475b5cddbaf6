// Bodies on disk: an upload written as it arrives, and a file sent piece by piece.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "server/http/message.h"

namespace server::http {

/// A file that closes itself.
class OpenFile {
 public:
  explicit OpenFile(int descriptor = -1) : descriptor_(descriptor) {}
  OpenFile(OpenFile&& other) noexcept;
  OpenFile& operator=(OpenFile&& other) noexcept;
  ~OpenFile();

  int descriptor() const { return descriptor_; }

 private:
  int descriptor_;
};

/// A fresh file, readable by us alone, that removes itself unless its path is released.
///
/// Errors: every function throws std::system_error when the disk refuses.
class UploadFile {
 public:
  explicit UploadFile(const std::filesystem::path& folder);
  UploadFile(UploadFile&&) = delete;
  ~UploadFile();

  void write(const char* bytes, std::size_t size);

  /// Closes the file and hands its path over; from now on the caller removes it.
  std::filesystem::path release();

 private:
  std::filesystem::path path_;
  OpenFile file_;
};

/// A file as a body: of the size that it had when it was opened. A file that shrinks meanwhile is a failure.
class FileSource : public BodySource {
 public:
  /// Opens the file, and with `remove_after` unlinks it at once: it lives on until it is sent.
  explicit FileSource(const FileBody& body);

  std::uint64_t size() const { return size_; }
  bool next(std::string& piece) override;

 private:
  OpenFile file_;
  std::uint64_t size_ = 0;
  std::uint64_t left_ = 0;
};

}  // namespace server::http
