// What is read back, of ours and of others.
#include <bit>
#include <cstring>

#include "proto/formats/frame_note.h"
#include "proto/formats/landxml.h"
#include "proto/formats/obj.h"
#include "proto/formats/ply.h"
#include "proto/formats/sms_2dm.h"
#include "tests/proto/formats/support.h"

namespace tests::formats {
namespace {

using namespace proto::formats;
using proto::Position;
using tin::base::Result;

Result<MeshPoints> read(std::string_view format, const std::string& bytes, const std::string& surface = "") {
  MemoryReader reader(bytes);
  if (format == "obj") return read_obj(reader, {});
  if (format == "2dm") return read_2dm(reader, {});
  if (format == "landxml") return read_landxml(reader, surface, {});
  return read_ply(reader, {});
}

MeshPoints must_read(std::string_view format, const std::string& bytes, const std::string& surface = "") {
  auto points = read(format, bytes, surface);
  if (points) return *std::move(points);
  ADD_FAILURE() << points.error().message;
  return {};
}

class HomecomingTest : public testing::TestWithParam<const char*> {};

TEST_P(HomecomingTest, AFileOfOursComesHomeWithTheSameDigest) {
  for (const Terrain& terrain : {random_terrain(5000), drawn_terrain({"1.345", "6.8.1", "12345"})}) {
    const MeshPoints points = must_read(GetParam(), written(terrain, GetParam()));
    ASSERT_EQ(points.points.size(), terrain.vertex_count());
    EXPECT_EQ(rebuilt(points).digest(), terrain.digest());
    EXPECT_EQ(*points.frame, terrain.frame());
  }
}

TEST_P(HomecomingTest, ACrsWithoutACodeIsKept) {
  tin::frame::Frame frame = projected_frame();
  frame.crs = R"(PROJCRS["odd \ name & <more>",BASEGEOGCRS["x"]])";
  frame.y.unit = 1.0 / 3;
  const Terrain terrain = random_terrain(50, frame);
  EXPECT_EQ(rebuilt(must_read(GetParam(), written(terrain, GetParam()))).digest(), terrain.digest());
}

INSTANTIATE_TEST_SUITE_P(Formats, HomecomingTest,
                         testing::Values("obj", "ply", "ply-ascii", "2dm", "landxml"), [](const auto& one) {
                           std::string name = one.param;
                           std::erase(name, '-');
                           return name;
                         });

TEST(FrameNoteTest, IsReadBackInEveryBit) {
  tin::frame::Frame frame{
      "a \"quoted\" name", {1.0 / 3, 0.1 + 0.2, 7}, {-1e-300, 1e300, 1'000'000'000'000}, "yd", 0.9144};
  EXPECT_EQ(*read_frame_note(frame_note(frame)), frame);
  EXPECT_EQ(find_frame_note("  tinsmith-frame {\"a\":1}"), "{\"a\":1}");
  EXPECT_EQ(find_frame_note("frame {}"), "");
}

TEST(FrameNoteTest, IsFoundInTheBeginningOfAnObject) {
  tin::frame::Frame frame = projected_frame();
  frame.crs = R"(odd } { \ name")";
  const std::string note = frame_note(frame), before = R"({"type":"FeatureCollection","tinsmith-frame":)";
  EXPECT_EQ(find_frame_member(before + note + R"(,"features":[{}]})"), note);
  EXPECT_EQ(find_frame_member(before + note.substr(0, note.size() - 1)), "");
  EXPECT_EQ(find_frame_member(R"({"features":[]})"), "");
  EXPECT_EQ(find_frame_member(R"({"tinsmith-frame":{"a":"\)"), "");
}

TEST(FrameNoteTest, AnAxisThatIsNoneIsRefused) {
  const std::string good = frame_note(projected_frame());
  ASSERT_TRUE(read_frame_note(good).ok());
  for (const auto& [from, to] :
       std::vector<std::pair<std::string, std::string>>{{"\"unit\":1,", "\"unit\":0,"},
                                                        {"\"unit\":1,", "\"unit\":-1,"},
                                                        {"\"unit\":1,", "\"unit\":\"1\","},
                                                        {"\"parts\":1000", "\"parts\":0"},
                                                        {"\"parts\":1000", "\"parts\":1e300"},
                                                        {"\"parts\":1000", "\"parts\":1.5"},
                                                        {"\"origin\":500000.125", "\"origin\":1e999"},
                                                        {"\"metres\":0.3048", "\"metres\":0"},
                                                        {"}", ""}}) {
    std::string bad = good;
    bad.replace(bad.find(from), from.size(), to);
    EXPECT_FALSE(read_frame_note(bad).ok()) << bad;
  }
}

TEST(ObjReadTest, DialectsOfOthers) {
  const MeshPoints points = must_read(
      "obj",
      "mtllib a.mtl\r\no hill\r\nv 1 2 3\r\n v\t4 5e0 +6 1.0\r\nv 7 8 9 0.1 0.2 0.3\r\nvn 0 0 1\r\nvt 0 0\r\n"
      "f 1/1/1 2//1 3\r\nf -1 -2 -3\r\nf 1 2 4\r\nusemtl x\r\nv -1 -2 -3");
  EXPECT_EQ(points.points, (std::vector<Position>{{1, 2, 3}, {4, 5, 6}, {7, 8, 9}, {-1, -2, -3}}));
  EXPECT_FALSE(points.frame);
}

TEST(PlyReadTest, EveryTypeAndOrderOfBytes) {
  const auto big = [](auto value) {
    std::string bytes(sizeof value, '\0');
    std::memcpy(bytes.data(), &value, sizeof value);
    return std::string(bytes.rbegin(), bytes.rend());
  };
  const std::string header =
      "comment made elsewhere\nobj_info x\nelement camera 2\nproperty list uchar short ids\n"
      "property uchar kind\nelement vertex 2\nproperty float32 x\nproperty list uint8 float w\n"
      "property int16 z\nproperty double y\nproperty uchar red\nelement face 1\n"
      "property list uchar uint vertex_index\nend_header\n";
  std::string bytes = "ply\nformat binary_big_endian 1.0\n" + header;
  bytes +=
      big(std::uint8_t{2}) + big(std::int16_t{5}) + big(std::int16_t{6}) + "k" + big(std::uint8_t{0}) + "k";
  bytes += big(1.5F) + big(std::uint8_t{1}) + big(9.0F) + big(std::int16_t{-300}) + big(2.25) + "\xFF";
  bytes += big(-4.0F) + big(std::uint8_t{0}) + big(std::int16_t{7}) + big(1e9) + std::string(1, '\0');
  const std::vector<Position> expected{{1.5, 2.25, -300}, {-4, 1e9, 7}};
  EXPECT_EQ(must_read("ply", bytes).points, expected);
  EXPECT_EQ(must_read("ply", "ply\r\nformat ascii 1.0\n" + header +
                                 "2 5 6 1\n0 1\n\n1.5 1 9 -300 2.25 255\n-4 0 7 1e9 0\n3 0 1 0\n")
                .points,
            expected);
}

TEST(Sms2dmReadTest, CardsOfOthersArePassedOver) {
  const MeshPoints points =
      must_read("2dm",
                "MESH2D\nNUM_MATERIALS_PER_ELEM 1\nE4Q 1 1 2 3 4 1\nND 7 1.0E+00 2.0 3.0\n"
                "ND 3 4 5 6\nNS 1 2 -3\nBEGPARAMDEF\nGM \"Mesh\"\n");
  EXPECT_EQ(points.points, (std::vector<Position>{{1, 2, 3}, {4, 5, 6}}));
}

constexpr const char* kTwoSurfaces = R"(<?xml version="1.0"?>
<lx:LandXML xmlns:lx="http://www.landxml.org/schema/LandXML-2.0" version="2.0">
<lx:Units><lx:Imperial linearUnit="USSurveyFoot" areaUnit="acre"/></lx:Units>
<lx:CoordinateSystem epsgCode="EPSG:2229"/>
<lx:CgPoints><lx:CgPoint name="a">9 9 9</lx:CgPoint></lx:CgPoints>
<lx:Surfaces>
<lx:Surface name="empty"><lx:Definition surfType="TIN"/></lx:Surface>
<lx:Surface name="EG"><lx:SourceData><lx:DataPoints><lx:PntList3D>1 1 1</lx:PntList3D></lx:DataPoints></lx:SourceData>
<lx:Definition surfType="TIN"><lx:Pnts><lx:P id="1">10 1
0</lx:P><lx:P id="2">20 2 0</lx:P><lx:P id="3">30 3 <![CDATA[0]]></lx:P><lx:P id="5">40 4 0</lx:P></lx:Pnts>
<lx:Faces><lx:F n="0">1 2 3</lx:F><lx:F i="1">2 3 5</lx:F></lx:Faces></lx:Definition></lx:Surface>
<lx:Surface name="FG"><lx:Definition surfType="TIN"><lx:Pnts><lx:P id="a">7 8 9</lx:P></lx:Pnts></lx:Definition></lx:Surface>
</lx:Surfaces></lx:LandXML>)";

TEST(LandXmlReadTest, TheFirstSurfaceWithPointsWithoutWhatOnlyInvisibleFacesUse) {
  const MeshPoints points = must_read("landxml", kTwoSurfaces);
  EXPECT_EQ(points.points, (std::vector<Position>{{1, 10, 0}, {2, 20, 0}, {3, 30, 0}}));
  EXPECT_EQ(points.crs, "EPSG:2229");
  EXPECT_EQ(points.horizontal->name, "US survey foot");
  EXPECT_EQ(points.vertical->metres, 1200.0 / 3937);
}

TEST(LandXmlReadTest, ASurfaceByItsName) {
  EXPECT_EQ(must_read("landxml", kTwoSurfaces, "FG").points, (std::vector<Position>{{8, 7, 9}}));
  EXPECT_EQ(read("landxml", kTwoSurfaces, "XG").error().where, "query:layer");
}

TEST(LandXmlReadTest, ElevationsMayHaveAnotherUnitThanPositions) {
  const MeshPoints points = must_read(
      "landxml", "<LandXML><Units><Metric linearUnit=\"meter\" elevationUnit=\"feet\"/></Units></LandXML>");
  EXPECT_EQ(points.horizontal->name, "metre");
  EXPECT_EQ(points.vertical->name, "foot");
}

}  // namespace
}  // namespace tests::formats
