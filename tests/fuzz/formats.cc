// Files of meshes, surfaces and clouds of points. The first byte chooses the reader.
#include <bit>
#include <cmath>

#include "proto/formats/landxml.h"
#include "proto/formats/las.h"
#include "proto/formats/little_endian.h"
#include "proto/formats/obj.h"
#include "proto/formats/ply.h"
#include "proto/formats/sms_2dm.h"
#include "tests/fuzz/target.h"
#include "tin/base/check.h"

namespace tests::fuzz {
namespace {

using proto::formats::ByteReader;
using proto::formats::MeshPoints;
using proto::formats::ReadLimits;
using tin::base::Result;

constexpr std::uint64_t kMostPoints = 1000;

const std::string kNote =
    R"(tinsmith-frame {"crs":"EPSG:32632","x":{"origin":500000,"unit":1,"parts":1000},"y":{"origin":0,"unit":0.5,"parts":7},)"
    R"("verticalUnit":{"name":"foot","metres":0.3048}})";

/// LAS 1.4 with two points of format 6, and records that tell a CRS before and behind them.
std::string las() {
  using proto::formats::append_little;
  const auto record = [](std::uint16_t id, bool extended) {
    std::string bytes(2, '\0');
    bytes += "LASF_Projection";
    bytes += '\0';
    append_little(bytes, id);
    if (extended) {
      append_little(bytes, std::uint64_t{4});
    } else {
      append_little(bytes, std::uint16_t{4});
    }
    return bytes + std::string(32, '\0') + "abcd";
  };
  std::string records = record(34735, false) + record(34736, false) + record(34737, false);
  std::string out("LASF");
  out += std::string(20, '\0') + "\1\4" + std::string(68, '\0');
  append_little(out, std::uint16_t{375});
  append_little(out, static_cast<std::uint32_t>(375 + records.size()));
  append_little(out, std::uint32_t{3});
  out += '\6';
  append_little(out, std::uint16_t{30});
  out += std::string(131 - out.size(), '\0');
  for (int axis = 0; axis < 3; ++axis) append_little(out, std::bit_cast<std::uint64_t>(0.01));
  out += std::string(235 - out.size(), '\0');
  append_little(out, static_cast<std::uint64_t>(375 + records.size() + 60));
  append_little(out, std::uint32_t{1});
  append_little(out, std::uint64_t{2});
  out += std::string(375 - out.size(), '\0') + records;
  for (int i = 0; i < 2; ++i) out += std::string(15, '\7') + std::string("\0\2", 2) + std::string(13, '\0');
  return out + record(2112, true);
}

Result<MeshPoints> read(char format, ByteReader& bytes, const ReadLimits& limits) {
  switch (static_cast<unsigned char>(format) % 5) {
    case 0:
      return proto::formats::read_obj(bytes, limits);
    case 1:
      return proto::formats::read_ply(bytes, limits);
    case 2:
      return proto::formats::read_2dm(bytes, limits);
    case 3:
      return proto::formats::read_landxml(bytes, "", limits);
    default: {
      auto file = proto::formats::read_las(bytes, proto::formats::LasClasses().set(), limits);
      if (!file) return file.error();
      return std::move(file->mesh);
    }
  }
}

}  // namespace

std::vector<std::string> seeds() {
  std::vector<std::string> out;
  const auto add = [&out](char format, const std::string& content) { out.push_back(format + content); };
  add('\0', "# " + kNote + "\nmtllib a\nv 1 2 3\nv 4 5e0 +6 1\nvn 0 0 1\nv 7 8 9\nf 1//1 2//1 -1\n");
  const std::string axes = "property double x\nproperty float y\nproperty int16 z\n";
  add('\1',
      "ply\nformat ascii 1.0\ncomment " + kNote + "\nelement vertex 2\n" + axes +
          "property list uchar int more\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
          "1 2 3 0\n4 5 6 2 7 8\n3 0 1 0\n");
  for (const char* order : {"little", "big"}) {
    add('\1', "ply\nformat binary_" + std::string(order) +
                  "_endian 1.0\nelement face 1\nproperty list uchar short i\n"
                  "element vertex 2\n" +
                  axes + "end_header\n" + std::string("\1\1\1", 3) + std::string(28, '\1'));
  }
  add('\2', "MESH2D\nMESHNAME \"a\"\n# " + kNote + "\nND 1 1 2 3\nND 2 4.5 5e1 6\nE3T 1 1 2 1 1\n");
  add('\3',
      "<?xml version=\"1.0\"?><LandXML><Units><Imperial linearUnit=\"foot\"/></Units>"
      "<CoordinateSystem epsgCode=\"2229\"/><Surfaces><Surface name=\"s\"><Definition surfType=\"TIN\"><Pnts>"
      "<P id=\"1\">1 2 3</P><P id=\"2\">4 5 6</P><P id=\"3\">7 8 9</P></Pnts><Faces><F i=\"1\">1 2 "
      "3</F></Faces>"
      "</Definition><Feature code=\"tinsmith-frame\"><Property label=\"frame\" "
      "value=\"{}\"/></Feature></Surface>"
      "</Surfaces></LandXML>");
  add('\4', las());
  return out;
}

}  // namespace tests::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace tests::fuzz;
  if (size == 0) return 0;
  proto::formats::MemoryReader reader(text(data + 1, size - 1));
  const auto points = read(static_cast<char>(*data), reader, {.points = kMostPoints, .check = {}});
  if (!points) {
    TIN_CHECK(!points.error().message.empty());
    return 0;
  }
  TIN_CHECK(points->points.size() <= kMostPoints);
  for (const proto::Position& at : points->points)
    TIN_CHECK(std::isfinite(at.x) && std::isfinite(at.y) && std::isfinite(at.z));
  if (points->frame) TIN_CHECK(points->frame->x.unit > 0 && points->frame->x.parts > 0);
  return 0;
}
