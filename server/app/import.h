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
  std::size_t duplicates = 0;  // points that are no vertices of their own: another stands at the same place
};

/// The TIN that was made of a file.
struct ImportedTin {
  std::shared_ptr<Tin> tin;
  std::optional<tin::simplify::Report> report;  // if it was simplified
  bool out_of_time = false;                     // max_seconds ended the search
  double seconds = 0;                           // that it all took
  std::size_t duplicates = 0;                   // as in ImportedTerrain
};

/// What an import may take of a server.
struct ImportMeans {
  MemoryBudget& memory;
  const ScratchSpace& scratch;
};

/// Reads the file and triangulates its samples, or what the request leaves of them. Reports progress over all
/// of it. What it takes is taken from `means`, if they are given, until it returns; where the heights of a
/// raster lie that is simplified, the request says. Errors: as gdal::import_file, Terrain::build and
/// simplify::simplify; kTooLarge, kTooMany (no memory). Throws NoScratch.
tin::base::Result<ImportedTerrain> import_terrain(const std::filesystem::path& file,
                                                  const ImportRequest& request, tin::base::Progress& progress,
                                                  const ImportMeans* means = nullptr);

/// Reads the file, triangulates its samples and stores the TIN with them. Reports progress over all of it. A
/// raster that is simplified may be larger than memory: what is too much of its samples lies in the
/// catalogue's scratch space. Errors: as gdal::import_file, Terrain::build, simplify::simplify and
/// Catalogue::create; kTooLarge, kTooMany, kNoSpace (no room for temporary files); then nothing is left
/// behind.
tin::base::Result<ImportedTin> import_tin(Catalogue& catalogue, const std::filesystem::path& file,
                                          const ImportRequest& request, tin::base::Progress& progress);

}  // namespace server::app
