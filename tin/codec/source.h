// Sources: the bytes of the samples that a terrain was made of. Specified in FORMAT.md.
#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "tin/base/result.h"
#include "tin/terrain/source_grid.h"
#include "tin/terrain/source_samples.h"

namespace tin::codec {

/// About a byte per sample of a raster in whole metres. The grid of a raster is not among them: the
/// checkpoint has it. Requires: all samples are in force (source.without() was not asked).
std::string encode_source(const terrain::SourceSamples& source);

/// The samples of `bytes`, which may be anything. `grid` is the terrain's source grid, null if it has none.
///
/// Ensures: encode_source(result) == bytes.
/// Errors:  kMalformed, also when the grid is not that of the samples; kUnsupported when written by a newer
/// version. Cost:    linear; allocates at most 8 bytes per pixel of the grid, or 16 per byte of points.
base::Result<terrain::SourceSamples> decode_source(std::string_view bytes,
                                                   std::shared_ptr<const terrain::SourceGrid> grid);

}  // namespace tin::codec
