// Vertices of mesh files and LandXML surfaces, read by proto/formats; what they say of their coordinates is
// understood here.
#include <cmath>

#include "proto/formats/landxml.h"
#include "proto/formats/obj.h"
#include "proto/formats/ply.h"
#include "proto/formats/sms_2dm.h"
#include "server/gdal/import_internal.h"

namespace server::gdal {
namespace {

using proto::formats::ByteReader;
using proto::formats::MeshPoints;
using proto::formats::ReadLimits;
using tin::base::Code;
using tin::base::error;
using tin::base::Result;

Result<MeshPoints> read(const ImportTask& task, ByteReader& bytes, const ReadLimits& limits) {
  switch (task.format) {
    case Format::kObj:
      return proto::formats::read_obj(bytes, limits);
    case Format::kPly:
      return proto::formats::read_ply(bytes, limits);
    case Format::kSms2dm:
      return proto::formats::read_2dm(bytes, limits);
    default:
      return proto::formats::read_landxml(bytes, task.options.layer, limits);
  }
}

/// The CRS that the file names, unless the client gave one. Errors: kInvalidValue when its unit is not the
/// file's; as read_crs().
Result<std::optional<CrsInfo>> crs_of(const ImportTask& task, const MeshPoints& mesh) {
  if (task.asked_crs) return task.asked_crs;
  if (mesh.crs.empty()) return std::optional<CrsInfo>();
  auto crs = read_crs(mesh.crs);
  if (!crs) return crs.error();
  const bool differs = mesh.horizontal && !crs->scale.geographic &&
                       std::abs(mesh.horizontal->metres / crs->scale.unit_m - 1) > 1e-6;
  if (differs) {
    return error(Code::kInvalidValue, "The file's coordinates are in " + mesh.horizontal->name +
                                          ", but its CRS counts otherwise: name the right CRS with crs");
  }
  return std::optional<CrsInfo>(*std::move(crs));
}

}  // namespace

Result<RawPoints> read_mesh_points(const ImportTask& task) {
  proto::formats::FileReader file(task.workspace.file());
  const double bytes = static_cast<double>(std::max<std::uint64_t>(1, file.size()));
  ReadLimits limits;
  limits.points = task.options.max_samples;
  limits.check = [&](std::uint64_t read) -> Result<void> {
    if (task.cancelled()) return cancelled_error();
    task.report(0.9 * static_cast<double>(read) / bytes);
    return {};
  };
  auto mesh = read(task, file, limits);
  if (!mesh) return mesh.error();
  RawPoints raw;
  raw.driver = format_title(task.format);
  auto crs = crs_of(task, *mesh);
  if (!crs) return crs.error();
  raw.crs = *std::move(crs);
  if (mesh->vertical) raw.vertical = VerticalUnit{mesh->vertical->name, mesh->vertical->metres};
  if (!raw.crs && mesh->horizontal) raw.unit_m = mesh->horizontal->metres;
  raw.noted = std::move(mesh->frame);
  raw.points.reserve(mesh->points.size());
  for (const proto::Position& at : mesh->points) raw.points.push_back({at.x, at.y, at.z});
  return raw;
}

}  // namespace server::gdal
