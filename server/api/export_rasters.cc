// Exports that sample the surface at the centres of pixels.
#include <utility>

#include "server/api/export_formats.h"
#include "server/gdal/ascii_grid.h"
#include "server/gdal/geotiff.h"

namespace server::api {

namespace {

using Write = Result<void> (*)(const std::filesystem::path& out, const gdal::RasterSpec& spec,
                               const gdal::RowSource& rows);

Result<http::Body> raster(ExportTask& task, Write write) {
  return file_body(task.context, task.format.suffix,
                   [&task, write](const std::filesystem::path& file) -> Result<void> {
                     auto grid = ExportGrid::plan(task.terrain(), task.wanted);
                     if (!grid) return grid.error();
                     const auto row_source = [&](std::int64_t row, std::span<double> values) -> Result<void> {
                       grid->sample_row(row, values);
                       return task.patience.check();
                     };
                     return write(file, grid->spec(), row_source);
                   });
}

}  // namespace

Result<http::Body> export_geotiff(ExportTask& task) {
  return raster(task, [](const auto& out, const auto& spec, const auto& rows) {
    return gdal::write_geotiff(out, spec, rows, nullptr);
  });
}

Result<http::Body> export_cog(ExportTask& task) {
  return raster(task, [](const auto& out, const auto& spec, const auto& rows) {
    return gdal::write_cog(out, spec, rows, nullptr);
  });
}

Result<http::Body> export_ascii_grid(ExportTask& task) {
  return raster(task, gdal::write_ascii_grid);
}

}  // namespace server::api
