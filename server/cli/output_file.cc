#include "server/cli/output_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <fstream>
#include <limits>
#include <system_error>
#include <utility>

#include "proto/formats/mesh_formats.h"
#include "proto/formats/terrain_mesh.h"
#include "server/api/export_coordinates.h"
#include "server/api/export_grid.h"
#include "server/api/feature_reader.h"
#include "server/gdal/geotiff.h"

namespace server::cli {

namespace fs = std::filesystem;

using tin::base::Code;
using tin::base::error;
using tin::base::Error;
using tin::base::Progress;
using tin::base::Result;
using tin::frame::Frame;
using tin::terrain::Terrain;

namespace {

constexpr std::size_t kPiece = std::size_t{1} << 20;

std::string suffix_of(const fs::path& file) {
  std::string suffix = file.extension();
  std::transform(suffix.begin(), suffix.end(), suffix.begin(),
                 [](unsigned char c) { return std::tolower(c); });
  return suffix;
}

bool is_geotiff(const std::string& suffix) {
  return suffix == ".tif" || suffix == ".tiff";
}

/// Null when the suffix is no mesh format's.
const proto::formats::MeshFormatEntry* mesh_format(const std::string& suffix) {
  for (const auto& entry : proto::formats::mesh_formats()) {
    if (entry.suffix == suffix) return &entry;
  }
  return nullptr;
}

bool is_geojson(const std::string& suffix) {
  return suffix == ".geojson" || suffix == ".json";
}

Error not_written(int reason) {
  return error(Code::kStorage, "cannot be written: " + std::generic_category().message(reason));
}

/// Appends pieces to a file. After a failure every call says why that was.
class Writer {
 public:
  explicit Writer(const fs::path& file) {
    errno = 0;
    out_.open(file, std::ios::binary | std::ios::trunc);
    if (!out_.good()) reason_ = reason();
  }
  Result<void> write(std::string_view bytes) {
    errno = 0;
    out_.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    return note();
  }
  Result<void> close() {
    errno = 0;
    out_.close();
    return note();
  }

 private:
  /// A stream does not say why it failed; the system does, until it is called again.
  static int reason() { return errno != 0 ? errno : EIO; }
  Result<void> note() {
    if (!out_.good() && reason_ == 0) reason_ = reason();
    if (reason_ != 0) return not_written(reason_);
    return {};
  }

  std::ofstream out_;
  int reason_ = 0;
};

Result<void> write_raster(const Terrain& terrain, const fs::path& file, Progress& progress) {
  api::ExportRequest request;
  request.max_pixels = std::numeric_limits<std::int32_t>::max();
  auto grid = api::ExportGrid::plan(terrain, request);
  if (!grid) return grid.error();
  const auto rows = [&](std::int64_t row, std::span<double> values) -> Result<void> {
    grid->sample_row(row, values);
    return {};
  };
  return gdal::write_geotiff(file, grid->spec(), rows, &progress);
}

Result<void> write_triangles(const Terrain& terrain, const fs::path& file, Progress& progress) {
  constexpr auto kKind = api::FeatureKind::kTriangles;
  auto coordinates = api::geojson_coordinates(terrain.frame());
  if (!coordinates) return coordinates.error();
  Writer out(file);
  std::string piece;
  proto::formats::GeoJsonWriter writer(piece, coordinates->rounding);
  writer.begin(coordinates->head);
  api::FeatureReader reader(terrain, kKind, {}, std::move(coordinates->positions), std::nullopt,
                            tin::query::Voids::kKeep);
  while (const auto feature = reader.next()) {
    api::write_feature(writer, kKind, *feature);
    if (piece.size() < kPiece) continue;
    if (progress.cancelled()) return error(Code::kCancelled, "cancelled");
    if (auto written = out.write(std::exchange(piece, {})); !written) return written;
  }
  writer.end();
  if (auto written = out.write(piece); !written) return written;
  return out.close();
}

Result<void> write_mesh(const proto::formats::MeshFormatEntry& entry, const Terrain& terrain,
                        const std::string& title, const fs::path& file, Progress& progress) {
  auto request = api::mesh_request(terrain.frame());
  if (!request) return request.error();
  request->title = title;
  auto mesh = proto::formats::TerrainMesh::create(terrain, *std::move(request));
  if (!mesh) return mesh.error();
  const auto format = entry.make();
  Writer out(file);
  const auto written =
      proto::formats::write_mesh(**mesh, *format, [&](std::string_view piece) -> Result<void> {
        if (progress.cancelled()) return error(Code::kCancelled, "cancelled");
        return out.write(piece);
      });
  return written ? out.close() : written;
}

/// Before there is a mesh to ask about.
Result<void> check_mesh_frame(const proto::formats::MeshFormatEntry& entry, const Frame& frame) {
  const auto request = api::mesh_request(frame);
  if (!request) return request.error();
  if (request->geographic && !entry.degrees) {
    return error(Code::kInvalidValue, std::string(entry.title) +
                                          " has northings and eastings, and the input is in degrees: it must be "
                                          "projected first (gdalwarp -t_srs)");
  }
  proto::formats::MeshHead head;
  head.crs = request->crs;
  head.geographic = request->geographic;
  head.unit_m = request->unit_m;
  return entry.make()->check(head);
}

Result<void> write_as(const std::string& suffix, const Terrain& terrain, const std::string& title,
                      const fs::path& file, Progress& progress) {
  if (is_geotiff(suffix)) return write_raster(terrain, file, progress);
  if (const auto* entry = mesh_format(suffix)) return write_mesh(*entry, terrain, title, file, progress);
  return write_triangles(terrain, file, progress);
}

/// The file itself, or the one that a chain of symbolic links names, which need not be there. Errors: kStorage.
Result<fs::path> target_of(fs::path file) {
  constexpr int kMostLinks = 40;
  std::error_code failed;
  for (int i = 0; i < kMostLinks; ++i) {
    if (!fs::is_symlink(file, failed)) return file;
    const fs::path next = fs::read_symlink(file, failed);
    if (failed) return not_written(failed.value());
    file = file.parent_path() / next;
  }
  return not_written(ELOOP);
}

/// The file that is written until it is whole: of the same suffix, by which GDAL chooses.
fs::path beside(fs::path target) {
  return target.replace_extension("." + std::to_string(::getpid()) + ".part" + target.extension().string());
}

/// Leaves nothing behind.
Result<void> try_to_create(const fs::path& part) {
  const int number = ::open(part.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0666);
  if (number < 0) return not_written(errno);
  ::close(number);
  ::unlink(part.c_str());
  return {};
}

}  // namespace

std::string output_formats() {
  std::string all = ".tif, .geojson";
  for (const auto& entry : proto::formats::mesh_formats()) {
    const std::string suffix(entry.suffix);
    if (mesh_format(suffix) == &entry && suffix == suffix_of("a" + suffix)) all += ", " + suffix;
  }
  return all;
}

Result<void> check_output_name(const fs::path& file) {
  const std::string suffix = suffix_of(file);
  if (is_geotiff(suffix) || is_geojson(suffix) || mesh_format(suffix) != nullptr) return {};
  return error(Code::kUnsupported, "its suffix is none of those that are written: " + output_formats());
}

Result<void> check_output(const fs::path& file, const fs::path& input) {
  std::error_code ignored;
  if (fs::equivalent(file, input, ignored)) return error(Code::kConflict, "is the input, which is not overwritten");
  const auto target = target_of(file);
  if (!target) return target.error();
  if (fs::is_directory(*target, ignored)) return error(Code::kStorage, "cannot be written: it is a folder");
  if (fs::exists(*target, ignored) && !fs::is_regular_file(*target, ignored))
    return error(Code::kStorage, "cannot be written: it is no regular file");
  return try_to_create(beside(*target));
}

Result<void> check_output_frame(const fs::path& file, const Frame& frame) {
  const std::string suffix = suffix_of(file);
  if (const auto* entry = mesh_format(suffix)) return check_mesh_frame(*entry, frame);
  if (!is_geojson(suffix)) return {};
  const auto coordinates = api::geojson_coordinates(frame);
  return coordinates ? Result<void>() : coordinates.error();
}

Result<void> write_output(const Terrain& terrain, const fs::path& file, Progress& progress) {
  const auto target = target_of(file);
  if (!target) return target.error();
  const fs::path part = beside(*target);
  auto written = write_as(suffix_of(file), terrain, file.stem(), part, progress);
  std::error_code failed;
  if (written && progress.cancelled()) written = error(Code::kCancelled, "cancelled");
  if (written) {
    // What is replaced keeps its permissions.
    if (const auto present = fs::status(*target, failed); fs::exists(present)) fs::permissions(part, present.permissions(), failed);
    fs::rename(part, *target, failed);
    if (failed) written = not_written(failed.value());
  }
  if (!written) fs::remove(part, failed);
  return written;
}

}  // namespace server::cli
