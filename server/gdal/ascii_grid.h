// Writing a raster of elevations as an Esri ASCII grid, row by row.
#pragma once

#include <filesystem>

#include "server/gdal/geotiff.h"

namespace server::gdal {

/// Writes `out` (which is replaced): the shortest numbers that read back as the values in the raster's type.
/// Pixels that are not square get DX and DY in place of CELLSIZE, which GDAL reads. The format tells neither
/// CRS nor unit. Memory: a row. On error there is no file.
/// Errors: kInvalidValue (a raster that is not north-up), those of `rows`, kStorage.
tin::base::Result<void> write_ascii_grid(const std::filesystem::path& out, const RasterSpec& spec,
                                         const RowSource& rows);

}  // namespace server::gdal
