#include "proto/coverage_documents.h"

#include "proto/crs_uri.h"
#include "proto/json_write.h"

namespace proto {
namespace {

void write_axis(JsonWriter& json, std::string_view label, double low, double high, std::int64_t cells) {
  json.begin_object();
  json.key("type").string("RegularAxis");
  json.key("axisLabel").string(label);
  json.key("lowerBound").number(low);
  json.key("upperBound").number(high);
  json.key("resolution").number((high - low) / static_cast<double>(cells));
  json.key("uomLabel").string("degree");
  json.end_object();
}

void write_limits(JsonWriter& json, std::string_view label, std::int64_t cells) {
  json.begin_object();
  json.key("type").string("IndexAxis");
  json.key("axisLabel").string(label);
  json.key("lowerBound").integer(0);
  json.key("upperBound").integer(static_cast<std::uint64_t>(cells - 1));
  json.end_object();
}

}  // namespace

std::string coverage_domain_json(const CoverageGrid& grid) {
  const auto& [west, south, east, north] = grid.bounds;
  JsonWriter json;
  json.begin_object();
  json.key("type").string("DomainSet");
  json.key("generalGrid").begin_object();
  json.key("type").string("GeneralGridCoverage");
  json.key("srsName").string(kCrs84Uri);
  json.key("axisLabels").begin_array().string("Long").string("Lat").end_array();
  json.key("axis").begin_array();
  write_axis(json, "Long", west, east, grid.width);
  write_axis(json, "Lat", south, north, grid.height);
  json.end_array();
  json.key("gridLimits").begin_object();
  json.key("type").string("GridLimits");
  json.key("srsName").string("http://www.opengis.net/def/crs/OGC/0/Index2D");
  json.key("axisLabels").begin_array().string("i").string("j").end_array();
  json.key("axis").begin_array();
  write_limits(json, "i", grid.width);
  write_limits(json, "j", grid.height);
  json.end_array().end_object();
  json.end_object().end_object();
  return json.take();
}

std::string coverage_range_json(const std::string& unit) {
  JsonWriter json;
  json.begin_object();
  json.key("type").string("DataRecord");
  json.key("field").begin_array().begin_object();
  json.key("type").string("Quantity");
  json.key("name").string("elevation");
  json.key("description").string("Elevation of the surface");
  json.key("definition").string("FLOAT32");
  json.key("encodingInfo").begin_object();
  json.key("dataType").string("http://www.opengis.net/def/dataType/OGC/0/float32").end_object();
  if (!unit.empty()) {
    json.key("uom").begin_object().key("type").string("UnitReference").key("code").string(unit).end_object();
  }
  json.end_object().end_array();
  json.end_object();
  return json.take();
}

}  // namespace proto
