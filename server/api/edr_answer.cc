#include <string_view>

#include "proto/crs_uri.h"
#include "proto/formats/geojson.h"
#include "server/api/edr_internal.h"
#include "server/api/links.h"

namespace server::api::edr {

using proto::Position2;
using proto::SurfaceCoverage;

namespace {

constexpr std::size_t kRowsOfPage = 1000;

/// Calls `f` with each place of a coverage and its elevation.
template <class F>
void for_each_place(const SurfaceCoverage& coverage, const F& f) {
  for (std::size_t i = 0; i < coverage.elevation.size(); ++i) {
    if (!coverage.at.empty()) {
      f(coverage.at[i], i);
      continue;
    }
    const auto columns = static_cast<std::size_t>(coverage.x.count);
    f(Position2{node(coverage.x, static_cast<std::int64_t>(i % columns)),
                node(coverage.y, static_cast<std::int64_t>(i / columns))},
      i);
  }
}

/// The stretches of surface along a line, one after another.
void write_stretches(proto::formats::GeoJsonWriter& writer, const SurfaceCoverage& coverage,
                     const Asked& asked) {
  std::vector<Position2> at;
  std::vector<double> z, distance;
  const auto flush = [&] {
    if (!at.empty()) {
      using Values = std::span<const double>;
      writer.stretch(at, z, asked.parameters.elevation ? Values(z) : Values(),
                     asked.parameters.distance ? Values(distance) : Values());
    }
    at.clear();
    z.clear();
    distance.clear();
  };
  for (std::size_t i = 0; i < coverage.at.size(); ++i) {
    if (!coverage.elevation[i]) {
      flush();
      continue;
    }
    at.push_back(swapped_if(asked.crs.northing_first, coverage.at[i]));
    z.push_back(*coverage.elevation[i]);
    distance.push_back(coverage.distance[i]);
  }
  flush();
}

/// Places that were asked for by name appear without an elevation, too, unless "z" is why they have none;
/// those of grids do not.
std::string geojson(const Coverages& coverages, const Asked& asked, std::vector<proto::Link> links) {
  std::string body;
  proto::formats::GeoJsonWriter writer(body, asked.crs.geographic ? proto::formats::Coordinates::kDegrees
                                                                  : proto::formats::Coordinates::kProjected);
  proto::formats::CollectionHead head;
  head.links = std::move(links);
  if (asked.crs.name != proto::kCrs84) head.crs_urn = proto::crs_urn(asked.crs.name);
  writer.begin(head);
  for (const SurfaceCoverage& coverage : coverages) {
    if (!coverage.distance.empty()) {
      write_stretches(writer, coverage, asked);
      continue;
    }
    const bool named = !coverage.at.empty() && !asked.levels;
    for_each_place(coverage, [&](Position2 at, std::size_t i) {
      if (coverage.elevation[i] || named)
        writer.sample(swapped_if(asked.crs.northing_first, at), coverage.elevation[i]);
    });
  }
  writer.end();
  return body;
}

std::string number_text(double value) {
  return proto::JsonWriter().number(value).take();
}

HtmlPage page(const Coverages& coverages, const Asked& asked, std::string_view query) {
  HtmlPage html{"Surface by " + std::string(query), "", {}, {}, {"x", "y", "elevation"}, {}};
  const bool far = !coverages.empty() && !coverages.front().distance.empty();
  if (far) html.columns.emplace_back("distance (m)");
  if (!asked.version.terrain->frame().vertical_unit.empty())
    html.facts.emplace_back("Unit of elevations", asked.version.terrain->frame().vertical_unit);
  html.facts.emplace_back("CRS", asked.crs.uri);
  for (const SurfaceCoverage& coverage : coverages) {
    for_each_place(coverage, [&](Position2 at, std::size_t i) {
      if (html.rows.size() >= kRowsOfPage) return;
      const auto& z = coverage.elevation[i];
      html.rows.push_back({number_text(at.x), number_text(at.y), z ? number_text(*z) : ""});
      if (far) html.rows.back().push_back(number_text(coverage.distance[i]));
    });
  }
  return html;
}

/// The present request in another format.
std::string href_with_format(const Request& request, std::string_view format) {
  std::string href = request.path + "?";
  for (const auto& [name, value] : request.query) {
    if (name != "f") href.append(name).append("=").append(encoded(value)).append("&");
  }
  return href.append("f=").append(format);
}

std::vector<proto::Link> links_of(const Context& context, const Request& request, Format format) {
  const bool geojson = format == Format::kGeoJson;
  const std::string collection = request.path.substr(0, request.path.rfind('/'));
  std::vector<proto::Link> links{
      {href_with_format(request, proto::kGeoJsonName), geojson ? "self" : "alternate",
       std::string(proto::formats::kGeoJsonMediaType), "As GeoJSON"},
      {href_with_format(request, proto::kCoverageJson), "alternate", std::string(proto::kCovJsonMediaType),
       "As CoverageJSON"},
      {collection, "collection", std::string(kJson), "The collection"}};
  make_absolute(links, base_url(context.config, request));
  return links;
}

}  // namespace

double node(const SurfaceCoverage::Axis& axis, std::int64_t i) {
  if (axis.count == 1 || i == 0) return axis.start;
  if (i == axis.count - 1) return axis.stop;
  return axis.start + (axis.stop - axis.start) * static_cast<double>(i) / static_cast<double>(axis.count - 1);
}

Position2 swapped_if(bool swap, Position2 at) {
  return swap ? Position2{at.y, at.x} : at;
}

Response answer(const Context& context, const app::Tin& tin, const Request& request, const Asked& asked,
                const Coverages& coverages, bool collection) {
  Response response;
  const auto& terrain = *asked.version.terrain;
  std::string tag = entity_tag(tin, asked.version.revision, request);
  const std::string_view query = std::string_view(request.path).substr(request.path.rfind('/') + 1);
  switch (asked.format) {
    case Format::kCoverageJson: {
      const proto::CoverageSetting setting{asked.crs.uri, asked.crs.geographic, asked.crs.northing_first,
                                           terrain.frame().vertical_unit, asked.parameters};
      response.headers = {{"Content-Type", std::string(proto::kCovJsonMediaType)}, {"Vary", "Accept"}};
      response.body = proto::coverage_json(coverages, setting, collection);
      break;
    }
    case Format::kGeoJson:
      response.headers = {{"Content-Type", std::string(proto::formats::kGeoJsonMediaType)},
                          {"Vary", "Accept"}};
      response.body = geojson(coverages, asked, links_of(context, request, asked.format));
      tag.insert(tag.size() - 1, "-geojson");
      break;
    case Format::kPage: {
      HtmlPage html = page(coverages, asked, query);
      html.links = links_of(context, request, asked.format);
      response = negotiated(request, "", kJson, html);
      tag.insert(tag.size() - 1, "-html");
      break;
    }
  }
  response.headers.emplace_back("Content-Crs", "<" + asked.crs.uri + ">");
  response.headers.emplace_back("ETag", std::move(tag));
  return response;
}

}  // namespace server::api::edr
