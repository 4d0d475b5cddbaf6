#include "proto/formats/obj.h"

#include "proto/formats/frame_note.h"
#include "proto/formats/text_internal.h"
#include "proto/numbers.h"

namespace proto::formats {

using tin::base::Code;
using tin::base::Error;
using tin::base::Result;

void ObjFormat::begin(std::string& out, const MeshHead& head) {
  out += "# Tinsmith: z is up\n";
  if (!head.title.empty()) out += "# title " + one_line(head.title) + "\n";
  if (!head.crs.empty()) out += "# crs " + one_line(head.crs) + "\n";
  if (!head.vertical_unit.empty()) out += "# vertical unit " + one_line(head.vertical_unit) + "\n";
  if (head.frame) out += "# " + std::string(kFrameNoteName) + " " + frame_note(*head.frame) + "\n";
}

void ObjFormat::vertex(std::string& out, const MeshVertex& vertex) {
  out += "v ";
  append_shortest(out, vertex.at.x);
  out += ' ';
  append_shortest(out, vertex.at.y);
  out += ' ';
  append_shortest(out, vertex.at.z);
  out += '\n';
}

void ObjFormat::triangle(std::string& out, const MeshTriangle& triangle) {
  out += 'f';
  for (const std::uint32_t corner : triangle.corners) {
    out += ' ';
    append_integer(out, std::uint64_t{corner} + 1);
  }
  out += '\n';
}

namespace {

/// "7", "7/1", "7//3" or "-1", which counts from the last vertex so far. Numbers of vertices that come later
/// are allowed until the end of the file: `highest` keeps them.
std::optional<Error> check_face(Words& words, std::size_t vertices, std::int64_t& highest,
                                std::uint64_t line) {
  int corners = 0;
  for (std::string_view word = words.next(); !word.empty(); word = words.next(), ++corners) {
    const auto number = to_integer(word.substr(0, word.find('/')));
    if (!number || *number == 0)
      return at_line(Code::kMalformed, "a corner of a face is no number of a vertex", line);
    if (*number < 0 && static_cast<std::uint64_t>(-(*number + 1)) >= vertices)
      return at_line(Code::kMalformed, "a face counts back beyond the first vertex", line);
    highest = std::max(highest, *number);
  }
  if (corners < 3) return at_line(Code::kMalformed, "a face needs three corners", line);
  return std::nullopt;
}

}  // namespace

Result<MeshPoints> read_obj(ByteReader& bytes, const ReadLimits& limits) {
  MeshPoints mesh;
  LineReader lines(bytes);
  Checkpoint checkpoint(limits);
  std::int64_t highest = 0;
  while (const auto line = lines.next()) {
    if (auto going = checkpoint.pass(lines.bytes_read()); !going) return going.error();
    Words words(*line);
    const std::string_view keyword = words.next();
    if (keyword == "v") {
      const auto at = read_position(words);
      if (!at) return at_line(at.error().code, at.error().message, lines.number());
      if (auto added = add_point(mesh, *at, limits); !added) return added.error();
    } else if (keyword == "f") {
      if (auto bad = check_face(words, mesh.points.size(), highest, lines.number())) return *std::move(bad);
    } else if (keyword.starts_with('#')) {
      const std::size_t mark = line->find('#');
      if (auto read = read_comment(mesh, line->substr(mark + 1)); !read) return read.error();
    }
  }
  if (lines.failed()) return at_line(Code::kMalformed, "it is too long", lines.number() + 1);
  if (static_cast<std::uint64_t>(highest) > mesh.points.size()) {
    return tin::base::error(Code::kMalformed,
                            "A face names vertex " + std::to_string(highest) + ", which is not there");
  }
  return mesh;
}

}  // namespace proto::formats
