#include "proto/formats/ply.h"

#include <bit>

#include "proto/formats/frame_note.h"
#include "proto/formats/little_endian.h"
#include "proto/formats/text_internal.h"
#include "proto/numbers.h"

namespace proto::formats {

void PlyFormat::begin(std::string& out, const MeshHead& head) {
  out += "ply\nformat ";
  out += encoding_ == PlyEncoding::kAscii ? "ascii" : "binary_little_endian";
  out += " 1.0\n";
  if (!head.title.empty()) out += "comment title " + one_line(head.title) + "\n";
  if (!head.crs.empty()) out += "comment crs " + one_line(head.crs) + "\n";
  if (!head.vertical_unit.empty()) out += "comment vertical unit " + one_line(head.vertical_unit) + "\n";
  if (head.frame) out += "comment " + std::string(kFrameNoteName) + " " + frame_note(*head.frame) + "\n";
  out += "element vertex ";
  append_integer(out, head.vertices);
  out += "\nproperty double x\nproperty double y\nproperty double z\nelement face ";
  append_integer(out, head.triangles);
  out += "\nproperty list uchar int vertex_indices\nend_header\n";
}

void PlyFormat::vertex(std::string& out, const MeshVertex& vertex) {
  if (encoding_ == PlyEncoding::kBinary) {
    for (const double value : {vertex.at.x, vertex.at.y, vertex.at.z})
      append_little(out, std::bit_cast<std::uint64_t>(value));
    return;
  }
  append_shortest(out, vertex.at.x);
  out += ' ';
  append_shortest(out, vertex.at.y);
  out += ' ';
  append_shortest(out, vertex.at.z);
  out += '\n';
}

void PlyFormat::triangle(std::string& out, const MeshTriangle& triangle) {
  if (encoding_ == PlyEncoding::kBinary) {
    out += '\3';
    for (const std::uint32_t corner : triangle.corners) append_little(out, corner);
    return;
  }
  out += '3';
  for (const std::uint32_t corner : triangle.corners) {
    out += ' ';
    append_integer(out, corner);
  }
  out += '\n';
}

}  // namespace proto::formats
