// From an uploaded file to lattice points: elevation rasters and point files of the formats that we read.
//
//   ImportOptions options;
//   options.file_name = "N44W072.hgt";
//   auto import = import_file("/data/uploads/17", options, &progress);
//   if (import) terrain.load(import->frame, import->placements);
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <memory_resource>
#include <span>
#include <string>
#include <vector>

#include "tin/base/progress.h"
#include "tin/base/result.h"
#include "tin/frame/frame.h"
#include "tin/terrain/edit.h"
#include "tin/terrain/source_grid.h"
#include "tin/terrain/source_samples.h"

namespace server::gdal {

struct Import;

/// What the client says about its file, none of it trusted, and the limits.
struct ImportOptions {
  std::string file_name;     // helps to recognise the format, and places an HGT; never opened
  std::string content_type;  // helps to recognise the format
  /// Insists on a format: geotiff, hgt, aaigrid, usgsdem, dted, gsag, gsbg, gs7bg, bt, csv, xyz, geojson,
  /// gpkg, fgb, shp, zip, las, obj, ply, 2dm or landxml.
  std::string format;
  std::string crs;          // replaces or supplies the file's CRS, in any form that read_crs() takes
  double resolution_x = 0;  // lattice steps in CRS units; 0: about 1 mm on the ground
  double resolution_y = 0;
  std::string layer;                       // vector files, LandXML: the layer or surface; empty: the first
  std::string z_field;                     // point files: column or field of the heights
  std::vector<std::uint8_t> classes;       // LAS: the classes that are wanted; empty: all
  std::uint64_t max_samples = 50'000'000;  // valid pixels, or points; not for a raster's heights alone
  std::uint64_t max_pixels = 200'000'000;  // width x height of a raster
  std::uint64_t max_unpacked_bytes = std::uint64_t{8} << 30;  // of a ZIP archive
  /// Of a raster no placements, which take 16 bytes each, but its heights only.
  bool heights_only = false;
  /// Where a raster's heights go.
  std::pmr::memory_resource* memory = std::pmr::get_default_resource();
  /// Shown what is known before a raster's pixels are read, or after points are: an error ends the import. For files that
  /// are read in this process: a decoder process is not told.
  std::function<tin::base::Result<void>(const Import&)> look;
};

/// What a file holds, on a lattice that fits it.
struct Import {
  tin::frame::Frame frame;
  /// Valid pixels in the order of the file's rows, or points in the file's order; duplicates are not looked
  /// for. Heights are in frame.vertical_unit.
  std::vector<tin::terrain::Placement> placements;
  std::shared_ptr<tin::terrain::SourceGrid> grid;  // null for points
  tin::terrain::SourceSamples::Heights heights;    // of a raster: one per pixel, row by row
  std::string driver;                              // GDAL's name of the format, or "CSV"
  std::int32_t bands = 0;                          // of a raster, whose first is read
};

/// Takes the heights of a raster as they are read, for one who does not hold them all.
class RowTaker {
 public:
  virtual ~RowTaker() = default;
  /// Once, before the first of them: frame, driver and grid are known, but not its mask. False: no more is
  /// wanted.
  virtual bool begin(const Import& import) = 0;
  /// The next pixels, row by row, whole rows at a time; NaN where there is no sample. False: no more is
  /// wanted.
  virtual bool take(std::span<const double> heights) = 0;
};

/// Reads an uploaded file, which stays where it is, in this process: see decoder.h for hostile ones. Only
/// formats of a fixed list are tried, on a private link to the file without its neighbours, and no network,
/// VRT or sidecar file can be reached by what it says.
///
/// Rasters: band 1, pixel centres, scale and offset applied; pixels that are nodata, masked, not finite or
/// larger than 1e30 (undeclared fill values) are void. Rows may run north to south or south to north.
/// Points: columns or fields by their usual names, else the first three numeric columns; GeoJSON is CRS84
/// unless it says otherwise, and columns called longitude and latitude are too. A shapefile may come alone
/// (its .shp, with heights in it and without a CRS) or in a ZIP archive that holds it with its companions.
/// Meshes and surfaces: their vertices; the triangulation is always the terrain's own. A file that was
/// exported by us notes its lattice, and is put on it again.
///
/// Errors: kInvalidValue (empty file or raster, no valid sample, no georeference, an HGT without its name, no
/// heights, unknown layer or field), kUnsupported (format, CRS, rotated raster, complex pixels), kMalformed
/// (with the line for text), kNotFinite, kTooLarge, kCancelled, kStorage, those of options.look. Threads: any number at once on
/// different files. `progress` may be null. With `rows` and options.heights_only a raster's heights and mask
/// go there, and the import is without them.
tin::base::Result<Import> import_file(const std::filesystem::path& uploaded, const ImportOptions& options,
                                      tin::base::Progress* progress, RowTaker* rows = nullptr);

}  // namespace server::gdal
