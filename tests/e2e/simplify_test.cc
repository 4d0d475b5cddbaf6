// A simplified terrain keeps its promise at every sample of the source: judged by code that shares nothing
// with the server's.
#include "tests/e2e/dem.h"
#include "tests/e2e/served.h"

namespace tests::e2e {
namespace {

/// A terrain, and the CRS to ask for its triangles in.
struct Source {
  std::string name;
  std::string crs;
  bool sample;
};

class SimplifyTest : public ServedTest, public testing::WithParamInterface<Source> {
 protected:
  SimplifyTest() { start(); }
};

TEST_P(SimplifyTest, EverySampleIsWithinTheToleranceOfTheNewTin) {
  // Larger terrains come from a folder; where it lacks one, a sample stands in.
  const bool there = GetParam().sample || terrain_file(GetParam().name);
  const auto& [name, crs, sample] = there ? GetParam() : Source{"luxembourg", "EPSG:4326", true};
  const auto file = sample ? sample_file(name) : *terrain_file(name);
  const Dem dem(file);
  const RawAnswer answer = served_->upload("?id=dem&crs=" + crs, file);
  ASSERT_EQ(answer.status, 201) << answer.body;
  const Json before = Json::parse(answer.body);
  for (const int tolerance : {5, 10}) {
    const std::string id = "dem-" + std::to_string(tolerance);
    const Json result = served_->simplify({{"tin", "dem"}, {"tolerance", tolerance}, {"as", id}});
    EXPECT_EQ(result.at("tin"), id);
    EXPECT_EQ(result.at("verticesBefore"), before.at("vertexCount"));
    EXPECT_TRUE(result.at("toleranceMet"));
    EXPECT_LE(result.at("maxError"), tolerance);
    const Json made = served_->get("/tins/" + id);
    EXPECT_EQ(made.at("vertexCount"), result.at("verticesAfter"));
    EXPECT_LT(made.at("vertexCount"), before.at("vertexCount"));
    const Json triangles = served_->get("/tins/" + id + "/export?f=geojson&crs=" + crs);
    // Those over voids are left out, and yet every valid sample is covered.
    EXPECT_LE(triangles.at("features").size(), made.at("triangleCount"));
    const Misses misses = compare(dem, triangles, tolerance);
    EXPECT_EQ(misses.strangers, 0U) << "a vertex is no sample";
    EXPECT_EQ(misses.uncovered, 0U) << "a sample lies outside the hull";
    EXPECT_EQ(misses.beyond, 0U) << name << " to " << tolerance << ": " << misses.largest;
    EXPECT_NEAR(misses.largest, result.at("maxError").get<double>(), 1e-9) << name;
  }
  EXPECT_EQ(served_->get("/tins/dem").at("digest"), before.at("digest")) << "the source has changed";
}

INSTANTIATE_TEST_SUITE_P(Terrains, SimplifyTest,
                         testing::Values(Source{"olinda", "EPSG:32725", true},
                                         Source{"luxembourg", "EPSG:4326", true},
                                         Source{"SainteHelens.dem", "EPSG:26710", false},
                                         Source{"N51E001.hgt", "EPSG:4326", false}),
                         [](const auto& one) { return one.param.name.substr(0, one.param.name.find('.')); });

class SimplifyInPlaceTest : public ServedTest {};

TEST_F(SimplifyInPlaceTest, TheTinItselfGetsARevisionThatKeepsToTheToleranceAndToEarlierSamples) {
  start();
  const Dem dem(sample_file("luxembourg"));
  ASSERT_EQ(served_->upload("?id=dem", dem.file).status, 201);
  const Json result = served_->simplify({{"tin", "dem"}, {"tolerance", 10}});
  EXPECT_EQ(result.at("revision"), 2);
  EXPECT_EQ(served_->get("/tins/dem").at("revision"), 2);
  EXPECT_EQ(compare(dem, served_->get("/tins/dem/export?f=geojson"), 10).beyond, 0U);
}

TEST_F(SimplifyInPlaceTest, ABudgetOfVerticesIsKept) {
  start();
  ASSERT_EQ(served_->upload("?id=dem", sample_file("olinda")).status, 201);
  const Json result = served_->simplify({{"tin", "dem"}, {"maxVertices", 200}, {"as", "small"}});
  EXPECT_LE(result.at("verticesAfter"), 200);
  EXPECT_EQ(served_->get("/tins/small").at("vertexCount"), result.at("verticesAfter"));
}

}  // namespace
}  // namespace tests::e2e
