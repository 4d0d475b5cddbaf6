#include "proto/formats/glb.h"

#include <cmath>
#include <nlohmann/json.hpp>

#include "tests/proto/formats/parsed.h"
#include "tests/proto/formats/support.h"

namespace tests::formats {
namespace {

nlohmann::json document(const std::string& glb) {
  return nlohmann::json::parse(
      glb.substr(20, static_cast<unsigned char>(glb[12]) + 256U * static_cast<unsigned char>(glb[13])));
}

TEST(GlbTest, HoldsEveryVertexWithinFloat32AndEveryTriangle) {
  tin::frame::Frame metres = projected_frame();
  metres.vertical_unit_m = 1;
  const Terrain terrain = random_terrain(3000, metres);
  // 400 m from the local origin a float32 is exact to 2^-16 m, heights of 1,500 m to 2^-14 m.
  expect_mesh_of(parse_glb(written(terrain, "glb")), terrain, 0x1p-15, 0x1p-13);
}

TEST(GlbTest, TheSceneIsInMetres) {
  const Terrain terrain = random_terrain(100);  // heights in feet
  const ParsedMesh parsed = parse_glb(written(terrain, "glb", {.unit_m = 0.5}));
  const auto vertices = terrain.vertices_by_id();
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    EXPECT_NEAR(parsed.vertices[i][0], 0.5 * terrain.frame().x.world(vertices[i].at.x), 1e-4);
    EXPECT_NEAR(parsed.vertices[i][1], 0.5 * terrain.frame().y.world(vertices[i].at.y), 1e-4);
    EXPECT_NEAR(parsed.vertices[i][2], 0.3048 * vertices[i].z, 1e-4);
  }
}

TEST(GlbTest, DegreesBecomeMetresAroundTheMiddle) {
  tin::frame::Frame frame;
  frame.crs = "EPSG:4326";
  frame.x = {7.0, 1, 100'000'000};
  frame.y = {46.0, 1, 100'000'000};
  const Terrain terrain = random_terrain(500, frame);  // 0.008 degrees across
  const std::string glb = written(terrain, "glb", {.geographic = true});
  const ParsedMesh parsed = parse_glb(glb);
  const auto origin = document(glb).at("nodes").at(0).at("extras").at("origin");
  const auto vertices = terrain.vertices_by_id();
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    // Lengths of a degree at latitude 46 on WGS84, from its series.
    EXPECT_NEAR(parsed.vertices[i][0], (frame.x.world(vertices[i].at.x) - origin[0].get<double>()) * 77465,
                0.05);
    EXPECT_NEAR(parsed.vertices[i][1], (frame.y.world(vertices[i].at.y) - origin[1].get<double>()) * 111151,
                0.05);
  }
  EXPECT_EQ(document(glb).at("nodes").at(0).at("extras").at("crs"), "EPSG:4326");
}

TEST(GlbTest, VerticesOnALineAreDrawnAsPoints) {
  const Terrain terrain = drawn_terrain({"1234"});
  const std::string glb = written(terrain, "glb");
  EXPECT_EQ(parse_glb(glb).vertices.size(), 4U);
  const auto primitive = document(glb).at("meshes").at(0).at("primitives").at(0);
  EXPECT_EQ(primitive.at("mode"), 0);
  EXPECT_FALSE(primitive.contains("indices"));
}

TEST(GlbTest, WhatItsLengthsCannotSayIsRefused) {
  proto::formats::MeshHead head;
  head.vertices = 100'000'000;
  head.triangles = 200'000'000;
  EXPECT_TRUE(proto::formats::GlbFormat().check(head).ok());
  head.triangles = 258'000'000;
  EXPECT_EQ(proto::formats::GlbFormat().check(head).error().code, tin::base::Code::kTooLarge);
}

}  // namespace
}  // namespace tests::formats
