#include "proto/formats/mesh_formats.h"

#include <algorithm>
#include <array>

#include "proto/formats/cityjson.h"
#include "proto/formats/glb.h"
#include "proto/formats/landxml.h"
#include "proto/formats/obj.h"
#include "proto/formats/ply.h"
#include "proto/formats/point_text.h"
#include "proto/formats/sms_2dm.h"

namespace proto::formats {
namespace {

template <class Format, auto... Arguments>
std::unique_ptr<MeshFormat> make() {
  return std::make_unique<Format>(Arguments...);
}

constexpr std::array kFormats{
    MeshFormatEntry{"obj", "Wavefront OBJ", ".obj", "model/obj", make<ObjFormat>},
    MeshFormatEntry{"ply", "PLY, binary", ".ply", "application/ply", make<PlyFormat, PlyEncoding::kBinary>},
    MeshFormatEntry{"ply-ascii", "PLY, text", ".ply", "application/ply",
                    make<PlyFormat, PlyEncoding::kAscii>},
    MeshFormatEntry{"2dm", "SMS 2DM mesh", ".2dm", "text/plain; charset=utf-8", make<Sms2dmFormat>},
    MeshFormatEntry{"landxml", "LandXML surface", ".xml", "application/xml", make<LandXmlFormat>, false},
    MeshFormatEntry{"glb", "glTF, binary", ".glb", "model/gltf-binary", make<GlbFormat>},
    MeshFormatEntry{"cityjson", "CityJSON TINRelief", ".city.json", "application/city+json",
                    make<CityJsonFormat>},
    MeshFormatEntry{"csv", "CSV of vertices", ".csv", "text/csv; charset=utf-8; header=present",
                    make<CsvFormat>},
    MeshFormatEntry{"xyz", "XYZ text of vertices", ".xyz", "text/plain; charset=utf-8", make<XyzFormat>},
};

}  // namespace

std::span<const MeshFormatEntry> mesh_formats() {
  return kFormats;
}

const MeshFormatEntry* find_mesh_format(std::string_view name) {
  const auto found = std::find_if(kFormats.begin(), kFormats.end(),
                                  [name](const MeshFormatEntry& entry) { return entry.name == name; });
  return found == kFormats.end() ? nullptr : &*found;
}

}  // namespace proto::formats
