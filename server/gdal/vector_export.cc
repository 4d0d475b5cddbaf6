#include "server/gdal/vector_export.h"

#include <cpl_conv.h>
#include <cpl_string.h>
#include <gdal_priv.h>
#include <ogrsf_frmts.h>

#include <system_error>

#include "proto/formats/frame_note.h"
#include "server/gdal/crs_internal.h"
#include "server/gdal/library.h"
#include "server/gdal/not_written.h"

namespace server::gdal {

using tin::base::Code;
using tin::base::error;
using tin::base::Error;
using tin::base::Result;

namespace {

using Dataset = std::unique_ptr<GDALDataset, GDALDatasetUniquePtrDeleter>;

constexpr int kPatch = 20'000;

/// Settings of GDAL for this thread while they live: no clock in the file, so that equal input gives equal
/// bytes, and no waiting for the disk, since a file that was not finished is thrown away.
class Settings {
 public:
  Settings() {
    CPLSetThreadLocalConfigOption("OGR_CURRENT_DATE", "1970-01-01T00:00:00.000Z");
    CPLSetThreadLocalConfigOption("OGR_SQLITE_SYNCHRONOUS", "OFF");
  }
  ~Settings() {
    CPLSetThreadLocalConfigOption("OGR_CURRENT_DATE", nullptr);
    CPLSetThreadLocalConfigOption("OGR_SQLITE_SYNCHRONOUS", nullptr);
  }
  Settings(const Settings&) = delete;
  Settings& operator=(const Settings&) = delete;
};

const char* name_of(VectorLayer layer) {
  if (layer == VectorLayer::kVertices) return "vertices";
  return layer == VectorLayer::kTriangles ? "triangles" : "surface";
}

OGRwkbGeometryType type_of(VectorLayer layer) {
  if (layer == VectorLayer::kVertices) return wkbPoint25D;
  return layer == VectorLayer::kTriangles ? wkbPolygon25D : wkbTINZ;
}

OGRPoint point(const proto::Position& at) {
  return {at.x, at.y, at.z};
}

/// A closed ring of three corners in a polygon of any kind.
template <class Polygon>
std::unique_ptr<Polygon> polygon(const std::array<proto::Position, 3>& corners) {
  auto ring = std::make_unique<OGRLinearRing>();
  ring->setNumPoints(4);
  for (int i = 0; i < 4; ++i) {
    const proto::Position& at = corners[static_cast<std::size_t>(i) % 3];
    ring->setPoint(i, at.x, at.y, at.z);
  }
  auto made = std::make_unique<Polygon>();
  made->addRingDirectly(ring.release());
  return made;
}

}  // namespace

struct VectorFile::Impl {
  std::filesystem::path out;
  VectorSpec spec;
  Settings settings;
  Complaints complaints;
  std::unique_ptr<OGRSpatialReference> crs;
  Dataset dataset;
  OGRLayer* layer = nullptr;
  VectorLayer kind = VectorLayer::kVertices;
  std::unique_ptr<OGRTriangulatedSurface> patch;

  Error failed() const {
    return not_written("The file could not be written" + complaints.aside(out.parent_path()), out);
  }

  Result<void> add(OGRFeature& feature) {
    if (layer->CreateFeature(&feature) != OGRERR_NONE) return failed();
    return {};
  }

  /// Writes the patch of the surface at hand.
  Result<void> end_patch() {
    if (!patch || patch->IsEmpty()) return {};
    OGRFeature feature(layer->GetLayerDefn());
    feature.SetField("triangles", patch->getNumGeometries());
    feature.SetGeometryDirectly(patch.release());
    return add(feature);
  }
};

VectorFile::VectorFile(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
VectorFile::VectorFile(VectorFile&&) noexcept = default;
VectorFile::~VectorFile() = default;

Result<VectorFile> VectorFile::create(const std::filesystem::path& out, const VectorSpec& spec) {
  prepare_library();
  auto impl = std::make_unique<Impl>();
  impl->out = out;
  impl->spec = spec;
  if (!spec.crs.empty()) {
    auto crs = parse_crs(spec.crs);
    if (!crs) return crs.error();
    impl->crs = *std::move(crs);
  }
  std::error_code ignored;
  std::filesystem::remove(out, ignored);
  const char* const driver = spec.driver == VectorDriver::kGeoPackage ? "GPKG" : "FlatGeobuf";
  CPLStringList options;
  if (spec.driver == VectorDriver::kGeoPackage) options.SetNameValue("VERSION", "1.3");
  impl->dataset.reset(GetGDALDriverManager()->GetDriverByName(driver)->Create(out.c_str(), 0, 0, 0,
                                                                              GDT_Unknown, options.List()));
  if (!impl->dataset) return impl->failed();
  return VectorFile(std::move(impl));
}

Result<void> VectorFile::begin(VectorLayer kind) {
  Impl& impl = *impl_;
  if (auto ended = impl.end_patch(); !ended) return ended;
  CPLStringList options;
  if (impl.spec.driver == VectorDriver::kFlatGeobuf)
    options.SetNameValue("TEMPORARY_DIR", impl.out.parent_path().c_str());
  if (impl.layer != nullptr && impl.dataset->CommitTransaction() != OGRERR_NONE) return impl.failed();
  impl.kind = kind;
  impl.layer = impl.dataset->CreateLayer(name_of(kind), impl.crs.get(), type_of(kind), options.List());
  if (impl.layer == nullptr) return impl.failed();
  const auto field = [&impl](const char* name, OGRFieldType type) {
    OGRFieldDefn definition(name, type);
    return impl.layer->CreateField(&definition) == OGRERR_NONE;
  };
  bool good = true;
  if (kind == VectorLayer::kVertices) good = field("id", OFTInteger64) && field("z", OFTReal);
  if (kind == VectorLayer::kTriangles)
    good = field("a", OFTInteger64) && field("b", OFTInteger64) && field("c", OFTInteger64);
  if (kind == VectorLayer::kSurface) good = field("triangles", OFTInteger);
  if (!good) return impl.failed();
  if (!impl.spec.note.empty() && impl.spec.driver == VectorDriver::kGeoPackage) {
    const std::string name(proto::formats::kFrameNoteName);
    impl.layer->SetMetadataItem(name.c_str(), impl.spec.note.c_str());
  }
  if (impl.spec.driver == VectorDriver::kGeoPackage && impl.dataset->StartTransaction() != OGRERR_NONE)
    return impl.failed();
  return {};
}

Result<void> VectorFile::add_vertex(proto::VertexId id, const proto::Position& at) {
  OGRFeature feature(impl_->layer->GetLayerDefn());
  feature.SetField(0, static_cast<GIntBig>(id.value()));
  feature.SetField(1, at.z);
  const OGRPoint geometry = point(at);
  feature.SetGeometry(&geometry);
  return impl_->add(feature);
}

Result<void> VectorFile::add_triangle(const std::array<proto::VertexId, 3>& ids,
                                      const std::array<proto::Position, 3>& corners) {
  Impl& impl = *impl_;
  if (impl.kind == VectorLayer::kTriangles) {
    OGRFeature feature(impl.layer->GetLayerDefn());
    for (int i = 0; i < 3; ++i)
      feature.SetField(i, static_cast<GIntBig>(ids[static_cast<std::size_t>(i)].value()));
    feature.SetGeometryDirectly(polygon<OGRPolygon>(corners).release());
    return impl.add(feature);
  }
  if (!impl.patch) impl.patch = std::make_unique<OGRTriangulatedSurface>();
  if (impl.patch->addGeometryDirectly(polygon<OGRTriangle>(corners).release()) != OGRERR_NONE)
    return impl.failed();
  if (impl.patch->getNumGeometries() < kPatch) return {};
  return impl.end_patch();
}

Result<void> VectorFile::finish() {
  Impl& impl = *impl_;
  if (auto ended = impl.end_patch(); !ended) return ended;
  if (impl.spec.driver == VectorDriver::kGeoPackage && impl.dataset->CommitTransaction() != OGRERR_NONE)
    return impl.failed();
  impl.dataset.reset();
  // Closing reports its failures, such as a full disk, only as messages.
  if (impl.complaints.any()) return impl.failed();
  return {};
}

}  // namespace server::gdal
