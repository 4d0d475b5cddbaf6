#include "server/gdal/import.h"

#include <ogr_spatialref.h>

#include "server/gdal/crs_internal.h"
#include "server/gdal/import_internal.h"
#include "server/gdal/library.h"

namespace server::gdal {

using tin::base::Result;

void describe_frame(tin::frame::Frame& frame, const std::optional<CrsInfo>& crs,
                    std::optional<VerticalUnit> own) {
  if (crs) frame.crs = crs->name;
  if (!own && crs) own = crs->vertical;
  if (own) {
    frame.vertical_unit = own->name;
    frame.vertical_unit_m = own->metres;
  }
}

Result<std::optional<CrsInfo>> effective_crs(const ImportTask& task, const OGRSpatialReference* found) {
  if (task.asked_crs) return task.asked_crs;
  if (found == nullptr || found->IsEmpty()) return std::optional<CrsInfo>();
  // What GeoPackage calls its layers without a CRS.
  if (found->IsLocal() && STARTS_WITH_CI(found->GetName(), "Undefined")) return std::optional<CrsInfo>();
  auto info = describe_crs(*found);
  if (!info) return info.error();
  // GDAL's name for the CRS84 of GeoJSON whose points have heights.
  if (task.format == Format::kGeoJson && info->name == "EPSG:4979") info->name = "EPSG:4326";
  return std::optional<CrsInfo>(*std::move(info));
}

namespace {

Result<RawPoints> read_points(const ImportTask& task) {
  switch (task.format) {
    case Format::kDelimited:
      return read_delimited_points(task);
    case Format::kObj:
    case Format::kPly:
    case Format::kSms2dm:
    case Format::kLandXml:
      return read_mesh_points(task);
    case Format::kLas:
      return read_las_points(task);
    default:
      return read_vector_points(task);
  }
}

Result<Import> import_points(const ImportTask& task) {
  auto raw = read_points(task);
  if (!raw) return raw.error();
  auto import = place_points(task, *std::move(raw));
  if (!import || !task.options.look) return import;
  if (auto fine = task.options.look(*import); !fine) return fine.error();
  return import;
}

bool holds_raster(Format format) {
  switch (format) {
    case Format::kGeoTiff:
    case Format::kHgt:
    case Format::kAsciiGrid:
    case Format::kUsgsDem:
    case Format::kDted:
    case Format::kSurferText:
    case Format::kSurferBinary:
    case Format::kSurfer7:
    case Format::kVtpTerrain:
      return true;
    case Format::kDelimited:
    case Format::kGeoJson:
    case Format::kGeoPackage:
    case Format::kFlatGeobuf:
    case Format::kObj:
    case Format::kPly:
    case Format::kSms2dm:
    case Format::kLandXml:
    case Format::kLas:
    case Format::kShapefile:
    case Format::kZippedShapefile:
      return false;
  }
  return false;
}

}  // namespace

Result<Import> import_file(const std::filesystem::path& uploaded, const ImportOptions& options,
                           tin::base::Progress* progress, RowTaker* rows) {
  prepare_library();
  std::optional<CrsInfo> asked;
  if (!options.crs.empty()) {
    auto crs = read_crs(options.crs);
    if (!crs) return crs.error();
    asked = *std::move(crs);
  }
  const auto recognised = recognise(uploaded, options);
  if (!recognised) return recognised.error();
  const auto workspace = Workspace::create(uploaded, recognised->file_name);
  if (!workspace) return workspace.error();
  if (!options.classes.empty() && recognised->format != Format::kLas) {
    return tin::base::error(tin::base::Code::kInvalidValue, "Only the points of LAS files have classes",
                            "query:class");
  }
  if (holds_raster(recognised->format) && !(options.layer.empty() && options.z_field.empty())) {
    return tin::base::error(tin::base::Code::kInvalidValue, "A raster has neither layers nor fields of heights",
                            options.layer.empty() ? "query:z-field" : "query:layer");
  }
  const ImportTask task{options,          *workspace, recognised->format,
                        std::move(asked), progress,   options.heights_only ? rows : nullptr};
  auto import = holds_raster(task.format) ? import_raster(task) : import_points(task);
  if (import) task.report(1);
  return import;
}

}  // namespace server::gdal
