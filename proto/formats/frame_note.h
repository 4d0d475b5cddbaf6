// The frame of a terrain as a line of text for the comments of other formats, so that a file of ours comes
// home to the same lattice, and thus with the same digest.
#pragma once

#include <string>
#include <string_view>

#include "tin/base/result.h"
#include "tin/frame/frame.h"

namespace proto::formats {

/// What stands before the note in comments: "# tinsmith-frame {...}".
inline constexpr std::string_view kFrameNoteName = "tinsmith-frame";

/// JSON on one line: {"crs":...,"x":{"origin":...,"unit":...,"parts":...},"y":{...},"verticalUnit":{...}}
std::string frame_note(const tin::frame::Frame& frame);

/// Reads it back, equal in every bit. Whether its CRS is known and its axes are of use is not checked.
/// Errors: kMalformed, kInvalidValue, as the JSON reader's.
tin::base::Result<tin::frame::Frame> read_frame_note(std::string_view text);

/// The note within a line of comment (without its comment mark), or empty.
std::string_view find_frame_note(std::string_view comment);

/// The note that is a member of a JSON object, from the beginning of the object's text; or empty.
std::string_view find_frame_member(std::string_view json);

}  // namespace proto::formats
