// One export under way, as the makers of each family of formats see it.
#pragma once

#include <chrono>
#include <filesystem>
#include <functional>
#include <string>

#include "server/api/answer.h"
#include "server/api/export_grid.h"
#include "server/api/feature_reader.h"
#include "server/api/routes.h"

namespace server::api {

struct ExportFormat;

/// Ends the making of a file that takes too long, or that nobody will get.
class Patience {
 public:
  Patience(const Request& request, std::int64_t seconds)
      : request_(request),
        seconds_(seconds),
        end_(std::chrono::steady_clock::now() + std::chrono::seconds(seconds)) {}
  /// Errors: kCancelled, kTooLarge.
  Result<void> check() const;

 private:
  const Request& request_;
  const std::int64_t seconds_;
  const std::chrono::steady_clock::time_point end_;
};

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

tin::base::Error too_many_exports();

/// A temporary file that becomes the answer's body, or goes. It is made under one of the context's slots.
/// Errors: kTooMany; those of `write`.
Result<http::Body> file_body(ExportTask& task, std::string_view suffix,
                             const std::function<Result<void>(const std::filesystem::path&)>& write);

}  // namespace server::api
