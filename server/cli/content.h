// What the command line says of the content of a file to read.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "server/gdal/import.h"

namespace server::cli {

/// Empty: what the file says.
struct ContentArguments {
  std::string crs;      // in place of the file's
  std::string format;   // else by its content
  std::string layer;    // else the first
  std::string z_field;  // else by the usual names
  std::vector<unsigned> classes;  // of LAS points, each at most 255; else all
};

/// How to read the file, of any size that a source may have.
gdal::ImportOptions import_options(const std::filesystem::path& file, const ContentArguments& content);

}  // namespace server::cli
