#include "server/api/export_formats.h"

#include <algorithm>
#include <array>
#include <vector>

#include "proto/formats/mesh_formats.h"

namespace server::api {
namespace {

constexpr std::array kOwn{
    ExportFormat{"geotiff", "GeoTIFF", ".tif", "image/tiff; application=geotiff", ExportFamily::kRaster,
                 export_geotiff},
    ExportFormat{"cog", "Cloud-optimised GeoTIFF", ".tif",
                 "image/tiff; application=geotiff; profile=cloud-optimized", ExportFamily::kRaster,
                 export_cog},
    ExportFormat{"aaigrid", "Esri ASCII grid", ".asc", "text/plain; charset=utf-8", ExportFamily::kRaster,
                 export_ascii_grid},
    ExportFormat{"geojson", "GeoJSON", ".geojson", proto::formats::kGeoJsonMediaType, ExportFamily::kFeatures,
                 export_geojson},
    ExportFormat{"gpkg", "GeoPackage", ".gpkg", "application/geopackage+sqlite3", ExportFamily::kLayers,
                 export_geopackage},
    ExportFormat{"flatgeobuf", "FlatGeobuf", ".fgb", "application/flatgeobuf", ExportFamily::kFeatures,
                 export_flatgeobuf},
};

/// Our own, then what proto/formats writes of meshes.
std::vector<ExportFormat> all_formats() {
  std::vector<ExportFormat> all(kOwn.begin(), kOwn.end());
  for (const auto& mesh : proto::formats::mesh_formats()) {
    all.push_back({mesh.name, mesh.title, mesh.suffix, mesh.media_type, ExportFamily::kMesh, export_mesh,
                   mesh.degrees});
  }
  return all;
}

}  // namespace

std::span<const ExportFormat> export_formats() {
  static const std::vector<ExportFormat> all = all_formats();
  return all;
}

const ExportFormat* find_export_format(std::string_view name) {
  const auto all = export_formats();
  const auto found = std::find_if(all.begin(), all.end(),
                                  [name](const ExportFormat& format) { return format.name == name; });
  return found == all.end() ? nullptr : &*found;
}

std::string export_format_names() {
  const auto all = export_formats();
  std::string names;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (i > 0) names += i + 1 < all.size() ? ", " : " and ";
    names += all[i].name;
  }
  return names;
}

bool takes_parameter(const ExportFormat& format, std::string_view parameter) {
  const auto is_one_of = [parameter](const auto& names) {
    return std::find(names.begin(), names.end(), parameter) != names.end();
  };
  if (is_one_of(kRasterParameters)) return format.family == ExportFamily::kRaster;
  if (is_one_of(kFeatureParameters)) return format.family == ExportFamily::kFeatures;
  return true;
}

}  // namespace server::api
