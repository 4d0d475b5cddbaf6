// Points of GeoJSON, GeoPackage, FlatGeobuf and shape files.
#include <cpl_conv.h>
#include <gdal_priv.h>
#include <ogrsf_frmts.h>

#include <array>
#include <cmath>
#include <memory>

#include "proto/formats/byte_reader.h"
#include "proto/formats/frame_note.h"
#include "server/gdal/import_internal.h"
#include "server/gdal/library.h"

namespace server::gdal {
namespace {

using tin::base::Code;
using tin::base::error;
using tin::base::Error;
using tin::base::Result;

using Dataset = std::unique_ptr<GDALDataset, GDALDatasetUniquePtrDeleter>;

const char* driver_name(Format format) {
  if (format == Format::kGeoPackage) return "GPKG";
  if (format == Format::kShapefile || format == Format::kZippedShapefile) return "ESRI Shapefile";
  return format == Format::kFlatGeobuf ? "FlatGeobuf" : "GeoJSON";
}

/// While it lives, a shapefile that came without its index is read all the same.
class IndexMadeAnew {
 public:
  IndexMadeAnew() { CPLSetThreadLocalConfigOption("SHAPE_RESTORE_SHX", "YES"); }
  ~IndexMadeAnew() { CPLSetThreadLocalConfigOption("SHAPE_RESTORE_SHX", nullptr); }
  IndexMadeAnew(const IndexMadeAnew&) = delete;
  IndexMadeAnew& operator=(const IndexMadeAnew&) = delete;
};

Result<Dataset> open(const ImportTask& task, const Complaints& complaints) {
  std::filesystem::path file = task.workspace.file();
  if (task.format == Format::kZippedShapefile) {
    auto unpacked = unpack_shapefile(task);
    if (!unpacked) return unpacked.error();
    file = *std::move(unpacked);
  }
  const IndexMadeAnew index;
  const char* const drivers[] = {driver_name(task.format), nullptr};
  Dataset dataset(GDALDataset::Open(file.c_str(), GDAL_OF_VECTOR | GDAL_OF_READONLY, drivers));
  if (!dataset) {
    return error(Code::kMalformed, "The " + std::string(format_title(task.format)) +
                                       " file cannot be read, or it holds no features" +
                                       complaints.aside(task.workspace.folder()));
  }
  return dataset;
}

/// The layer that is asked for, else the first of points, else the first that may hold some.
Result<OGRLayer*> choose_layer(GDALDataset& dataset, const std::string& wanted) {
  OGRLayer* perhaps = nullptr;
  for (int i = 0; i < dataset.GetLayerCount(); ++i) {
    OGRLayer* layer = dataset.GetLayer(i);
    if (!wanted.empty()) {
      if (wanted == layer->GetName()) return layer;
      continue;
    }
    const OGRwkbGeometryType type = wkbFlatten(layer->GetGeomType());
    if (type == wkbPoint || type == wkbMultiPoint) return layer;
    if (type == wkbUnknown && perhaps == nullptr) perhaps = layer;
  }
  if (!wanted.empty()) return error(Code::kInvalidValue, "The file has no layer of this name", "query:layer");
  if (perhaps == nullptr) return error(Code::kInvalidValue, "The file has no layer of points");
  return perhaps;
}

bool is_numeric(const OGRFieldDefn& field) {
  return field.GetType() == OFTInteger || field.GetType() == OFTInteger64 || field.GetType() == OFTReal;
}

/// The field that holds heights: the one asked for, else (as a fallback for points without z) one of a usual
/// name.
struct HeightField {
  int index = -1;
  bool asked = false;
};
Result<HeightField> choose_height_field(const OGRFeatureDefn& definition, const std::string& wanted) {
  if (!wanted.empty()) {
    const int index = definition.GetFieldIndex(wanted.c_str());
    if (index < 0 || !is_numeric(*definition.GetFieldDefn(index))) {
      return error(Code::kInvalidValue, "The layer has no numeric field of this name", "query:z-field");
    }
    return HeightField{index, true};
  }
  for (const char* name : {"z", "elevation", "elev", "height", "altitude", "alt"}) {
    const int index = definition.GetFieldIndex(name);
    if (index >= 0 && is_numeric(*definition.GetFieldDefn(index))) return HeightField{index, false};
  }
  return HeightField{};
}

/// Adds the points of features one by one.
class PointReader {
 public:
  PointReader(HeightField height, std::uint64_t limit) : height_(height), limit_(limit) {}

  std::optional<Error> add(OGRFeature& feature) {
    ++count_;
    const OGRGeometry* geometry = feature.GetGeometryRef();
    // GDAL also drops a position that holds something other than numbers.
    if (geometry == nullptr || geometry->IsEmpty()) return fail(Code::kMalformed, "has no position");
    const OGRwkbGeometryType type = wkbFlatten(geometry->getGeometryType());
    if (type == wkbPoint) return add(feature, *geometry->toPoint());
    if (type != wkbMultiPoint) {
      return fail(Code::kUnsupported,
                  std::string("is a ") + geometry->getGeometryName() + "; only points are read");
    }
    for (const OGRPoint* point : *geometry->toMultiPoint()) {
      if (point->IsEmpty()) return fail(Code::kMalformed, "has no position");
      if (auto bad = add(feature, *point)) return bad;
    }
    return std::nullopt;
  }

  std::uint64_t count() const { return count_; }
  std::vector<RawPoint> take() { return std::move(points_); }

 private:
  std::optional<Error> add(OGRFeature& feature, const OGRPoint& point) {
    RawPoint raw{point.getX(), point.getY(), point.getZ()};
    if (height_.asked || !point.Is3D()) {
      if (height_.index < 0) {
        return fail(Code::kInvalidValue, "has no height: give points a z, or name a field with z-field");
      }
      if (!feature.IsFieldSetAndNotNull(height_.index)) {
        return fail(Code::kInvalidValue, "has no value in the field of heights");
      }
      raw.z = feature.GetFieldAsDouble(height_.index);
    }
    if (!std::isfinite(raw.x) || !std::isfinite(raw.y) || !std::isfinite(raw.z)) {
      return fail(Code::kNotFinite, "has a coordinate that is not a finite number");
    }
    if (points_.size() >= limit_) return too_many_samples(limit_);
    points_.push_back(raw);
    return std::nullopt;
  }

  Error fail(Code code, const std::string& what) const {
    return error(code, "Feature " + std::to_string(count_) + " " + what, "feature " + std::to_string(count_));
  }

  HeightField height_;
  std::uint64_t limit_;
  std::uint64_t count_ = 0;
  std::vector<RawPoint> points_;
};

/// What a file of ours notes of the lattice: as metadata, or as a member of the GeoJSON.
std::string note_of(const ImportTask& task, OGRLayer& layer) {
  constexpr std::size_t kHead = 64 * 1024;
  if (task.format == Format::kGeoJson) {
    std::string head(kHead, '\0');
    proto::formats::FileReader file(task.workspace.file());
    head.resize(file.read(head.data(), head.size()));
    return std::string(proto::formats::find_frame_member(head));
  }
  const std::string name(proto::formats::kFrameNoteName);
  const char* const note = layer.GetMetadataItem(name.c_str());
  return note == nullptr ? "" : note;
}

}  // namespace

Result<RawPoints> read_vector_points(const ImportTask& task) {
  const Complaints complaints;
  auto dataset = open(task, complaints);
  if (!dataset) return dataset.error();
  const auto layer = choose_layer(**dataset, task.options.layer);
  if (!layer) return layer.error();
  const auto height = choose_height_field(*(*layer)->GetLayerDefn(), task.options.z_field);
  if (!height) return height.error();
  auto crs = effective_crs(task, (*layer)->GetSpatialRef());
  if (!crs) return crs.error();

  const GIntBig expected = (*layer)->GetFeatureCount(FALSE);
  PointReader reader(*height, task.options.max_samples);
  while (const std::unique_ptr<OGRFeature> feature{(*layer)->GetNextFeature()}) {
    if (auto bad = reader.add(*feature)) return *std::move(bad);
    if (reader.count() % 10000 != 0) continue;
    if (task.cancelled()) return cancelled_error();
    if (expected > 0) task.report(0.9 * static_cast<double>(reader.count()) / static_cast<double>(expected));
  }
  if (complaints.any()) {
    return error(Code::kMalformed, "The file is damaged, or says what we do not accept" +
                                       complaints.aside(task.workspace.folder()));
  }
  RawPoints raw;
  raw.points = reader.take();
  raw.crs = *std::move(crs);
  raw.driver = driver_name(task.format);
  if (const std::string note = note_of(task, **layer); !note.empty()) {
    if (auto taken = take_note(raw, note); !taken) return taken.error();
  }
  return raw;
}

}  // namespace server::gdal
