// What the readers of rasters, vector layers and delimited text share. For this folder only.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "server/gdal/crs.h"
#include "server/gdal/format.h"
#include "server/gdal/import.h"
#include "server/gdal/workspace.h"

class OGRSpatialReference;

namespace server::gdal {

/// One import under way.
struct ImportTask {
  const ImportOptions& options;
  const Workspace& workspace;
  Format format;
  std::optional<CrsInfo> asked_crs;  // options.crs, read
  tin::base::Progress* progress;     // or null
  RowTaker* rows = nullptr;          // of a raster's heights, or null

  bool cancelled() const { return progress != nullptr && progress->cancelled(); }
  void report(double fraction) const {
    if (progress != nullptr) progress->report(fraction);
  }
};

/// A point as its file has it.
struct RawPoint {
  double x = 0, y = 0, z = 0;
};
struct RawPoints {
  std::vector<RawPoint> points;
  std::optional<CrsInfo> crs;              // the client's, else the file's
  std::optional<VerticalUnit> vertical;    // of the file
  double unit_m = 1;                       // metres per unit of x and y, where there is no CRS
  std::optional<tin::frame::Frame> noted;  // the lattice that a file of ours notes; not to be trusted
  std::string driver;
};

inline tin::base::Error cancelled_error() {
  return tin::base::error(tin::base::Code::kCancelled, "The import was cancelled");
}
inline tin::base::Error too_many_samples(std::uint64_t limit) {
  return tin::base::error(tin::base::Code::kTooLarge, "The file holds more than " + std::to_string(limit) +
                                                          " elevations, the limit here");
}

/// The CRS to use (the client's before the file's) and the unit of heights (`own` before the CRS's, else
/// metres).
void describe_frame(tin::frame::Frame& frame, const std::optional<CrsInfo>& crs,
                    std::optional<VerticalUnit> own);

/// The CRS of a file as GDAL found it (null: none), unless the client gave one. Errors: as describe_crs().
tin::base::Result<std::optional<CrsInfo>> effective_crs(const ImportTask& task,
                                                        const OGRSpatialReference* found);

tin::base::Result<Import> import_raster(const ImportTask& task);
tin::base::Result<RawPoints> read_vector_points(const ImportTask& task);
tin::base::Result<RawPoints> read_delimited_points(const ImportTask& task);

tin::base::Result<RawPoints> read_mesh_points(const ImportTask& task);
tin::base::Result<RawPoints> read_las_points(const ImportTask& task);

/// Unpacks the one shapefile of the archive, with its companions, into the workspace, under names of ours;
/// its .shp. Errors: kMalformed, kUnsupported (no shapefile in it), kInvalidValue (several), kTooLarge,
/// kStorage.
tin::base::Result<std::filesystem::path> unpack_shapefile(const ImportTask& task);

/// Takes the note on the lattice that a file may have in a comment. Errors: kMalformed.
tin::base::Result<void> take_note(RawPoints& raw, std::string_view note);

/// Puts points on the lattice that the file notes, unless the client asks for another CRS or resolution, or
/// not all are on it; else fits a frame to the points and snaps them to it. Errors: kInvalidValue when there
/// are none; as fit_points().
tin::base::Result<Import> place_points(const ImportTask& task, RawPoints raw);

}  // namespace server::gdal
