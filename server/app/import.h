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

namespace server::app {

struct ImportRequest {
  std::optional<std::string> id;
  std::string title;
  tin::terrain::Duplicates duplicates = tin::terrain::Duplicates::kReplace;
  std::optional<gdal::VerticalUnit> vertical_unit;  // in place of what the file says
  gdal::ImportOptions options;
  gdal::Decoder decoder;  // who reads the file
};

/// Reads the file, triangulates its samples and stores the TIN. Reports progress over all of it.
/// Errors: as gdal::import_file, Terrain::build and Catalogue::create; then nothing is left behind.
tin::base::Result<std::shared_ptr<Tin>> import_tin(Catalogue& catalogue, const std::filesystem::path& file,
                                                   const ImportRequest& request,
                                                   tin::base::Progress& progress);

}  // namespace server::app
