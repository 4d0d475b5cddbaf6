#include "proto/formats/sms_2dm.h"

#include "proto/formats/frame_note.h"
#include "proto/formats/text_internal.h"
#include "proto/numbers.h"

namespace proto::formats {

using tin::base::Code;
using tin::base::Result;

namespace {

/// The name stands between double quotes, which have no escape.
std::string unquoted(std::string_view title) {
  std::string name = one_line(title);
  for (char& c : name) {
    if (c == '"') c = '\'';
  }
  return name;
}

}  // namespace

void Sms2dmFormat::begin(std::string& out, const MeshHead& head) {
  vertices_ = triangles_ = 0;
  out += "MESH2D\n";
  if (!head.title.empty()) out += "MESHNAME \"" + unquoted(head.title) + "\"\n";
  if (!head.crs.empty()) out += "# crs " + one_line(head.crs) + "\n";
  if (head.frame) out += "# " + std::string(kFrameNoteName) + " " + frame_note(*head.frame) + "\n";
}

void Sms2dmFormat::vertex(std::string& out, const MeshVertex& vertex) {
  out += "ND ";
  append_integer(out, ++vertices_);
  for (const double value : {vertex.at.x, vertex.at.y, vertex.at.z}) {
    out += ' ';
    append_shortest(out, value);
  }
  out += '\n';
}

void Sms2dmFormat::triangle(std::string& out, const MeshTriangle& triangle) {
  out += "E3T ";
  append_integer(out, ++triangles_);
  for (const std::uint32_t corner : triangle.corners) {
    out += ' ';
    append_integer(out, std::uint64_t{corner} + 1);
  }
  out += " 1\n";
}

Result<MeshPoints> read_2dm(ByteReader& bytes, const ReadLimits& limits) {
  MeshPoints mesh;
  LineReader lines(bytes);
  Checkpoint checkpoint(limits);
  const auto first = lines.next();
  if (!first || !first->starts_with("MESH2D"))
    return at_line(Code::kMalformed, "a 2DM file begins with MESH2D", 1);
  while (const auto line = lines.next()) {
    if (auto going = checkpoint.pass(lines.bytes_read()); !going) return going.error();
    Words words(*line);
    const std::string_view card = words.next();
    if (card == "ND") {
      if (!to_integer(words.next())) return at_line(Code::kMalformed, "a node has a number", lines.number());
      const auto at = read_position(words);
      if (!at) return at_line(at.error().code, at.error().message, lines.number());
      if (auto added = add_point(mesh, *at, limits); !added) return added.error();
    } else if (card.starts_with('#')) {
      if (auto read = read_comment(mesh, line->substr(line->find('#') + 1)); !read) return read.error();
    }
  }
  if (lines.failed()) return at_line(Code::kMalformed, "it is too long", lines.number() + 1);
  return mesh;
}

}  // namespace proto::formats
