// One export under way, as the makers of each family of formats see it.
#pragma once

#include "server/api/answer.h"
#include "server/api/export_grid.h"
#include "server/api/feature_reader.h"
#include "server/api/file_body.h"
#include "server/api/routes.h"

namespace server::api {

struct ExportFormat;

struct ExportTask {
  Context& context;
  const app::Tin& tin;
  app::Version version;
  ExportRequest wanted;
  FeatureKind kind = FeatureKind::kTriangles;
  const ExportFormat& format;
  Patience patience;

  const tin::terrain::Terrain& terrain() const { return *version.terrain; }
};

// Makers of bodies. Errors: those of reading the TIN in the wanted CRS and box; kTooMany, kTooLarge where a
// file is made first.
Result<http::Body> export_geotiff(ExportTask& task);
Result<http::Body> export_cog(ExportTask& task);
Result<http::Body> export_ascii_grid(ExportTask& task);
Result<http::Body> export_geojson(ExportTask& task);
Result<http::Body> export_geopackage(ExportTask& task);
Result<http::Body> export_flatgeobuf(ExportTask& task);
Result<http::Body> export_mesh(ExportTask& task);

}  // namespace server::api
