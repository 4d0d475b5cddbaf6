// CRSs as GDAL's own objects. For this folder only.
#pragma once

#include <memory>
#include <string_view>

#include "server/gdal/crs.h"

class OGRSpatialReference;

namespace server::gdal {

/// read_crs() for a CRS that GDAL found in a file.
tin::base::Result<CrsInfo> describe_crs(const OGRSpatialReference& crs);

/// The CRS that `text` means, in GIS order. Errors: as read_crs(), without its demands on axes and units.
tin::base::Result<std::unique_ptr<OGRSpatialReference>> parse_crs(std::string_view text);

}  // namespace server::gdal
