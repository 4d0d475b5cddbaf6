// LAS 1.0 to 1.4, point formats 0 to 10: clouds of points from lidar, with the class of each.
#pragma once

#include <bitset>

#include "proto/formats/byte_reader.h"
#include "proto/formats/mesh_points.h"

namespace proto::formats {

/// The classes of points that are wanted: 2 is ground, by the standard.
using LasClasses = std::bitset<256>;

/// Its points, and its CRS in one of the two forms that LAS has: WKT, or the tags of a GeoTIFF.
struct LasFile {
  MeshPoints mesh;                         // mesh.crs is the WKT, if there is one
  std::vector<std::uint16_t> geo_keys;     // tag 34735
  std::vector<double> geo_doubles;         // tag 34736
  std::string geo_ascii;                   // tag 34737
  std::uint64_t others = 0, withheld = 0;  // points that were left out: not of the classes; withheld
};

/// Reads the points of the wanted classes, but for those that are marked as withheld.
///
/// The header is not believed: counts and offsets are held against the size of the file, and nothing of their
/// size is allocated. Errors: kMalformed, kUnsupported (compressed points, which is LAZ; versions and formats
/// that do not exist), kNotFinite, kTooLarge, those of `limits.check`.
tin::base::Result<LasFile> read_las(ByteReader& bytes, const LasClasses& classes, const ReadLimits& limits);

}  // namespace proto::formats
