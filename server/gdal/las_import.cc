// Points of LAS files, read by proto/formats; their CRS is understood by GDAL.
#include <cpl_conv.h>
#include <gdal_priv.h>

#include <bit>
#include <fstream>
#include <memory>

#include "proto/formats/las.h"
#include "proto/formats/little_endian.h"
#include "server/gdal/import_internal.h"
#include "server/gdal/library.h"

namespace server::gdal {
namespace {

using proto::formats::append_little;
using proto::formats::LasFile;
using tin::base::Code;
using tin::base::error;
using tin::base::Result;

using Dataset = std::unique_ptr<GDALDataset, GDALDatasetUniquePtrDeleter>;

/// A TIFF of one pixel with the GeoTIFF tags of a LAS file, so that GDAL can tell what they mean.
std::string tiff_of(const LasFile& las) {
  struct Tag {
    std::uint16_t id, type;
    std::uint32_t count;
    std::string value;
  };
  constexpr std::uint16_t kShort = 3, kLong = 4, kDouble = 12, kAscii = 2;
  const auto number = [](std::uint16_t id, std::uint16_t value) {
    std::string bytes;
    append_little(bytes, value);
    return Tag{id, kShort, 1, bytes};
  };
  std::string keys, doubles, place;
  for (const std::uint16_t key : las.geo_keys) append_little(keys, key);
  for (const double value : las.geo_doubles) append_little(doubles, std::bit_cast<std::uint64_t>(value));
  append_little(place, std::uint32_t{8});  // of the pixel, behind the header
  std::vector<Tag> tags{
      number(256, 1), number(257, 1),
      number(258, 8), number(259, 1),
      number(262, 1), Tag{273, kLong, 1, place},
      number(277, 1), number(278, 1),
      number(279, 1), Tag{34735, kShort, static_cast<std::uint32_t>(las.geo_keys.size()), keys}};
  if (!doubles.empty())
    tags.push_back({34736, kDouble, static_cast<std::uint32_t>(las.geo_doubles.size()), doubles});
  if (!las.geo_ascii.empty())
    tags.push_back({34737, kAscii, static_cast<std::uint32_t>(las.geo_ascii.size()), las.geo_ascii});

  std::string head("II*\0", 4), directory, values;
  append_little(head, std::uint32_t{16});
  head += std::string(8, '\0');
  const std::size_t values_at = 16 + 2 + 12 * tags.size() + 4;
  append_little(directory, static_cast<std::uint16_t>(tags.size()));
  for (Tag& tag : tags) {
    append_little(directory, tag.id);
    append_little(directory, tag.type);
    append_little(directory, tag.count);
    if (tag.value.size() <= 4) {
      tag.value.resize(4);
      directory += tag.value;
      continue;
    }
    append_little(directory, static_cast<std::uint32_t>(values_at + values.size()));
    tag.value.resize((tag.value.size() + 7) / 8 * 8);
    values += tag.value;
  }
  append_little(directory, std::uint32_t{0});
  return head + directory + values;
}

/// The CRS that the GeoTIFF tags of the file mean; nothing if they mean none.
Result<std::optional<CrsInfo>> crs_of_tags(const ImportTask& task, const LasFile& las) {
  if (las.geo_keys.size() < 4) return std::optional<CrsInfo>();
  const auto file = task.workspace.folder() / "crs.tif";
  std::ofstream out(file, std::ios::binary);
  out << tiff_of(las);
  out.close();
  if (!out) return error(Code::kStorage, "The file's CRS could not be written where it is read");
  const Complaints complaints;
  const char* const drivers[] = {"GTiff", nullptr};
  const Dataset dataset(GDALDataset::Open(file.c_str(), GDAL_OF_RASTER | GDAL_OF_READONLY, drivers));
  if (!dataset) {
    return error(Code::kMalformed, "The GeoTIFF tags of the LAS file cannot be read" +
                                       complaints.aside(task.workspace.folder()));
  }
  return effective_crs(task, dataset->GetSpatialRef());
}

Result<std::optional<CrsInfo>> crs_of(const ImportTask& task, const LasFile& las) {
  if (task.asked_crs) return task.asked_crs;
  if (!las.mesh.crs.empty()) {
    // Some writers put something else there; the tags may still be good.
    auto crs = read_crs(las.mesh.crs);
    if (crs) return std::optional<CrsInfo>(*std::move(crs));
    if (las.geo_keys.empty()) return crs.error();
  }
  return crs_of_tags(task, las);
}

/// The unit of heights by the key VerticalUnits, which GDAL tells only together with a vertical CRS.
std::optional<VerticalUnit> vertical_unit_of_tags(const LasFile& las) {
  constexpr std::uint16_t kVerticalUnits = 4099;
  for (std::size_t i = 4; i + 4 <= las.geo_keys.size(); i += 4) {
    if (las.geo_keys[i] != kVerticalUnits || las.geo_keys[i + 1] != 0) continue;
    if (las.geo_keys[i + 3] == 9001) return vertical_unit("metre");
    if (las.geo_keys[i + 3] == 9002) return vertical_unit("foot");
    if (las.geo_keys[i + 3] == 9003) return vertical_unit("US survey foot");
  }
  return std::nullopt;
}

}  // namespace

Result<RawPoints> read_las_points(const ImportTask& task) {
  proto::formats::FileReader file(task.workspace.file());
  const double bytes = static_cast<double>(std::max<std::uint64_t>(1, file.size()));
  proto::formats::ReadLimits limits;
  limits.points = task.options.max_samples;
  limits.check = [&](std::uint64_t read) -> Result<void> {
    if (task.cancelled()) return cancelled_error();
    task.report(0.9 * static_cast<double>(read) / bytes);
    return {};
  };
  proto::formats::LasClasses classes;
  for (const std::uint8_t one : task.options.classes) classes.set(one);
  if (task.options.classes.empty()) classes.set();
  auto las = read_las(file, classes, limits);
  if (!las) return las.error();
  if (las->mesh.points.empty() && las->others > 0)
    return error(Code::kInvalidValue, "The file holds no points of these classes", "query:class");
  auto crs = crs_of(task, *las);
  if (!crs) return crs.error();
  RawPoints raw;
  raw.driver = format_title(task.format);
  raw.crs = *std::move(crs);
  raw.vertical = vertical_unit_of_tags(*las);
  raw.points.reserve(las->mesh.points.size());
  for (const proto::Position& at : las->mesh.points) raw.points.push_back({at.x, at.y, at.z});
  return raw;
}

}  // namespace server::gdal
