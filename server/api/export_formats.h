// The formats of exports, in one table: from it come the answers, the error messages and the links; the enum
// in openapi.json is held against it by a test.
#pragma once

#include <array>
#include <span>
#include <string>
#include <string_view>

#include "server/api/export_task.h"

namespace server::api {

/// What a file holds: pixels, features of one kind, layers of all kinds, a mesh.
enum class ExportFamily { kRaster, kFeatures, kLayers, kMesh };

struct ExportFormat {
  std::string_view name;   // as in f=geotiff
  std::string_view title;  // for people
  std::string_view suffix;
  std::string_view media_type;
  ExportFamily family;
  Result<http::Body> (*make)(ExportTask& task);
  bool degrees = true;  // whether it can hold longitudes and latitudes
};

std::span<const ExportFormat> export_formats();
/// The format of this name, or null.
const ExportFormat* find_export_format(std::string_view name);
/// "geotiff, geojson and obj".
std::string export_format_names();

/// Query parameters that have an effect on one family only.
inline constexpr std::array<std::string_view, 6> kRasterParameters{"cell-size", "layer",    "interpolation",
                                                                   "azimuth",   "altitude", "exaggeration"};
inline constexpr std::array<std::string_view, 1> kFeatureParameters{"collection"};

/// Whether the query parameter of this name has an effect on the format.
bool takes_parameter(const ExportFormat& format, std::string_view parameter);

}  // namespace server::api
