// Shapefiles: a .shp alone, or a ZIP archive that holds one with its companions.
#include <cpl_conv.h>
#include <cpl_string.h>
#include <cpl_vsi.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <memory>

#include "server/gdal/import_internal.h"
#include "server/gdal/library.h"

namespace server::gdal {
namespace {

using tin::base::Code;
using tin::base::error;
using tin::base::Result;

constexpr int kMostEntries = 10'000;
constexpr std::array<std::string_view, 5> kCompanions{".shp", ".shx", ".dbf", ".prj", ".cpg"};

struct CloseFile {
  void operator()(VSILFILE* file) const { VSIFCloseL(file); }
};
using File = std::unique_ptr<VSILFILE, CloseFile>;

std::string lower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return std::tolower(c); });
  return text;
}

/// Writes an entry of the archive as `to`, up to `limit` bytes, which it takes off.
Result<void> unpack(const ImportTask& task, const std::string& entry, const std::filesystem::path& to,
                    std::uint64_t& limit) {
  const File in(VSIFOpenL(entry.c_str(), "rb"));
  const File out(VSIFOpenL(to.c_str(), "wb"));
  if (!in) return error(Code::kMalformed, "An entry of the ZIP archive cannot be read");
  if (!out) return error(Code::kStorage, "The ZIP archive cannot be unpacked where it is read");
  std::vector<char> block(1 << 16);
  for (;;) {
    if (task.cancelled()) return cancelled_error();
    const std::size_t got = VSIFReadL(block.data(), 1, block.size(), in.get());
    if (got > limit) {
      return error(Code::kTooLarge, "The ZIP archive unpacks to more than the limit of " +
                                        std::to_string(task.options.max_unpacked_bytes) + " bytes");
    }
    limit -= got;
    if (VSIFWriteL(block.data(), 1, got, out.get()) != got)
      return error(Code::kStorage, "The ZIP archive cannot be unpacked where it is read");
    if (got < block.size()) break;
  }
  return {};
}

/// The names of the archive's entries, which stay text: files are written under names of ours.
Result<std::vector<std::string>> entries(const std::string& archive) {
  const CPLStringList listed(VSIReadDirRecursive(archive.c_str()));
  if (listed.size() == 0) return error(Code::kMalformed, "The ZIP archive is empty or damaged");
  if (listed.size() > kMostEntries) return error(Code::kTooLarge, "The ZIP archive has too many entries");
  std::vector<std::string> names;
  for (int i = 0; i < listed.size(); ++i) {
    const std::string name = lower(listed[i]);
    // What macOS adds beside each file.
    if (name.find("__macosx") == std::string::npos) names.emplace_back(listed[i]);
  }
  return names;
}

}  // namespace

Result<std::filesystem::path> unpack_shapefile(const ImportTask& task) {
  const Complaints complaints;
  const std::string archive = "/vsizip/" + task.workspace.file().string();
  const auto names = entries(archive);
  if (!names) return names.error();
  std::string stem;
  for (const std::string& name : *names) {
    if (!lower(name).ends_with(".shp")) continue;
    if (!stem.empty()) return error(Code::kInvalidValue, "The ZIP archive holds more than one shapefile");
    stem = name.substr(0, name.size() - 4);
  }
  if (stem.empty()) return error(Code::kUnsupported, "The ZIP archive holds no shapefile");
  std::uint64_t limit = task.options.max_unpacked_bytes;
  for (const std::string& name : *names) {
    for (const std::string_view suffix : kCompanions) {
      if (lower(name) != lower(stem) + std::string(suffix)) continue;
      const auto to = task.workspace.folder() / ("points" + std::string(suffix));
      if (auto done = unpack(task, archive + "/" + name, to, limit); !done) return done.error();
    }
  }
  return task.workspace.folder() / "points.shp";
}

}  // namespace server::gdal
