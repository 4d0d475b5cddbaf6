#include "proto/formats/landxml.h"

#include <cmath>

#include "proto/formats/frame_note.h"
#include "proto/formats/text_internal.h"
#include "proto/markup.h"
#include "proto/numbers.h"
#include "proto/utf8.h"

namespace proto::formats {

using tin::base::Code;
using tin::base::error;

namespace {

constexpr double kFoot = 0.3048, kSurveyFoot = 1200.0 / 3937;

bool is(double unit, double wanted) {
  return std::abs(unit / wanted - 1) < 1e-9;
}

std::string escaped(std::string_view text) {
  return escaped_markup(one_line(text));
}

/// Units of length by LandXML's names, in its two systems.
struct Units {
  std::string_view system, linear;
};
std::optional<Units> units(double unit_m) {
  if (is(unit_m, 1)) return Units{"Metric", "meter"};
  if (is(unit_m, 1000)) return Units{"Metric", "kilometer"};
  if (is(unit_m, 0.01)) return Units{"Metric", "centimeter"};
  if (is(unit_m, 0.001)) return Units{"Metric", "millimeter"};
  if (is(unit_m, kFoot)) return Units{"Imperial", "foot"};
  if (is(unit_m, kSurveyFoot)) return Units{"Imperial", "USSurveyFoot"};
  return std::nullopt;
}

/// Only where heights are known to have another unit than positions.
std::string elevation_unit(const MeshHead& head) {
  if (head.vertical_unit.empty() || is(head.vertical_unit_m, head.unit_m)) return "";
  if (is(head.vertical_unit_m, 1)) return " elevationUnit=\"meter\"";
  if (is(head.vertical_unit_m, kFoot) || is(head.vertical_unit_m, kSurveyFoot))
    return " elevationUnit=\"feet\"";
  return "";
}

std::string units_element(const MeshHead& head) {
  const Units found = *units(head.unit_m);
  const bool metric = found.system == "Metric";
  std::string out = "<Units><" + std::string(found.system) + " areaUnit=\"";
  out += metric ? "squareMeter" : "squareFoot";
  out += "\" linearUnit=\"" + std::string(found.linear) + "\" volumeUnit=\"";
  out += metric ? "cubicMeter\" temperatureUnit=\"celsius\" pressureUnit=\"milliBars\""
                : "cubicFeet\" temperatureUnit=\"fahrenheit\" pressureUnit=\"inHG\"";
  return out + elevation_unit(head) + "/></Units>\n";
}

std::string coordinate_system(const std::string& crs) {
  if (crs.empty()) return "";
  if (crs.starts_with("EPSG:"))
    return "<CoordinateSystem name=\"" + crs + "\" epsgCode=\"" + crs.substr(5) + "\"/>\n";
  return "<CoordinateSystem ogcWktCode=\"" + escaped(crs) + "\"/>\n";
}

}  // namespace

tin::base::Result<void> LandXmlFormat::check(const MeshHead& head) const {
  if (head.geographic) {
    return error(Code::kInvalidValue,
                 "LandXML has northings and eastings: ask for a projected CRS with the parameter crs.",
                 "query:crs");
  }
  if (!units(head.unit_m))
    return error(Code::kInvalidValue, "LandXML does not know this CRS's unit of length.", "query:crs");
  return {};
}

void LandXmlFormat::begin(std::string& out, const MeshHead& head) {
  vertices_ = 0;
  note_ = head.frame ? frame_note(*head.frame) : "";
  // The schema wants a date; a fixed one, since equal revisions give equal bytes.
  out +=
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
      "<LandXML xmlns=\"http://www.landxml.org/schema/LandXML-1.2\" version=\"1.2\" date=\"1970-01-01\" "
      "time=\"00:00:00\">\n";
  out += units_element(head) + coordinate_system(head.crs);
  out += "<Application name=\"Tinsmith\"/>\n<Surfaces>\n<Surface name=\"" + escaped(head.title) +
         "\">\n<Definition surfType=\"TIN\" elevMax=\"";
  append_shortest(out, head.high.z);
  out += "\" elevMin=\"";
  append_shortest(out, head.low.z);
  out += "\">\n<Pnts>\n";
}

void LandXmlFormat::vertex(std::string& out, const MeshVertex& vertex) {
  out += "<P id=\"";
  append_integer(out, ++vertices_);
  out += "\">";
  append_shortest(out, vertex.at.y);
  out += ' ';
  append_shortest(out, vertex.at.x);
  out += ' ';
  append_shortest(out, vertex.at.z);
  out += "</P>\n";
}

void LandXmlFormat::between(std::string& out) {
  out += "</Pnts>\n<Faces>\n";
}

void LandXmlFormat::triangle(std::string& out, const MeshTriangle& triangle) {
  out += triangle.hidden ? "<F i=\"1\">" : "<F>";
  for (std::size_t i = 0; i < 3; ++i) {
    if (i > 0) out += ' ';
    append_integer(out, std::uint64_t{triangle.corners[i]} + 1);
  }
  out += "</F>\n";
}

void LandXmlFormat::end(std::string& out) {
  out += "</Faces>\n</Definition>\n";
  if (!note_.empty()) {
    out += "<Feature code=\"" + std::string(kFrameNoteName) + "\"><Property label=\"frame\" value=\"" +
           escaped(note_) + "\"/></Feature>\n";
  }
  out += "</Surface>\n</Surfaces>\n</LandXML>\n";
}

}  // namespace proto::formats
