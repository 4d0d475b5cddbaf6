#include "server/gdal/workspace.h"

#include <cstdlib>
#include <system_error>
#include <utility>

#include "server/gdal/not_written.h"

namespace server::gdal {
namespace {

namespace fs = std::filesystem;
using tin::base::Code;
using tin::base::error;
using tin::base::Result;

/// A fresh folder that only this user can enter; empty when none can be made in `parent`.
fs::path make_private_folder(const fs::path& parent) {
  std::string pattern = (parent / "tinsmith-import-XXXXXX").string();
  return mkdtemp(pattern.data()) == nullptr ? fs::path() : fs::path(pattern);
}

}  // namespace

Workspace::Workspace(fs::path folder, fs::path file) : folder_(std::move(folder)), file_(std::move(file)) {}

Workspace::Workspace(Workspace&& other) noexcept
    : folder_(std::exchange(other.folder_, {})), file_(std::exchange(other.file_, {})) {}

Workspace::~Workspace() {
  if (folder_.empty()) return;
  std::error_code ignored;
  fs::remove_all(folder_, ignored);
}

Result<Workspace> Workspace::create(const fs::path& uploaded, const std::string& name) {
  std::error_code problem;
  const fs::path source = fs::canonical(uploaded, problem);
  if (problem || !fs::is_regular_file(source, problem)) {
    return error(Code::kInvalidValue, "There is no such file, or it is not a regular one");
  }
  fs::path folder = make_private_folder(source.parent_path());
  if (folder.empty()) folder = make_private_folder(fs::temp_directory_path(problem));
  if (folder.empty()) return error(Code::kStorage, "No folder could be made to read the file in");

  Workspace workspace(folder, folder / name);
  fs::create_hard_link(source, workspace.file_, problem);
  if (problem) fs::copy_file(source, workspace.file_, problem);
  if (problem)
    return not_written("The file could not be put where it is read: " + problem.message(), workspace.file_);
  return workspace;
}

}  // namespace server::gdal
