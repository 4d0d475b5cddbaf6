// A terrain as a file, in the format that the file's name asks for.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "tin/base/progress.h"
#include "tin/base/result.h"
#include "tin/terrain/terrain.h"

namespace server::cli {

/// The suffixes that are known: ".tif, .geojson, .obj, ...".
std::string output_formats();

/// Whether files of this name can be written: asked before long work. Errors: kUnsupported, which names the
/// formats.
tin::base::Result<void> check_output(const std::filesystem::path& file);

/// Writes beside the file and renames then: what was there before stays until the new one is whole. Errors:
/// kUnsupported, kStorage, kTooLarge, kCancelled, those of the formats.
tin::base::Result<void> write_output(const tin::terrain::Terrain& terrain, const std::filesystem::path& file,
                                     tin::base::Progress& progress);

}  // namespace server::cli
