// A terrain as a file, in the format that the file's name asks for.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "tin/base/progress.h"
#include "tin/base/result.h"
#include "tin/frame/frame.h"
#include "tin/terrain/terrain.h"

namespace server::cli {

/// The suffixes that are known: ".tif, .geojson, .obj, ...".
std::string output_formats();

// What can be known before long work is asked before it: the name, the place, and, once the input's frame is known, whether the
// format can say it.

/// Errors: kUnsupported, which names the formats.
tin::base::Result<void> check_output_name(const std::filesystem::path& file);

/// Whether the file can be written where it lies; it is not touched. Errors: kConflict when it is the input; kStorage.
tin::base::Result<void> check_output(const std::filesystem::path& file, const std::filesystem::path& input);

/// Whether the format can say coordinates of this frame. Errors: kInvalidValue.
tin::base::Result<void> check_output_frame(const std::filesystem::path& file, const tin::frame::Frame& frame);

/// Writes beside the file and renames then: what was there before stays until the new one is whole. A symbolic link stays, and what
/// it names is written. Triangles over voids are left out. Requires: a name that check_output_name() allows. Errors: kStorage,
/// kTooLarge, kCancelled, those of the formats.
tin::base::Result<void> write_output(const tin::terrain::Terrain& terrain, const std::filesystem::path& file,
                                     tin::base::Progress& progress);

}  // namespace server::cli
