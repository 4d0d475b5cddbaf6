// Water and other plateaus, which a tolerance would otherwise let be tilted.
#pragma once

#include <cstddef>
#include <memory>

#include "tin/base/progress.h"
#include "tin/simplify/samples.h"
#include "tin/simplify/source_mesh.h"

namespace tin::simplify {

/// A sample is level when all its neighbours have its own height: the up to eight around it on a raster, else
/// those that the triangulation of all samples links it to. Level samples that are neighbours make a plateau,
/// if they are at least `least`: then they must lie on the TIN exactly, and no vertex on or beside them may
/// float. (What is beside is left some freedom, so that a jagged shore does not take a vertex for every
/// corner.)
///
/// Requires: a mesh unless `samples` know neighbours; 1 <= least. What is cancelled is of no worth: ask
/// before using it. Where there is no room for the level samples (the samples' footprint says), they are not
/// kept.
std::unique_ptr<Samples> with_plateaus(std::unique_ptr<Samples> samples, const SourceMesh* mesh,
                                       std::size_t least, const base::Progress* progress);

}  // namespace tin::simplify
