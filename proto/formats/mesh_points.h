// What readers of mesh and point files give: vertices, and what the file says of their coordinates.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "proto/messages.h"
#include "tin/base/result.h"
#include "tin/frame/frame.h"

namespace proto::formats {

struct LengthUnit {
  std::string name;
  double metres = 1;
};

struct MeshPoints {
  std::vector<Position> points;
  std::string crs;  // as the file names it, unread: "EPSG:3875", WKT; empty: not said
  std::optional<LengthUnit> horizontal, vertical;
  /// From a note of ours. Not to be trusted: see read_frame_note().
  std::optional<tin::frame::Frame> frame;
};

/// What a reader may take, and whether it may go on.
struct ReadLimits {
  std::uint64_t points = 50'000'000;
  /// Asked every few thousand points with the bytes read so far; an error ends the reading.
  std::function<tin::base::Result<void>(std::uint64_t bytes)> check{};
};

}  // namespace proto::formats
