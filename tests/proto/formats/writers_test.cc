#include <nlohmann/json.hpp>

#include "tests/proto/formats/parsed.h"
#include "tests/proto/formats/support.h"

namespace tests::formats {
namespace {

constexpr std::size_t kVertices = 3000;  // several pieces of every format

TEST(ObjTest, HoldsEveryVertexAndTriangleExactly) {
  const Terrain terrain = random_terrain(kVertices);
  expect_mesh_of(parse_obj(written(terrain, "obj")), terrain);
}

TEST(ObjTest, TwoTrianglesAsTheyMustBe) {
  const Terrain terrain = drawn_terrain({"12", "34"});
  EXPECT_EQ(
      written(terrain, "obj", {.title = "two\ntriangles"}),
      "# Tinsmith: z is up\n# title two triangles\n# crs EPSG:32632\n# vertical unit foot\n"
      R"(# tinsmith-frame {"crs":"EPSG:32632","x":{"origin":500000.125,"unit":1,"parts":1000},)"
      R"("y":{"origin":4100000.1,"unit":0.3,"parts":300},"verticalUnit":{"name":"foot","metres":0.3048}})"
      "\nv 500000.125 4100000.1 1\nv 500010.125 4100000.1 2\nv 500000.125 4099990.1 3\n"
      "v 500010.125 4099990.1 4\nf 1 3 4\nf 1 4 2\n");
}

TEST(PlyTest, HoldsEveryVertexAndTriangleExactlyInBothEncodings) {
  const Terrain terrain = random_terrain(kVertices);
  for (const char* format : {"ply", "ply-ascii"}) {
    SCOPED_TRACE(format);
    expect_mesh_of(parse_ply(written(terrain, format, {.title = "end_header\nelement vertex 7"})), terrain);
  }
}

TEST(Sms2dmTest, HoldsEveryVertexAndTriangleExactly) {
  const Terrain terrain = random_terrain(kVertices);
  const std::string text = written(terrain, "2dm", {.title = "a \"name\""});
  expect_mesh_of(parse_2dm(text), terrain);
  EXPECT_NE(text.find("MESHNAME \"a 'name'\"\n"), std::string::npos);
}

TEST(LandXmlTest, HoldsEveryVertexAndTriangleExactlyNorthingFirst) {
  const Terrain terrain = random_terrain(kVertices);
  const std::string text = written(terrain, "landxml", {.title = "<&\">"});
  expect_mesh_of(parse_landxml(text), terrain);
  EXPECT_NE(text.find("<Surface name=\"&lt;&amp;&quot;&gt;\">"), std::string::npos);
  EXPECT_NE(text.find("linearUnit=\"meter\""), std::string::npos);
  EXPECT_NE(text.find("elevationUnit=\"feet\""), std::string::npos);
  EXPECT_NE(text.find("epsgCode=\"32632\""), std::string::npos);
}

TEST(LandXmlTest, FeetAreSaid) {
  tin::frame::Frame frame = projected_frame();
  frame.vertical_unit_m = 1200.0 / 3937;
  const std::string text = written(random_terrain(10, frame), "landxml", {.unit_m = 1200.0 / 3937});
  EXPECT_NE(text.find("<Imperial"), std::string::npos);
  EXPECT_NE(text.find("linearUnit=\"USSurveyFoot\""), std::string::npos);
  EXPECT_EQ(text.find("elevationUnit"), std::string::npos);
}

TEST(LandXmlTest, HasNoDegreesAndNoUnitsOfItsOwn) {
  const Terrain terrain = random_terrain(10);
  const auto mesh = proto::formats::TerrainMesh::create(terrain, {.geographic = true});
  const auto format = proto::formats::find_mesh_format("landxml")->make();
  EXPECT_EQ(format->check((*mesh)->head()).error().where, "query:crs");
  const auto fathoms = proto::formats::TerrainMesh::create(terrain, {.unit_m = 1.8288});
  EXPECT_EQ(format->check((*fathoms)->head()).error().where, "query:crs");
}

TEST(CityJsonTest, HoldsEveryVertexOnTheLatticeAndEveryTriangle) {
  const Terrain terrain = random_terrain(kVertices);
  const std::string text = written(terrain, "cityjson");
  // Sums of the reader's own: a step of the lattice is a thousandth.
  expect_mesh_of(parse_cityjson(text), terrain, 1e-8, 0.0005 + 1e-9);
  const auto city = nlohmann::json::parse(text);
  EXPECT_EQ(city.at("metadata").at("referenceSystem"), "https://www.opengis.net/def/crs/EPSG/0/32632");
  const Terrain drawn = drawn_terrain({"12", "34"});
  const auto small = nlohmann::json::parse(written(drawn, "cityjson"));
  EXPECT_EQ(small.at("vertices"),
            nlohmann::json::parse("[[0,0,1000],[10000,0,2000],[0,-10000,3000],[10000,-10000,4000]]"));
}

TEST(CityJsonTest, HeightsThatAreNoTerrainsStayWholeNumbers) {
  Terrain terrain = drawn_terrain({"12", "34"});
  const auto applied = terrain.apply(
      std::vector<tin::terrain::Edit>{tin::terrain::SetZ{terrain.vertices_by_id()[0].id, -1e30}},
      tin::terrain::Duplicates::kReject);
  ASSERT_TRUE(applied.ok());
  const ParsedMesh parsed = parse_cityjson(written(terrain, "cityjson"));
  EXPECT_NEAR(parsed.vertices[0][2] / -1e30, 1, 1e-12);
}

TEST(PointTextTest, CsvAndXyzHoldEveryVertexExactly) {
  const Terrain terrain = drawn_terrain({"1.", "34"});
  EXPECT_EQ(written(terrain, "csv"),
            "id,x,y,z\n1,500000.125,4100000.1,1\n2,500000.125,4099990.1,3\n3,500010.125,4099990.1,4\n");
  const std::string xyz = written(terrain, "xyz", {.title = "t"});
  EXPECT_TRUE(xyz.starts_with("# title t\n# crs EPSG:32632\n# tinsmith-frame {"));
  EXPECT_TRUE(xyz.ends_with("}}\n500000.125 4100000.1 1\n500000.125 4099990.1 3\n500010.125 4099990.1 4\n"));
  tin::frame::Frame degrees;
  degrees.crs = "EPSG:4326";
  EXPECT_TRUE(written(random_terrain(4, degrees), "csv").starts_with("id,lon,lat,z\n"));
}

/// A format gives the same bytes each time, and again after a rewind.
TEST(MeshFormatsTest, EqualTerrainsGiveEqualBytes) {
  const Terrain terrain = random_terrain(500), copy = terrain;
  for (const auto& format : proto::formats::mesh_formats()) {
    SCOPED_TRACE(format.name);
    const std::string first = written(terrain, format.name);
    EXPECT_EQ(written(copy, format.name), first);
    auto mesh = proto::formats::TerrainMesh::create(terrain, {});
    const auto once = format.make(), twice = format.make();
    for (auto* made : {once.get(), twice.get()}) {
      std::string whole, piece;
      proto::formats::MeshStream stream(**mesh, *made);
      while (stream.next(piece)) whole += piece;
      EXPECT_EQ(whole, first);
    }
  }
}

TEST(MeshFormatsTest, OneVertexIsAFileInEveryFormat) {
  const Terrain terrain = random_terrain(1);
  for (const auto& format : proto::formats::mesh_formats())
    EXPECT_FALSE(written(terrain, format.name).empty());
  EXPECT_EQ(parse_obj(written(terrain, "obj")).vertices.size(), 1U);
}

TEST(MeshFormatsTest, AnErrorOfTheSinkEndsTheWriting) {
  const Terrain terrain = random_terrain(5000);
  auto mesh = proto::formats::TerrainMesh::create(terrain, {});
  const auto format = proto::formats::find_mesh_format("obj")->make();
  int pieces = 0;
  const auto done = proto::formats::write_mesh(**mesh, *format, [&pieces](std::string_view) {
    ++pieces;
    return tin::base::Result<void>(tin::base::error(tin::base::Code::kStorage, "full"));
  });
  EXPECT_EQ(done.error().message, "full");
  EXPECT_EQ(pieces, 1);
}

}  // namespace
}  // namespace tests::formats
