// Exports of vertices and triangles as features.
#include "proto/formats/frame_note.h"
#include "server/api/export_coordinates.h"
#include "server/api/export_formats.h"
#include "server/gdal/vector_export.h"

namespace server::api {

using proto::formats::GeoJsonWriter;

namespace {

constexpr std::size_t kPiece = 64 * 1024;

/// A GeoJSON file made while the client takes it, from one version.
class GeoJsonSource : public http::BodySource {
 public:
  GeoJsonSource(const ExportTask& task, GeoJsonCoordinates coordinates)
      : version_(task.version),
        kind_(task.kind),
        reader_(*version_.terrain, kind_, {}, std::move(coordinates.positions), task.wanted.box,
                task.wanted.voids),
        writer_(buffer_, coordinates.rounding) {
    writer_.begin(coordinates.head);
  }

  bool next(std::string& piece) override {
    while (!ended_ && buffer_.size() < kPiece) {
      if (const auto feature = reader_.next()) {
        write_feature(writer_, kind_, *feature);
      } else {
        writer_.end();
        ended_ = true;
      }
    }
    piece.swap(buffer_);
    buffer_.clear();
    return !piece.empty();
  }

 private:
  const app::Version version_;
  const FeatureKind kind_;
  FeatureReader reader_;
  std::string buffer_;
  GeoJsonWriter writer_;
  bool ended_ = false;
};

/// The coordinates of features: the TIN's own, or converted to the CRS that is asked for.
Result<Positions> positions_of(const ExportTask& task, std::string& crs) {
  const auto& frame = task.terrain().frame();
  crs = task.wanted.crs.empty() ? frame.crs : task.wanted.crs;
  return Positions::between(frame.crs, crs, "query:crs");
}

/// Adds all features of a kind, as they are or as patches of the surface.
Result<void> add_layer(const ExportTask& task, gdal::VectorFile& file, gdal::VectorLayer layer) {
  if (auto begun = file.begin(layer); !begun) return begun;
  const FeatureKind kind =
      layer == gdal::VectorLayer::kVertices ? FeatureKind::kVertices : FeatureKind::kTriangles;
  std::string crs;
  auto positions = positions_of(task, crs);
  if (!positions) return positions.error();
  FeatureReader reader(task.terrain(), kind, {}, std::move(*positions), task.wanted.box, task.wanted.voids);
  for (std::uint64_t count = 0;; ++count) {
    if (count % 1024 == 0) {
      if (auto going = task.patience.check(); !going) return going;
    }
    const auto feature = reader.next();
    if (!feature) return {};
    auto added = kind == FeatureKind::kVertices ? file.add_vertex(feature->ids[0], feature->corners[0])
                                                : file.add_triangle(feature->ids, feature->corners);
    if (!added) return added;
  }
}

Result<http::Body> vector_file(ExportTask& task, gdal::VectorDriver driver,
                               const std::vector<gdal::VectorLayer>& layers) {
  gdal::VectorSpec spec;
  spec.driver = driver;
  const auto positions = positions_of(task, spec.crs);
  if (!positions) return positions.error();
  if (positions->identity()) spec.note = proto::formats::frame_note(task.terrain().frame());
  return file_body(task.context, task.format.suffix, [&](const std::filesystem::path& out) -> Result<void> {
    auto file = gdal::VectorFile::create(out, spec);
    if (!file) return file.error();
    for (const gdal::VectorLayer layer : layers) {
      if (auto added = add_layer(task, *file, layer); !added) return added;
    }
    return file->finish();
  });
}

}  // namespace

Result<http::Body> export_geojson(ExportTask& task) {
  auto coordinates = geojson_coordinates(task.terrain().frame(), task.wanted.crs);
  if (!coordinates) return coordinates.error();
  return http::Body(std::make_unique<GeoJsonSource>(task, std::move(*coordinates)));
}

Result<http::Body> export_geopackage(ExportTask& task) {
  using gdal::VectorLayer;
  return vector_file(task, gdal::VectorDriver::kGeoPackage,
                     {VectorLayer::kVertices, VectorLayer::kTriangles, VectorLayer::kSurface});
}

Result<http::Body> export_flatgeobuf(ExportTask& task) {
  if (task.kind == FeatureKind::kEdges) {
    return tin::base::error(tin::base::Code::kInvalidValue, "Edges are written as GeoJSON only.",
                            "query:collection");
  }
  const bool vertices = task.kind == FeatureKind::kVertices;
  return vector_file(task, gdal::VectorDriver::kFlatGeobuf,
                     {vertices ? gdal::VectorLayer::kVertices : gdal::VectorLayer::kTriangles});
}

}  // namespace server::api
