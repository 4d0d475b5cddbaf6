// Meshes, surfaces and clouds of points as uploads: recognised, placed, and put on the lattice they came
// from.
#include <algorithm>

#include "proto/formats/frame_note.h"
#include "tests/proto/formats/las_file.h"
#include "tests/server/gdal/support.h"

namespace server::gdal::testing {
namespace {

using tests::formats::las_file;
using tests::formats::LasSpec;
using tin::base::Code;

class MeshImportTest : public ScratchTest {
 protected:
  static tin::frame::Frame noted() {
    tin::frame::Frame frame{"EPSG:32632", {500000.5, 30, 30000}, {4100000, 1.0 / 3, 333}, "foot", 0.3048};
    return frame;
  }
  static std::string note() { return "tinsmith-frame " + proto::formats::frame_note(noted()); }
};

TEST_F(MeshImportTest, EachFormatIsKnownByItsContent) {
  const std::string obj = "# hill\nmtllib a.mtl\n\nv 1 2 3\nv 4 5 6\nf 1 2 1\n",
                    two_dm = "MESH2D\nND 1 1 2 3\nND 2 4 5 6\n";
  const std::string ply =
      "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\n"
      "property float z\nend_header\n1 2 3\n4 5 6\n";
  const std::string xml =
      "<?xml version=\"1.0\"?>\n<LandXML><Surfaces><Surface name=\"s\"><Definition><Pnts>"
      "<P id=\"1\">2 1 3</P><P id=\"2\">5 4 6</P></Pnts></Definition></Surface></Surfaces></LandXML>";
  for (const auto& [content, title] : std::vector<std::pair<std::string, std::string>>{
           {obj, "Wavefront OBJ"}, {two_dm, "2DM"}, {ply, "PLY"}, {xml, "LandXML"}}) {
    SCOPED_TRACE(title);
    const Import import = imported(file("upload", content));
    EXPECT_EQ(import.driver, title);
    EXPECT_EQ(import.frame.crs, "");
    ASSERT_EQ(import.placements.size(), 2U);
    EXPECT_EQ(import.placements[1].at, import.frame.to_lattice(4, 5).value());
    EXPECT_EQ(import.placements[1].z, 6);
  }
  ImportOptions options;
  options.crs = "EPSG:32632";
  EXPECT_EQ(imported(file("upload", obj), options).frame.crs, "EPSG:32632");
  options.format = "ply";
  EXPECT_EQ(import_error(file("upload", obj), options).code, Code::kUnsupported);
}

TEST_F(MeshImportTest, ANotedLatticeIsTakenAgain) {
  const std::string points = "v 500000.501 4100000.001001001 7\nv 500030.5 4100000 8\n";
  const auto upload = file("upload", "# " + note() + "\n" + points);
  const Import import = imported(upload);
  EXPECT_EQ(import.frame, noted());
  EXPECT_EQ(import.placements[0].at, (tin::exact::Point{1, 1}));
  EXPECT_EQ(import.placements[1].at, (tin::exact::Point{30000, 0}));
  // XYZ notes it too.
  EXPECT_EQ(imported(file("xyz", "# " + note() + "\n500000.5 4100000 7\n")).frame, noted());
}

TEST_F(MeshImportTest, WhatTheClientSaysGoesBeforeTheNote) {
  const auto upload = file("upload", "# " + note() + "\nv 500000.501 4100000.5 7\nv 500030.5 4100000 8\n");
  ImportOptions options;
  options.crs = "EPSG:25832";
  EXPECT_EQ(imported(upload, options).frame.crs, "EPSG:25832");
  options.crs = "EPSG:32632";
  EXPECT_EQ(imported(upload, options).frame, noted());
  options.resolution_x = options.resolution_y = 0.5;
  EXPECT_EQ(imported(upload, options).frame.x.step(), 0.5);
}

TEST_F(MeshImportTest, ANoteThatDoesNotHoldThePointsIsPassedOver) {
  const Import import =
      imported(file("upload", "# " + note() + "\nv 500000.501 4100000.5 7\nv 9e6 4100000 8\n"));
  EXPECT_NE(import.frame, noted());
  EXPECT_EQ(import_error(file("upload", "# tinsmith-frame {}\nv 1 2 3\n")).code, Code::kMalformed);
  tin::frame::Frame nowhere = noted();
  nowhere.crs = "EPSG:1";
  const std::string lost = "# tinsmith-frame " + proto::formats::frame_note(nowhere) + "\nv 1 2 3\n";
  EXPECT_EQ(import_error(file("upload", lost)).code, Code::kUnsupported);
}

std::string landxml(const std::string& head) {
  return "<LandXML>" + head +
         "<Surfaces><Surface><Definition><Pnts><P id=\"1\">5000000 2000000 3</P><P id=\"2\">5000100 2000100 "
         "4</P>"
         "</Pnts></Definition></Surface></Surfaces></LandXML>";
}

TEST_F(MeshImportTest, LandXmlInFeet) {
  const Import feet =
      imported(file("upload", landxml("<Units><Imperial linearUnit=\"USSurveyFoot\"/></Units>")));
  EXPECT_EQ(feet.frame.vertical_unit, "US survey foot");
  EXPECT_NEAR(feet.frame.vertical_unit_m, 1200.0 / 3937, 1e-12);
  EXPECT_EQ(feet.frame.x.world(feet.placements[0].at.x), 2000000);  // easting second
  // EPSG:2229 (California zone 5) counts in US survey feet, EPSG:32632 in metres.
  const auto with = [](const std::string& code) {
    return landxml("<Units><Imperial linearUnit=\"USSurveyFoot\"/></Units><CoordinateSystem epsgCode=\"" +
                   code + "\"/>");
  };
  EXPECT_EQ(imported(file("upload", with("2229"))).frame.crs, "EPSG:2229");
  const auto problem = import_error(file("upload", with("32632")));
  EXPECT_EQ(problem.code, Code::kInvalidValue);
  EXPECT_NE(problem.message.find("crs"), std::string::npos);
  ImportOptions options;
  options.crs = "EPSG:2229";
  EXPECT_EQ(imported(file("upload", with("32632")), options).frame.crs, "EPSG:2229");
}

TEST_F(MeshImportTest, LasByClassInTheCrsOfItsTags) {
  LasSpec spec{.points = {{0, 0, 100, 2, false}, {500, 500, 200, 5, false}}};
  // Projected, EPSG:32632, heights in feet.
  std::string keys;
  for (const std::uint16_t key : {1, 1, 0, 3, 1024, 0, 1, 1, 3072, 0, 1, 32632, 4099, 0, 1, 9002})
    keys.append({static_cast<char>(key & 0xFF), static_cast<char>(key >> 8)});
  spec.records.push_back({"LASF_Projection", 34735, keys});
  ImportOptions options;
  options.classes = {2};
  const Import import = imported(file("upload", las_file(spec)), options);
  EXPECT_EQ(import.driver, "LAS");
  EXPECT_EQ(import.frame.crs, "EPSG:32632");
  EXPECT_EQ(import.frame.vertical_unit, "foot");
  ASSERT_EQ(import.placements.size(), 1U);
  EXPECT_EQ(import.placements[0].z, 1);
  options.classes = {7};
  EXPECT_EQ(import_error(file("upload", las_file(spec)), options).where, "query:class");
  EXPECT_EQ(import_error(file("upload", "x,y,z\n1,2,3\n"), options).where, "query:class");
}

TEST_F(MeshImportTest, LazIsDeclinedClearly) {
  std::string laz = las_file({.points = {{0, 0, 0, 2, false}}});
  laz[104] = static_cast<char>(laz[104] | 0x80);
  const auto problem = import_error(file("upload", laz), named("cloud.laz"));
  EXPECT_EQ(problem.code, Code::kUnsupported);
  EXPECT_NE(problem.message.find("LAZ"), std::string::npos);
}

class RealMeshTest : public ScratchTest {};

TEST_F(RealMeshTest, TheGroundOfACloudIsTheSameAsItsText) {
  const auto cloud = terrain("autzen_trim.las"), text = terrain("autzen_trim_ground.csv");
  if (!cloud || !text) GTEST_SKIP() << "the real data is not here";
  ImportOptions options;
  const Import all = imported(*cloud, options);
  EXPECT_EQ(all.placements.size(), 110000U);
  EXPECT_NE(all.frame.crs.find("Lambert"), std::string::npos) << all.frame.crs;
  options.classes = {2};
  const Import ground = imported(*cloud, options);
  options = named("autzen_trim_ground.csv");
  options.crs = "EPSG:2994";
  const Import csv = imported(*text, options);
  ASSERT_EQ(ground.placements.size(), csv.placements.size());
  for (std::size_t i = 0; i < csv.placements.size(); ++i) {
    ASSERT_EQ(ground.frame.x.world(ground.placements[i].at.x), csv.frame.x.world(csv.placements[i].at.x));
    ASSERT_EQ(ground.frame.y.world(ground.placements[i].at.y), csv.frame.y.world(csv.placements[i].at.y));
    ASSERT_NEAR(ground.placements[i].z, csv.placements[i].z, 1e-9);
  }
}

TEST_F(RealMeshTest, SurfacesOfOthers) {
  const auto survey = terrain("M3_Terrain_landxml.xml"), design = terrain("subdivision-2.0_landxml.xml");
  if (!survey || !design) GTEST_SKIP() << "the real data is not here";
  const Import finland = imported(*survey);
  EXPECT_EQ(finland.placements.size(), 19872U);
  EXPECT_EQ(finland.frame.crs, "EPSG:3875");
  EXPECT_EQ(finland.frame.x.world(finland.placements[0].at.x), 21531281.582);
  EXPECT_EQ(finland.frame.y.world(finland.placements[0].at.y), 6783186.168);
  EXPECT_EQ(finland.placements[0].z, 20.507);
  const Import first = imported(*design);
  EXPECT_EQ(first.frame.vertical_unit, "foot");
  EXPECT_EQ(first.placements[0].z, 1283.236266);
  ImportOptions options;
  options.layer = "EG";
  const Import existing = imported(*design, options);
  EXPECT_EQ(first.placements.size() + existing.placements.size(), 3429U);
}

}  // namespace
}  // namespace server::gdal::testing
