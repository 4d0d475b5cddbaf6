// Samples whose surface counts, too: the TIN must stay close to the triangles between them.
#pragma once

#include <memory>

#include "tin/simplify/samples.h"
#include "tin/simplify/source_mesh.h"

namespace tin::simplify {

/// Between two surfaces of triangles the distance is largest at a vertex of one of them, or where edges of
/// both cross. Vertices of the TIN are samples, so the samples over a triangle and the crossings along its
/// sides say all.
std::unique_ptr<Samples> with_surface(std::unique_ptr<Samples> samples,
                                      std::shared_ptr<const SourceMesh> mesh);

}  // namespace tin::simplify
