// Journal records: the bytes of one change. Specified in FORMAT.md.
#pragma once

#include <string>
#include <string_view>

#include "tin/base/result.h"
#include "tin/terrain/edit.h"

namespace tin::codec {

/// Requires: every step has an id, a before or an after, positions on the lattice and finite elevations.
std::string encode_change(const terrain::Change& change);

/// The change of `bytes`, which may be anything.
///
/// Ensures: what encode_change requires; encode_change(result) == bytes.
/// Errors:  kMalformed; kUnsupported when written by a newer version.
base::Result<terrain::Change> decode_change(std::string_view bytes);

}  // namespace tin::codec
