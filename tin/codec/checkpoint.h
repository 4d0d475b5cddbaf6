// Checkpoints: the bytes of a whole terrain at one revision. Specified in FORMAT.md.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "tin/base/result.h"
#include "tin/frame/frame.h"
#include "tin/terrain/amendments.h"
#include "tin/terrain/edit.h"
#include "tin/terrain/source_grid.h"
#include "tin/terrain/terrain.h"

namespace tin::codec {

/// The most pixels that the mask of a source grid may have; larger rasters must be refused on import.
inline constexpr std::int64_t kMaxGridPixels = std::int64_t{1} << 30;

/// All that brings a terrain back: Terrain::restore(frame, vertices, next_id), then set_source_grid(grid) and
/// set_amendments(amendments).
struct Checkpoint {
  std::uint64_t revision = 0;
  std::string digest;  // of the terrain that this is the state of
  terrain::VertexId next_id{1};
  terrain::Duplicates duplicates = terrain::Duplicates::kReplace;
  frame::Frame frame;
  /// Set while the frame is provisional: it will be fitted to the first vertices that arrive, with these lattice steps in x
  /// and y (0: to be chosen). Only a terrain that never had a vertex has it.
  std::optional<std::array<double, 2>> open_resolution;
  std::vector<terrain::Vertex> vertices;  // by ascending id
  std::shared_ptr<const terrain::SourceGrid> grid;
  terrain::Amendments amendments;
};

/// Requires: what FORMAT.md demands of a checkpoint (ids ascend and are less than next_id, positions and grid
/// on the lattice, finite numbers, at most kMaxGridPixels).
std::string encode_checkpoint(const Checkpoint& checkpoint);

/// The checkpoint of `bytes`, which may be anything. Whether the digest is that of the vertices, and whether
/// two vertices share a position, is for the caller to see when it builds the terrain.
///
/// Ensures: what encode_checkpoint requires; encode_checkpoint(result) == bytes, but for version 2, which is written as 3.
/// Errors:  kMalformed; kUnsupported when written by a newer version.
/// Cost:    linear; allocates at most a small multiple of bytes.size(), and 128 MiB for the grid's mask.
base::Result<Checkpoint> decode_checkpoint(std::string_view bytes);

}  // namespace tin::codec
