// Files that mean ill, or were cut off: each is refused with a reason, and in bounded memory.
#include <random>

#include "proto/formats/landxml.h"
#include "proto/formats/obj.h"
#include "proto/formats/ply.h"
#include "proto/formats/sms_2dm.h"
#include "tests/proto/formats/support.h"

namespace tests::formats {
namespace {

using namespace proto::formats;
using tin::base::Code;
using tin::base::Error;
using tin::base::Result;

using Read = Result<MeshPoints> (*)(ByteReader&, const ReadLimits&);

Result<MeshPoints> read_any_landxml(ByteReader& bytes, const ReadLimits& limits) {
  return read_landxml(bytes, "", limits);
}

Error refused(Read read, const std::string& bytes, const ReadLimits& limits = {}) {
  MemoryReader reader(bytes);
  auto points = read(reader, limits);
  if (!points) return points.error();
  ADD_FAILURE() << "read " << points->points.size() << " points of " << bytes.substr(0, 200);
  return {};
}

TEST(HostileObjTest, IsRefusedWithTheLine) {
  EXPECT_EQ(refused(read_obj, "v 1 2 3\nv 1 2\n").where, "line 2");
  EXPECT_EQ(refused(read_obj, "v 1 2 x\n").code, Code::kMalformed);
  EXPECT_EQ(refused(read_obj, "v 1 2 nan\n").code, Code::kNotFinite);
  EXPECT_EQ(refused(read_obj, "v 1 inf 2\n").code, Code::kNotFinite);
  EXPECT_EQ(refused(read_obj, "v 1 1e999 2\n").code, Code::kMalformed);
  EXPECT_EQ(refused(read_obj, "v 1 2 3\nf 1 2 3\n").code, Code::kMalformed);
  EXPECT_EQ(refused(read_obj, "v 1 2 3\nf 1 1\n").where, "line 2");
  EXPECT_EQ(refused(read_obj, "v 1 2 3\nf 1 0 1\n").code, Code::kMalformed);
  EXPECT_EQ(refused(read_obj, "v 1 2 3\nf -1 -2 -1\n").code, Code::kMalformed);
  EXPECT_EQ(refused(read_obj, "v 1 2 3\nf 1 1 -9223372036854775808\n").code, Code::kMalformed);
  EXPECT_EQ(refused(read_obj, "v 1 2 3\nf 1 1 99999999999999999999\n").code, Code::kMalformed);
  EXPECT_EQ(refused(read_obj, "# tinsmith-frame {\"crs\":\n").code, Code::kMalformed);
  EXPECT_EQ(refused(read_obj, "# tinsmith-frame {" + std::string(100000, '[') + "\n").code, Code::kMalformed);
  EXPECT_EQ(refused(read_obj, std::string(LineReader::kLongestLine + 1, 'v')).code, Code::kMalformed);
}

TEST(HostilePlyTest, AHeaderIsReadWithSuspicion) {
  const std::string begin = "ply\nformat ascii 1.0\n",
                    axes = "property float x\nproperty float y\nproperty float z\n";
  EXPECT_EQ(refused(read_ply, "plyx\n").code, Code::kMalformed);
  EXPECT_EQ(refused(read_ply, "ply\nformat ascii 2.0\n").code, Code::kUnsupported);
  EXPECT_EQ(refused(read_ply, "ply\nformat utf 1.0\n").code, Code::kUnsupported);
  EXPECT_EQ(refused(read_ply, "ply\nend_header\n").code, Code::kMalformed);
  EXPECT_EQ(refused(read_ply, begin).code, Code::kMalformed);
  EXPECT_EQ(refused(read_ply, begin + "property float x\nend_header\n").where, "line 3");
  EXPECT_EQ(refused(read_ply, begin + "element vertex -1\n").code, Code::kMalformed);
  EXPECT_EQ(refused(read_ply, begin + "element vertex 1e9\n").code, Code::kMalformed);
  EXPECT_EQ(refused(read_ply, begin + "element vertex 1\nproperty list float int x\n").code,
            Code::kMalformed);
  EXPECT_EQ(refused(read_ply, begin + "element vertex 1\nproperty half x\n").code, Code::kMalformed);
  EXPECT_EQ(refused(read_ply, begin + "element face 1\nend_header\n").code, Code::kInvalidValue);
  EXPECT_EQ(refused(read_ply, begin + "element vertex 1\nproperty float x\nend_header\n1\n").code,
            Code::kInvalidValue);
  EXPECT_EQ(refused(read_ply, begin + "element vertex 9223372036854775807\n" + axes + "end_header\n").code,
            Code::kTooLarge);
  EXPECT_EQ(refused(read_ply, begin + "element vertex 2\n" + axes + "end_header\n1 2 3\n").code,
            Code::kMalformed);
  EXPECT_EQ(refused(read_ply, begin + "element vertex 1\n" + axes + "end_header\n1 2 nan\n").code,
            Code::kNotFinite);
  std::string many = begin;
  for (int i = 0; i < 100; ++i) many += "element e" + std::to_string(i) + " 0\n";
  EXPECT_EQ(refused(read_ply, many).code, Code::kTooLarge);
  many = begin + "element vertex 1\n";
  for (int i = 0; i < 300; ++i) many += "property float p" + std::to_string(i) + "\n";
  EXPECT_EQ(refused(read_ply, many).code, Code::kTooLarge);
  many = begin;
  for (int i = 0; i < 10001; ++i) many += "comment\n";
  EXPECT_EQ(refused(read_ply, many).code, Code::kTooLarge);
}

TEST(HostilePlyTest, BinaryCountsAreNotBelieved) {
  const std::string axes = "property float x\nproperty float y\nproperty float z\nend_header\n";
  const std::string begin = "ply\nformat binary_little_endian 1.0\n";
  EXPECT_EQ(refused(read_ply, begin + "element vertex 49000000\n" + axes + "123456789012").code,
            Code::kMalformed);
  // A list of four thousand million items that are not there, and rows that take no byte.
  EXPECT_EQ(refused(read_ply, begin + "element face 1\nproperty list uint double i\nelement vertex 1\n" +
                                  axes + "\xFF\xFF\xFF\xFF")
                .code,
            Code::kMalformed);
  EXPECT_EQ(refused(read_ply, begin + "element face 9000000000000000000\nelement vertex 1\n" + axes).code,
            Code::kMalformed);
  EXPECT_EQ(refused(read_ply,
                    begin + "element face 1\nproperty list char double i\nelement vertex 1\n" + axes + "\xFF")
                .code,
            Code::kMalformed);
}

TEST(Hostile2dmTest, IsRefusedWithTheLine) {
  EXPECT_EQ(refused(read_2dm, "MESH\n").where, "line 1");
  EXPECT_EQ(refused(read_2dm, "").where, "line 1");
  EXPECT_EQ(refused(read_2dm, "MESH2D\nND 1 2 3\n").where, "line 2");
  EXPECT_EQ(refused(read_2dm, "MESH2D\nND a 1 2 3\n").where, "line 2");
  EXPECT_EQ(refused(read_2dm, "MESH2D\nND 1 1 2 inf\n").code, Code::kNotFinite);
}

std::string in_surface(const std::string& inner) {
  return "<LandXML><Surfaces><Surface><Definition surfType=\"TIN\"><Pnts>" + inner +
         "</Pnts></Definition></Surface></Surfaces></LandXML>";
}

TEST(HostileLandXmlTest, EntitiesAndDocumentTypesAreNotRead) {
  const std::string bomb =
      R"(<?xml version="1.0"?><!DOCTYPE lolz [<!ENTITY lol "lol"><!ENTITY lol2 "&lol;&lol;">]>)";
  EXPECT_EQ(refused(read_any_landxml, bomb + in_surface("<P>&lol2;</P>")).code, Code::kUnsupported);
  EXPECT_EQ(refused(read_any_landxml, "<!DOCTYPE x SYSTEM \"file:///etc/passwd\"><LandXML/>").code,
            Code::kUnsupported);
  EXPECT_EQ(refused(read_any_landxml, in_surface("<P>&lol;</P>")).code, Code::kMalformed);
}

TEST(HostileLandXmlTest, DepthAndLengthAreBounded) {
  std::string deep = "<LandXML>";
  for (int i = 0; i < 100; ++i) deep += "<a>";
  EXPECT_EQ(refused(read_any_landxml, deep).code, Code::kTooLarge);
  EXPECT_EQ(refused(read_any_landxml, in_surface("<P>1 2 " + std::string(5000, '3') + "</P>")).code,
            Code::kTooLarge);
  EXPECT_EQ(refused(read_any_landxml, "<LandXML a=\"" + std::string(3 << 20, 'x') + "\"/>").code,
            Code::kTooLarge);
}

TEST(HostileLandXmlTest, WhatIsNoPointIsRefusedWithItsLine) {
  EXPECT_EQ(refused(read_any_landxml, in_surface("\n<P>1 2</P>")).where, "line 2");
  EXPECT_EQ(refused(read_any_landxml, in_surface("<P>1 2 nan</P>")).code, Code::kNotFinite);
  EXPECT_EQ(refused(read_any_landxml, in_surface("<P pntRef=\"a\"/>")).code, Code::kUnsupported);
  EXPECT_EQ(refused(read_any_landxml, "<html/>").code, Code::kMalformed);
  EXPECT_EQ(refused(read_any_landxml, "<LandXML>").code, Code::kMalformed);
  EXPECT_EQ(refused(read_any_landxml, "").code, Code::kMalformed);
  EXPECT_EQ(refused(read_any_landxml, "<?xml version=\"1.0\" encoding=\"klingon\"?><LandXML/>").code,
            Code::kMalformed);
}

TEST(HostileMeshTest, PointsAreCountedAndReadingCanBeEnded) {
  const Terrain terrain = random_terrain(20000);
  const std::vector<std::pair<const char*, Read>> all{{"obj", read_obj},
                                                      {"ply", read_ply},
                                                      {"ply-ascii", read_ply},
                                                      {"2dm", read_2dm},
                                                      {"landxml", read_any_landxml}};
  for (const auto& [format, read] : all) {
    SCOPED_TRACE(format);
    const std::string bytes = written(terrain, format);
    MemoryReader enough(bytes);
    EXPECT_TRUE(read(enough, {.points = terrain.vertex_count(), .check = {}}).ok());
    EXPECT_EQ(refused(read, bytes, {.points = terrain.vertex_count() - 1, .check = {}}).code,
              Code::kTooLarge);
    const auto stop = [](std::uint64_t) { return Result<void>(tin::base::error(Code::kCancelled, "")); };
    EXPECT_EQ(refused(read, bytes, {.points = 1000000, .check = stop}).code, Code::kCancelled);
  }
}

/// Bytes changed at random never do more than fail, and files cut off are never taken as whole.
TEST(HostileMeshTest, DamageIsNeverWorseThanAnError) {
  const Terrain terrain = random_terrain(60);
  std::mt19937 random(7);
  const std::vector<std::pair<const char*, Read>> all{{"obj", read_obj},
                                                      {"ply", read_ply},
                                                      {"ply-ascii", read_ply},
                                                      {"2dm", read_2dm},
                                                      {"landxml", read_any_landxml}};
  for (const auto& [format, read] : all) {
    const std::string whole = written(terrain, format);
    for (int round = 0; round < 400; ++round) {
      std::string bytes = whole;
      for (int i = 0; i < 3; ++i) bytes[random() % bytes.size()] = static_cast<char>(random());
      if (round % 4 == 0) bytes.resize(random() % bytes.size());
      MemoryReader reader(bytes);
      const auto points = read(reader, {.points = 1000, .check = {}});
      EXPECT_TRUE(!points || points->points.size() <= 1000U);
    }
  }
}

}  // namespace
}  // namespace tests::formats
