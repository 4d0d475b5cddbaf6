// The judge: proves that a mesh is the canonical Delaunay triangulation of its vertices. Shares no code with
// what builds meshes: its arithmetic is GMP's, its rules are written out again.
#pragma once

#include <optional>
#include <string>

#include "tin/mesh/mesh.h"

namespace tin::mesh {

/// The first broken invariant (they are numbered in tin/README.md), with the elements that break it; nothing
/// when all hold: links, orientation, hull, Euler's count, and each edge locally Delaunay under the tie rule,
/// which makes the whole Delaunay. Below dimension 2: the vertices are collinear and in order. Cost: O(n),
/// about 2 microseconds per vertex.
std::optional<std::string> validate(const Mesh& mesh);

}  // namespace tin::mesh
