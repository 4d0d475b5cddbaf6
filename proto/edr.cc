#include "proto/edr.h"

#include <algorithm>
#include <cmath>

#include "proto/bbox.h"

namespace proto {

using tin::base::Code;
using tin::base::error;
using tin::base::Result;

namespace {

constexpr std::size_t kMostLevels = 10'000;

/// A unit of a coverage's values; nothing is written for one that is not known.
void write_unit(JsonWriter& json, std::string_view name) {
  if (name.empty()) return;
  json.key("unit").begin_object();
  json.key("label").begin_object().key("en").string(name).end_object();
  if (const auto symbol = ucum_symbol(name); !symbol.empty()) {
    json.key("symbol").begin_object();
    json.key("value").string(symbol);
    json.key("type").string("http://www.opengis.net/def/uom/UCUM/").end_object();
  }
  json.end_object();
}

void write_observed(JsonWriter& json, std::string_view id, std::string_view label) {
  json.key("observedProperty").begin_object();
  json.key("id").string(id);
  json.key("label").begin_object().key("en").string(label).end_object();
  json.end_object();
}

void write_distance_parameter(JsonWriter& json) {
  json.begin_object().key("type").string("Parameter");
  write_observed(json, "distance", "Distance along the line, on the ground");
  write_unit(json, "metre");
  json.end_object();
}

void write_parameters(JsonWriter& json, const CoverageSetting& setting) {
  json.key("parameters").begin_object();
  if (setting.parameters.elevation) {
    json.key("elevation");
    write_elevation_parameter(json, setting.vertical_unit);
  }
  if (setting.parameters.distance) {
    json.key("distance");
    write_distance_parameter(json);
  }
  json.end_object();
}

void write_referencing(JsonWriter& json, const CoverageSetting& setting) {
  json.key("referencing").begin_array().begin_object();
  json.key("coordinates").begin_array();
  json.string(setting.northing_first ? "y" : "x").string(setting.northing_first ? "x" : "y").end_array();
  json.key("system").begin_object();
  json.key("type").string(setting.geographic ? "GeographicCRS" : "ProjectedCRS");
  json.key("id").string(setting.crs_uri).end_object();
  json.end_object().end_array();
}

void write_axis(JsonWriter& json, std::string_view name, const SurfaceCoverage::Axis& axis) {
  json.key(name).begin_object();
  if (axis.count == 1) {
    json.key("values").begin_array().number(axis.start).end_array();
  } else {
    json.key("start").number(axis.start);
    json.key("stop").number(axis.stop);
    json.key("num").integer(static_cast<std::uint64_t>(axis.count));
  }
  json.end_object();
}

std::string_view domain_type(const SurfaceCoverage& coverage) {
  if (coverage.at.empty()) return "Grid";
  return coverage.single ? "Point" : "MultiPoint";
}

void write_axes(JsonWriter& json, const SurfaceCoverage& coverage) {
  json.key("axes").begin_object();
  if (coverage.at.empty()) {
    write_axis(json, "x", coverage.x);
    write_axis(json, "y", coverage.y);
  } else if (coverage.single) {
    write_axis(json, "x", {coverage.at[0].x, coverage.at[0].x, 1});
    write_axis(json, "y", {coverage.at[0].y, coverage.at[0].y, 1});
  } else {
    json.key("composite").begin_object();
    json.key("dataType").string("tuple");
    json.key("coordinates").begin_array().string("x").string("y").end_array();
    json.key("values").begin_array();
    for (const Position2& p : coverage.at) json.begin_array().number(p.x).number(p.y).end_array();
    json.end_array().end_object();
  }
  json.end_object();
}

/// Values along the axes of a coverage.
template <class F>
void write_range(JsonWriter& json, std::string_view name, const SurfaceCoverage& coverage, const F& values) {
  json.key(name).begin_object();
  json.key("type").string("NdArray");
  json.key("dataType").string("float");
  json.key("axisNames").begin_array();
  if (coverage.at.empty() || coverage.single) {
    json.string("y").string("x").end_array();
    json.key("shape").begin_array();
    json.integer(static_cast<std::uint64_t>(coverage.single ? 1 : coverage.y.count));
    json.integer(static_cast<std::uint64_t>(coverage.single ? 1 : coverage.x.count)).end_array();
  } else {
    json.string("composite").end_array();
    json.key("shape").begin_array().integer(coverage.at.size()).end_array();
  }
  json.key("values").begin_array();
  values();
  json.end_array().end_object();
}

void write_coverage(JsonWriter& json, const SurfaceCoverage& coverage, const CoverageSetting& setting,
                    bool member) {
  json.begin_object().key("type").string("Coverage");
  json.key("domain").begin_object();
  json.key("type").string("Domain");
  json.key("domainType").string(domain_type(coverage));
  write_axes(json, coverage);
  if (!member) write_referencing(json, setting);
  json.end_object();
  if (!member) write_parameters(json, setting);
  json.key("ranges").begin_object();
  if (setting.parameters.elevation) {
    write_range(json, "elevation", coverage, [&] {
      for (const auto& z : coverage.elevation) z ? json.number(*z) : json.null();
    });
  }
  if (setting.parameters.distance) {
    write_range(json, "distance", coverage, [&] {
      for (const double d : coverage.distance) json.number(d);
    });
  }
  json.end_object().end_object();
}

std::vector<std::string_view> split(std::string_view text, char separator) {
  std::vector<std::string_view> parts;
  while (true) {
    const auto end = std::min(text.find(separator), text.size());
    parts.push_back(text.substr(0, end));
    if (end == text.size()) return parts;
    text.remove_prefix(end + 1);
  }
}

Result<std::vector<double>> recurring(std::string_view text, const std::string& where) {
  const auto parts = split(text.substr(1), '/');
  if (parts.size() != 3)
    return error(Code::kMalformed, "Recurring levels are written like R20/100/50.", where);
  const auto count = parse_count(parts[0], 1, kMostLevels, where);
  if (!count) return error(Code::kMalformed, count.error().message, where);
  const auto first = parse_number(parts[1], where), step = parse_number(parts[2], where);
  if (!first) return first.error();
  if (!step) return step.error();
  std::vector<double> values;
  for (std::uint64_t i = 0; i < *count; ++i) values.push_back(*first + static_cast<double>(i) * *step);
  return values;
}

}  // namespace

Result<Levels> Levels::parse(std::string_view text, const std::string& where) {
  Levels levels;
  if (text.starts_with('R')) {
    auto values = recurring(text, where);
    if (!values) return values.error();
    levels.values_ = std::move(*values);
  } else if (const auto slash = text.find('/'); slash != std::string_view::npos) {
    const auto low = parse_number(text.substr(0, slash), where),
               high = parse_number(text.substr(slash + 1), where);
    if (!low) return low.error();
    if (!high) return high.error();
    if (*low > *high) return error(Code::kMalformed, "The lower level comes first.", where);
    return between(*low, *high);
  } else {
    for (const auto part : split(text, ',')) {
      if (levels.values_.size() == kMostLevels) {
        return error(Code::kTooLarge, "There may be " + std::to_string(kMostLevels) + " levels at most.",
                     where);
      }
      const auto value = parse_number(part, where);
      if (!value) return value.error();
      levels.values_.push_back(*value);
    }
  }
  std::sort(levels.values_.begin(), levels.values_.end());
  return levels;
}

Levels Levels::between(double low, double high) {
  Levels levels;
  levels.low_ = low;
  levels.high_ = high;
  return levels;
}

bool Levels::contains(double level) const {
  if (values_.empty()) return low_ <= level && level <= high_;
  return std::binary_search(values_.begin(), values_.end(), level);
}

Result<SurfaceParameters> parse_parameter_names(const std::optional<std::string>& text, bool has_distance,
                                                const std::string& where) {
  if (!text) return SurfaceParameters{true, has_distance};
  SurfaceParameters wanted{false, false};
  for (const auto name : split(*text, ',')) {
    if (name == "elevation") {
      wanted.elevation = true;
    } else if (name == "distance" && has_distance) {
      wanted.distance = true;
    } else {
      return error(Code::kMalformed,
                   has_distance ? "There are the parameters elevation and distance."
                                : "There is one parameter here, elevation.",
                   where);
    }
  }
  return wanted;
}

std::string coverage_json(std::span<const SurfaceCoverage> coverages, const CoverageSetting& setting,
                          bool collection) {
  JsonWriter json;
  if (!collection) {
    write_coverage(json, coverages.front(), setting, false);
    return json.take();
  }
  json.begin_object().key("type").string("CoverageCollection");
  json.key("domainType").string(coverages.empty() ? "MultiPoint" : domain_type(coverages.front()));
  write_parameters(json, setting);
  write_referencing(json, setting);
  json.key("coverages").begin_array();
  for (const SurfaceCoverage& coverage : coverages) write_coverage(json, coverage, setting, true);
  json.end_array().end_object();
  return json.take();
}

void write_elevation_parameter(JsonWriter& json, std::string_view vertical_unit) {
  json.begin_object().key("type").string("Parameter");
  write_observed(json, "http://vocab.nerc.ac.uk/standard_name/surface_altitude/", "Elevation");
  write_unit(json, vertical_unit);
  json.end_object();
}

std::string_view ucum_symbol(std::string_view unit) {
  if (unit == "metre") return "m";
  if (unit == "foot") return "[ft_i]";
  if (unit == "US survey foot") return "[ft_us]";
  return {};
}

}  // namespace proto
