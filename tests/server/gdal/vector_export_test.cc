#include "server/gdal/vector_export.h"

#include <gdal_priv.h>
#include <ogrsf_frmts.h>

#include <fstream>
#include <iterator>

#include "tests/server/gdal/support.h"

namespace server::gdal::testing {
namespace {

using proto::Position;
using proto::VertexId;
using tin::base::Code;

class VectorExportTest : public ScratchTest {
 protected:
  std::string bytes(const std::string& name) const {
    std::ifstream in(path(name), std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  /// A strip of so many triangles, in the layers that the driver takes.
  void write(const std::string& name, const VectorSpec& spec, const std::vector<VectorLayer>& layers,
             int triangles) {
    auto file = VectorFile::create(path(name), spec);
    ASSERT_TRUE(file.ok()) << file.error().message;
    const auto at = [](int i) { return Position{500000.25 + i / 2, 4100000 + i % 2 + 1.0 / 3, i * 0.1}; };
    for (const VectorLayer layer : layers) {
      ASSERT_TRUE(file->begin(layer).ok());
      for (int i = 0; i < triangles + (layer == VectorLayer::kVertices ? 2 : 0); ++i) {
        const auto id = [](int n) { return VertexId(static_cast<std::uint64_t>(n) + 5'000'000'000); };
        const auto added = layer == VectorLayer::kVertices
                               ? file->add_vertex(id(i), at(i))
                               : file->add_triangle({id(i), id(i + 1 + i % 2), id(i + 2 - i % 2)},
                                                    {at(i), at(i + 1 + i % 2), at(i + 2 - i % 2)});
        ASSERT_TRUE(added.ok());
      }
    }
    ASSERT_TRUE(file->finish().ok());
  }
};

const std::vector<VectorLayer> kAll{VectorLayer::kVertices, VectorLayer::kTriangles, VectorLayer::kSurface};

TEST_F(VectorExportTest, AGeoPackageHasVerticesTrianglesAndASurfaceInPatches) {
  write("out.gpkg", {.driver = VectorDriver::kGeoPackage, .crs = "EPSG:32632", .note = "{}"}, kAll, 45'000);
  GDALDatasetUniquePtr dataset(GDALDataset::Open(path("out.gpkg").c_str(), GDAL_OF_VECTOR));
  ASSERT_TRUE(dataset);
  ASSERT_EQ(dataset->GetLayerCount(), 3);
  OGRLayer& vertices = *dataset->GetLayerByName("vertices");
  EXPECT_EQ(vertices.GetFeatureCount(), 45'002);
  EXPECT_EQ(vertices.GetGeomType(), wkbPoint25D);
  EXPECT_EQ(std::string(vertices.GetSpatialRef()->GetAuthorityCode(nullptr)), "32632");
  const std::unique_ptr<OGRFeature> first{vertices.GetNextFeature()}, second{vertices.GetNextFeature()};
  EXPECT_EQ(second->GetFieldAsInteger64("id"), 5'000'000'001);
  EXPECT_EQ(second->GetGeometryRef()->toPoint()->getY(), 4100001 + 1.0 / 3);
  EXPECT_EQ(second->GetFieldAsDouble("z"), 0.1);
  OGRLayer& triangles = *dataset->GetLayerByName("triangles");
  EXPECT_EQ(triangles.GetFeatureCount(), 45'000);
  const std::unique_ptr<OGRFeature> triangle{triangles.GetNextFeature()};
  EXPECT_EQ(triangle->GetFieldAsInteger64("b"), 5'000'000'001);
  EXPECT_EQ(triangle->GetGeometryRef()->toPolygon()->getExteriorRing()->getNumPoints(), 4);
  OGRLayer& surface = *dataset->GetLayerByName("surface");
  EXPECT_EQ(surface.GetGeomType(), wkbTINZ);
  std::vector<int> patches;
  double area = 0;
  for (std::unique_ptr<OGRFeature> patch; patch.reset(surface.GetNextFeature()), patch != nullptr;) {
    const OGRGeometry& geometry = *patch->GetGeometryRef();
    EXPECT_EQ(geometry.getGeometryType(), wkbTINZ);
    patches.push_back(geometry.toTriangulatedSurface()->getNumGeometries());
    EXPECT_EQ(patch->GetFieldAsInteger("triangles"), patches.back());
    for (const auto* one : *geometry.toTriangulatedSurface()) area += one->get_Area();
  }
  EXPECT_EQ(patches, (std::vector<int>{20'000, 20'000, 5'000}));
  EXPECT_NEAR(area, 45'000 * 0.5, 1e-3);
}

TEST_F(VectorExportTest, AFlatGeobufHasOneLayerAndAnIndex) {
  write("out.fgb", {.driver = VectorDriver::kFlatGeobuf, .crs = "EPSG:4326", .note = ""},
        {VectorLayer::kTriangles}, 500);
  GDALDatasetUniquePtr dataset(GDALDataset::Open(path("out.fgb").c_str(), GDAL_OF_VECTOR));
  ASSERT_TRUE(dataset);
  OGRLayer& layer = *dataset->GetLayer(0);
  EXPECT_EQ(layer.GetFeatureCount(), 500);
  EXPECT_EQ(layer.GetGeomType(), wkbPolygon25D);
  EXPECT_TRUE(layer.TestCapability(OLCFastSpatialFilter));
  EXPECT_EQ(files_left(), 1U);
}

TEST_F(VectorExportTest, EqualInputGivesEqualBytes) {
  for (const auto& [driver, layers] : std::vector<std::pair<VectorDriver, std::vector<VectorLayer>>>{
           {VectorDriver::kGeoPackage, kAll}, {VectorDriver::kFlatGeobuf, {VectorLayer::kVertices}}}) {
    const VectorSpec spec{.driver = driver, .crs = "EPSG:32632", .note = "{\"a\":1}"};
    const std::string suffix = driver == VectorDriver::kGeoPackage ? ".gpkg" : ".fgb";
    write("one" + suffix, spec, layers, 200);
    write("two" + suffix, spec, layers, 200);
    EXPECT_TRUE(bytes("one" + suffix) == bytes("two" + suffix));
    EXPECT_GT(bytes("one" + suffix).size(), 5000U);
  }
}

TEST_F(VectorExportTest, ErrorsAreTold) {
  EXPECT_EQ(VectorFile::create(path("none/out.gpkg"), {}).error().code, Code::kStorage);
  EXPECT_EQ(
      VectorFile::create(path("out.gpkg"), {.driver = VectorDriver::kGeoPackage, .crs = "EPSG:1", .note = ""})
          .error()
          .code,
      Code::kUnsupported);
}

}  // namespace
}  // namespace server::gdal::testing
