// The proof at the end: where each sample lies in the result, and how far from it.
#pragma once

#include <optional>
#include <vector>

#include "tin/simplify/phase.h"
#include "tin/simplify/simplify.h"
#include "tin/simplify/working_tin.h"

namespace tin::simplify {

struct Certificate {
  std::vector<terrain::VertexId> removed;  // samples that are no vertices, ascending
  double max_error = 0;
  std::optional<Worst> worst;
  double rmse = 0;
  bool within = true;  // exact: every sample is within the tolerance asked about
};

/// Looks every vertex of `source` up in `result` and measures, sharing with the way there only the exact
/// judgement of a single sample. Requires: dimension 2; tolerance finite and >= 0. Nothing when cancelled.
std::optional<Certificate> certify(const terrain::Terrain& source, const WorkingTin& result, double tolerance,
                                   const Phase& phase);

}  // namespace tin::simplify
