// Terrains to be written, and what came out of writing them.
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <string_view>
#include <vector>

#include "proto/formats/mesh_formats.h"
#include "proto/formats/mesh_points.h"
#include "proto/formats/terrain_mesh.h"
#include "tin/terrain/terrain.h"

namespace tests::formats {

using proto::formats::MeshRequest;
using tin::terrain::Terrain;

/// A projected frame with an odd origin, in metres.
tin::frame::Frame projected_frame();
/// So many vertices at random positions and heights, in a millimetre lattice of the frame.
Terrain random_terrain(std::size_t vertices, const tin::frame::Frame& frame = projected_frame());
/// Rows from north to south, a vertex per digit (its height), nodata where there is a dot. Cells of 10 units.
Terrain drawn_terrain(const std::vector<std::string>& rows);

/// The whole file, with pieces joined.
std::string written(const Terrain& terrain, std::string_view format, MeshRequest request = {});

/// The terrain that the points of a file of ours make on the lattice that it notes.
Terrain rebuilt(const proto::formats::MeshPoints& points);

}  // namespace tests::formats
