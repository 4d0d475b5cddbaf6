// From an uploaded file to a served TIN.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "server/app/catalogue.h"
#include "server/gdal/crs.h"
#include "server/gdal/decoder.h"
#include "server/gdal/import.h"
#include "tin/simplify/simplify.h"

namespace server::app {

struct ImportRequest {
  std::optional<std::string> id;
  std::string title;
  tin::terrain::Duplicates duplicates = tin::terrain::Duplicates::kReplace;
  std::optional<gdal::VerticalUnit> vertical_unit;  // in place of what the file says
  gdal::ImportOptions options;
  gdal::Decoder decoder;  // who reads the file
  /// Makes a simplified TIN at once. Of a raster only the result is ever triangulated; the samples are kept
  /// all the same.
  std::optional<tin::simplify::Options> simplify;
  std::optional<double> max_seconds;  // after which the best simplification so far is taken
};

/// What a file becomes.
struct ImportedTerrain {
  tin::terrain::Terrain terrain;
  tin::terrain::SourceSamples source;
  std::optional<tin::simplify::Report> report;  // if it was simplified
  bool out_of_time = false;                     // max_seconds ended the search
  std::string driver;                           // GDAL's name of the format
};

/// Reads the file and triangulates its samples, or what the request leaves of them. Reports progress over all
/// of it. What it takes is taken from `memory`, if that is given, until it returns. Errors: as
/// gdal::import_file, Terrain::build and simplify::simplify; kTooMany (no memory).
tin::base::Result<ImportedTerrain> import_terrain(const std::filesystem::path& file,
                                                  const ImportRequest& request, tin::base::Progress& progress,
                                                  MemoryBudget* memory = nullptr);

/// Reads the file, triangulates its samples and stores the TIN with them. Reports progress over all of it.
/// Errors: as gdal::import_file, Terrain::build, simplify::simplify and Catalogue::create; then nothing is
/// left behind.
tin::base::Result<std::shared_ptr<Tin>> import_tin(Catalogue& catalogue, const std::filesystem::path& file,
                                                   const ImportRequest& request,
                                                   tin::base::Progress& progress);

}  // namespace server::app
