#include "proto/formats/point_text.h"

#include "proto/formats/frame_note.h"
#include "proto/formats/text_internal.h"
#include "proto/numbers.h"

namespace proto::formats {
namespace {

void append_position(std::string& out, const Position& at, char separator) {
  append_shortest(out, at.x);
  out += separator;
  append_shortest(out, at.y);
  out += separator;
  append_shortest(out, at.z);
  out += '\n';
}

}  // namespace

void CsvFormat::begin(std::string& out, const MeshHead& head) {
  out += head.crs == "EPSG:4326" ? "id,lon,lat,z\n" : "id,x,y,z\n";
}

void CsvFormat::vertex(std::string& out, const MeshVertex& vertex) {
  append_integer(out, vertex.id.value());
  out += ',';
  append_position(out, vertex.at, ',');
}

void XyzFormat::begin(std::string& out, const MeshHead& head) {
  if (!head.title.empty()) out += "# title " + one_line(head.title) + "\n";
  if (!head.crs.empty()) out += "# crs " + one_line(head.crs) + "\n";
  if (head.frame) out += "# " + std::string(kFrameNoteName) + " " + frame_note(*head.frame) + "\n";
}

void XyzFormat::vertex(std::string& out, const MeshVertex& vertex) {
  append_position(out, vertex.at, ' ');
}

}  // namespace proto::formats
