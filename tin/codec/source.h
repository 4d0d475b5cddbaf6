// Sources: the bytes of the samples that a terrain was made of. Specified in FORMAT.md.
#pragma once

#include <memory>
#include <memory_resource>
#include <string>
#include <string_view>

#include "tin/base/result.h"
#include "tin/codec/sink.h"
#include "tin/terrain/source_grid.h"
#include "tin/terrain/source_samples.h"

namespace tin::codec {

/// About a byte per sample of a raster in whole metres. The grid of a raster is not among them: the
/// checkpoint has it. Requires: all samples are in force (source.without() was not asked).
std::string encode_source(const terrain::SourceSamples& source);
/// The same in pieces of about a megabyte, for sources that are larger than memory. Errors: the sink's.
base::Result<void> encode_source(const terrain::SourceSamples& source, const Sink& sink);

/// The samples of `bytes`, which may be anything and may lie in `memory`, too, where the heights go. `grid`
/// is the terrain's source grid, null if it has none. Requires: the memory outlives the samples.
///
/// Ensures: encode_source(result) == bytes.
/// Errors:  kMalformed, also when the grid is not that of the samples; kUnsupported when written by a newer
/// version. Cost:    linear; allocates at most 8 bytes per pixel of the grid, or 16 per byte of points.
base::Result<terrain::SourceSamples> decode_source(
    std::string_view bytes, std::shared_ptr<const terrain::SourceGrid> grid,
    std::pmr::memory_resource* memory = std::pmr::get_default_resource());

}  // namespace tin::codec
