// The processes that ask about a TIN's surface: contours, volume, cut-fill, surface-area, profile and
// line-of-sight. Their inputs are those of proto/surface_queries.h and the TIN's id.
#pragma once

#include <string>

#include "proto/processes/process.h"
#include "proto/surface_queries.h"

namespace proto {

const ProcessDescription& contours_description();
const ProcessDescription& volume_description();
const ProcessDescription& cut_fill_description();
const ProcessDescription& surface_area_description();
const ProcessDescription& profile_description();
const ProcessDescription& line_of_sight_description();

/// A question about a TIN.
template <class Inputs>
struct AboutTin {
  std::string tin;
  Inputs inputs;
};
struct CutFillInputs {
  std::string tin, after;
  AreaInputs area;
};

/// Errors: as the readers of proto/surface_queries.h, and kMalformed for unknown members.
tin::base::Result<AboutTin<ContourInputs>> read_contours_process(const Value& inputs, std::size_t max_levels);
tin::base::Result<AboutTin<VolumeInputs>> read_volume_process(const Value& inputs, std::size_t max_positions);
tin::base::Result<CutFillInputs> read_cut_fill_process(const Value& inputs, std::size_t max_positions);
tin::base::Result<AboutTin<AreaInputs>> read_surface_area_process(const Value& inputs,
                                                                  std::size_t max_positions);
tin::base::Result<AboutTin<PositionsInputs>> read_profile_process(const Value& inputs,
                                                                  std::size_t max_positions);
tin::base::Result<AboutTin<SightInputs>> read_line_of_sight_process(const Value& inputs);

}  // namespace proto
