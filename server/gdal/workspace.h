// A private folder that holds one uploaded file under a name that we chose, and nothing else.
#pragma once

#include <filesystem>
#include <string>

#include "tin/base/result.h"

namespace server::gdal {

/// Lets GDAL see an upload without its neighbours: a fresh folder with a hard link to it (or a copy, where
/// links do not work), removed with this object. Move-only.
class Workspace {
 public:
  /// `name` is ours, never a client's, unless it was matched against a strict pattern.
  /// Errors: kInvalidValue when `uploaded` is not a regular file, kStorage when the folder cannot be made.
  static tin::base::Result<Workspace> create(const std::filesystem::path& uploaded, const std::string& name);

  Workspace(Workspace&& other) noexcept;
  Workspace& operator=(Workspace&&) = delete;
  ~Workspace();

  const std::filesystem::path& folder() const { return folder_; }
  const std::filesystem::path& file() const { return file_; }

 private:
  Workspace(std::filesystem::path folder, std::filesystem::path file);
  std::filesystem::path folder_;
  std::filesystem::path file_;
};

}  // namespace server::gdal
