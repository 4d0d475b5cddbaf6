#include "server/cli/output_file.h"

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
#include "server/api/export_grid.h"
#include "server/api/feature_reader.h"
#include "server/gdal/geotiff.h"

namespace server::cli {

namespace fs = std::filesystem;

using tin::base::Code;
using tin::base::error;
using tin::base::Progress;
using tin::base::Result;
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

/// Appends pieces to a file; the first failure stays.
class Writer {
 public:
  explicit Writer(const fs::path& file) : out_(file, std::ios::binary | std::ios::trunc) {}
  void write(std::string_view bytes) { out_.write(bytes.data(), static_cast<std::streamsize>(bytes.size())); }
  Result<void> close() {
    out_.close();
    if (out_.good()) return {};
    return error(Code::kStorage, "cannot be written: " + std::generic_category().message(errno));
  }

 private:
  std::ofstream out_;
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
  auto positions = api::Positions::to_geojson(terrain.frame());
  if (!positions) return positions.error();
  const auto coordinates = terrain.frame().crs.empty() ? proto::formats::Coordinates::kProjected
                                                       : proto::formats::Coordinates::kDegrees;
  Writer out(file);
  std::string piece;
  proto::formats::GeoJsonWriter writer(piece, coordinates);
  writer.begin({});
  api::FeatureReader reader(terrain, api::FeatureKind::kTriangles, {}, std::move(*positions), std::nullopt);
  while (const auto feature = reader.next()) {
    api::write_feature(writer, api::FeatureKind::kTriangles, *feature);
    if (piece.size() < kPiece) continue;
    if (progress.cancelled()) return error(Code::kCancelled, "cancelled");
    out.write(std::exchange(piece, {}));
  }
  writer.end();
  out.write(piece);
  return out.close();
}

Result<void> write_mesh(const proto::formats::MeshFormatEntry& entry, const Terrain& terrain,
                        const std::string& title, const fs::path& file, Progress& progress) {
  proto::formats::MeshRequest request;
  request.title = title;
  auto mesh = proto::formats::TerrainMesh::create(terrain, std::move(request));
  if (!mesh) return mesh.error();
  const auto format = entry.make();
  Writer out(file);
  const auto written =
      proto::formats::write_mesh(**mesh, *format, [&](std::string_view piece) -> Result<void> {
        if (progress.cancelled()) return error(Code::kCancelled, "cancelled");
        out.write(piece);
        return {};
      });
  return written ? out.close() : written;
}

Result<void> write_as(const std::string& suffix, const Terrain& terrain, const std::string& title,
                      const fs::path& file, Progress& progress) {
  if (is_geotiff(suffix)) return write_raster(terrain, file, progress);
  if (const auto* entry = mesh_format(suffix)) return write_mesh(*entry, terrain, title, file, progress);
  return write_triangles(terrain, file, progress);
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

Result<void> check_output(const fs::path& file) {
  const std::string suffix = suffix_of(file);
  if (!is_geotiff(suffix) && !is_geojson(suffix) && mesh_format(suffix) == nullptr)
    return error(Code::kUnsupported, "its suffix is none of those that are written: " + output_formats());
  const fs::path folder = file.parent_path().empty() ? "." : file.parent_path();
  if (::access(folder.c_str(), W_OK) != 0)
    return error(Code::kStorage, "cannot be written: " + std::generic_category().message(errno));
  return {};
}

Result<void> write_output(const Terrain& terrain, const fs::path& file, Progress& progress) {
  if (auto fine = check_output(file); !fine) return fine;
  fs::path beside = file;
  beside.replace_extension("." + std::to_string(::getpid()) + ".part" + file.extension().string());
  auto written = write_as(suffix_of(file), terrain, file.stem(), beside, progress);
  std::error_code failed;
  if (written && progress.cancelled()) written = error(Code::kCancelled, "cancelled");
  if (written) {
    fs::rename(beside, file, failed);
    if (failed) written = error(Code::kStorage, "cannot be written: " + failed.message());
  }
  if (!written) fs::remove(beside, failed);
  return written;
}

}  // namespace server::cli
