// What a TIN is made of, to be kept beside it.
#pragma once

#include "server/store/pieces.h"
#include "tin/terrain/source_samples.h"
#include "tin/terrain/terrain.h"

namespace server::app {

/// Whether a new terrain has all samples of its source as vertices.
enum class Completeness { kAllSamples, kSomeSamples };

/// Makes `source` what the terrain answers to. Its bytes, for Catalogue::NewTin::source; the heights must be
/// there until they are given. Requires: a raster's grid is the terrain's.
store::Pieces attach_source(tin::terrain::Terrain& terrain, tin::terrain::SourceSamples source,
                            Completeness completeness);

/// The vertices of a terrain as samples.
tin::terrain::SourceSamples vertices_as_source(const tin::terrain::Terrain& terrain);

}  // namespace server::app
