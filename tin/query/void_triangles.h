// Which triangles span places that had no elevation in the source.
#pragma once

#include <array>

#include "tin/terrain/terrain.h"

namespace tin::query {

/// Whether a triangle lies over a void, to be left out as a whole: its centroid is in a cell of the source
/// that was nodata, none of its corners is (as for positions, see Voids), and no valid sample of the source
/// lies in it but at its corners. So the triangles that stay cover every valid sample, however far the
/// terrain was simplified, and may reach into voids. False where there is no source raster. Cost: the cells
/// of the source below the triangle, if its centroid is void.
bool over_void(const terrain::Terrain& terrain, const std::array<mesh::VertexSlot, 3>& corners);

/// Whether over_void() can be true at all.
bool has_voids(const terrain::Terrain& terrain);

}  // namespace tin::query
