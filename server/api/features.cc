// The items of a TIN's collections, page by page and one by one (OGC API Features, Parts 1 and 2).
#include <algorithm>

#include "server/api/feature_query.h"
#include "server/api/feature_tag.h"
#include "server/api/links.h"
#include "server/api/routes.h"

namespace server::api {

using proto::formats::Coordinates;
using proto::formats::GeoJsonWriter;
using tin::base::Code;
using tin::base::error;
using tin::terrain::Terrain;

namespace {

const std::string kGeoJson(proto::formats::kGeoJsonMediaType);

/// How a request wants its features, in one revision.
struct Wanted {
  FeatureQuery query;
  WireCrs crs;
  std::string bbox_crs;  // as read_crs() takes it
};

Coordinates decimals_of(const WireCrs& crs) {
  return crs.geographic ? Coordinates::kDegrees : Coordinates::kProjected;
}

/// The CRS of the answer has its authority's order of coordinates.
Feature in_wire_order(Feature feature, const WireCrs& crs) {
  if (!crs.northing_first) return feature;
  for (proto::Position& corner : feature.corners) std::swap(corner.x, corner.y);
  return feature;
}

Result<Wanted> read_wanted(const Context& context, const Request& request, const tin::frame::Frame& frame) {
  auto query = read_feature_query(context.config.limits, request);
  if (!query) return query.error();
  auto crs = wire_crs(frame, request.query_value("crs"), "query:crs");
  if (!crs) return crs.error();
  const auto bbox_crs = wire_crs(frame, request.query_value("bbox-crs"), "query:bbox-crs");
  if (!bbox_crs) return bbox_crs.error();
  auto boxes = read_boxes(request, *bbox_crs);
  if (!boxes) return boxes.error();
  query->boxes = std::move(*boxes);
  return Wanted{std::move(*query), std::move(*crs), bbox_crs->name};
}

Result<void> restrict_to_boxes(FeatureReader& reader, const Terrain& terrain, const Wanted& wanted) {
  if (wanted.query.boxes.empty()) return {};
  const std::string& own = terrain.frame().crs;
  auto to_box = Positions::between(own, wanted.bbox_crs, "query:bbox-crs");
  if (!to_box) return to_box.error();
  auto from_box = Positions::between(wanted.bbox_crs, own, "query:bbox-crs");
  if (!from_box) return from_box.error();
  reader.within(wanted.query.boxes, std::move(*to_box), std::move(*from_box));
  return {};
}

/// How many features the whole of the pages has: known from the first page on.
Result<std::uint64_t> count_matched(const Terrain& terrain, const Wanted& wanted) {
  if (wanted.query.boxes.empty()) return feature_count(terrain, wanted.query.kind);
  if (wanted.query.token) return wanted.query.token->matched;
  FeatureReader reader(terrain, wanted.query.kind, {}, Positions(), std::nullopt);
  if (auto restricted = restrict_to_boxes(reader, terrain, wanted); !restricted) return restricted.error();
  std::uint64_t count = 0;
  while (reader.next()) ++count;
  return count;
}

/// The request's own target with another place to go on.
std::string page_href(const Request& request, const Wanted& wanted, const std::optional<PageToken>& token) {
  std::string href = request.path + "?limit=" + std::to_string(wanted.query.limit);
  for (const char* name : {"bbox", "bbox-crs", "crs", "datetime"}) {
    if (const auto value = request.query_value(name)) href.append("&").append(name).append("=").append(encoded(*value));
  }
  if (token) href += "&next=" + write_token(*token);
  return href;
}

struct Page {
  std::string body;
  std::vector<proto::Link> links;
  std::vector<Feature> features;
  bool has_next = false;
};

Result<Page> build_page(const Context& context, const Request& request, const Wanted& wanted, const app::Version& version) {
  const Terrain& terrain = *version.terrain;
  const FeatureQuery& query = wanted.query;
  auto positions = Positions::between(terrain.frame().crs, wanted.crs.name, "query:crs");
  if (!positions) return positions.error();
  const auto matched = count_matched(terrain, wanted);
  if (!matched) return matched.error();
  FeatureReader reader(terrain, query.kind, query.token ? query.token->cursor : FeatureCursor{}, std::move(*positions),
                       std::nullopt);
  if (auto restricted = restrict_to_boxes(reader, terrain, wanted); !restricted) return restricted.error();
  Page page;
  std::optional<Feature> feature = reader.next();
  for (; feature && page.features.size() < query.limit; feature = reader.next()) page.features.push_back(*feature);
  page.has_next = feature.has_value();
  const std::string collection = request.path.substr(0, request.path.rfind('/'));
  page.links = {{page_href(request, wanted, query.token), "self", kGeoJson, ""},
                {page_href(request, wanted, query.token), "alternate", "text/html", "As a page"},
                {collection, "collection", std::string(kJson), "The collection"}};
  if (feature) {
    const PageToken token{version.revision, feature->at, *matched};
    page.links.push_back({page_href(request, wanted, token), "next", kGeoJson, "The next page"});
  }
  make_absolute(page.links, base_url(context.config, request));
  GeoJsonWriter writer(page.body, decimals_of(wanted.crs));
  writer.begin({*matched, page.features.size(), page.links, std::nullopt, std::nullopt});
  for (const Feature& f : page.features) write_feature(writer, query.kind, in_wire_order(f, wanted.crs));
  writer.end();
  return page;
}

std::string id_text(FeatureKind kind, const Feature& feature) {
  if (kind == FeatureKind::kVertices) return std::to_string(feature.ids[0].value());
  if (kind == FeatureKind::kTriangles) return proto::formats::triangle_id(feature.ids);
  return std::to_string(feature.ids[0].value()) + "-" + std::to_string(feature.ids[1].value());
}

HtmlPage html_of(const Page& page, FeatureKind kind) {
  HtmlPage html{std::string(collection_name(kind)), "", page.links, {}, {"id", "coordinates"}, {}};
  for (const Feature& feature : page.features) {
    std::string body;
    GeoJsonWriter writer(body, Coordinates::kDegrees);
    write_feature(writer, kind, feature);
    const auto begin = body.find("\"coordinates\":") + 14, end = body.find("},\"properties\"");
    html.rows.push_back({id_text(kind, feature), body.substr(begin, end - begin)});
  }
  return html;
}

void add_content_crs(Response& response, const WireCrs& crs) {
  if (!crs.uri.empty()) response.headers.emplace_back("Content-Crs", "<" + crs.uri + ">");
}

Result<Response> items(Context& context, const Request& request) {
  const auto tin = context.catalogue.find(request.path_parameter("tin"));
  if (!tin) return tin.error();
  const auto wanted = read_wanted(context, request, (*tin)->summary().frame);
  if (!wanted) return wanted.error();
  const auto& token = wanted->query.token;
  const auto version = token ? (*tin)->page_version(token->revision) : (*tin)->version();
  if (!version) return version.error();
  auto page = build_page(context, request, *wanted, *version);
  if (!page) return page.error();
  if (page->has_next) (*tin)->keep_for_pages(*version);
  const HtmlPage html = wants_html(request) ? html_of(*page, wanted->query.kind) : HtmlPage{};
  Response response = negotiated(request, std::move(page->body), kGeoJson, html);
  add_content_crs(response, wanted->crs);
  response.headers.emplace_back("ETag", negotiated_tag(**tin, version->revision, request));
  return response;
}

Result<Response> item(Context& context, const Request& request) {
  const auto tin = context.catalogue.find(request.path_parameter("tin"));
  if (!tin) return tin.error();
  const auto kind = collection_of(request);
  if (!kind) return kind.error();
  const std::string_view id = request.path_parameter("feature");
  const auto [found, frame] = (*tin)->read([&](const Terrain& terrain, std::uint64_t) {
    return std::pair(find_feature(terrain, *kind, id), terrain.frame());
  });
  const auto crs = wire_crs(frame, request.query_value("crs"), "query:crs");
  if (!crs) return crs.error();
  if (!found) return error(Code::kNotFound, "There is no feature \"" + std::string(id) + "\" in this collection.");
  auto positions = Positions::between(frame.crs, crs->name, "query:crs");
  if (!positions) return positions.error();
  Feature feature = *found;
  for (std::size_t i = 0; i < corner_count(*kind); ++i) {
    const auto at = positions->convert(proto::Position2{feature.corners[i].x, feature.corners[i].y});
    if (!at) return error(Code::kMalformed, "The feature has no place in this CRS.", "query:crs");
    feature.corners[i].x = at->x;
    feature.corners[i].y = at->y;
  }
  std::vector<proto::Link> links{
      {request.path, "self", kGeoJson, ""},
      {request.path, "alternate", "text/html", "As a page"},
      {"/tins/" + (*tin)->id() + "/collections/" + std::string(collection_name(*kind)), "collection", std::string(kJson),
       "The collection"}};
  make_absolute(links, base_url(context.config, request));
  std::string body;
  GeoJsonWriter writer(body, decimals_of(*crs));
  write_feature(writer, *kind, in_wire_order(feature, *crs));
  const Page page{"", links, {feature}, false};
  Response response = negotiated(request, proto::formats::feature_with_links(body, links), kGeoJson, html_of(page, *kind));
  add_content_crs(response, *crs);
  response.headers.emplace_back("ETag", feature_tag(**tin, *found, request));
  return response;
}

}  // namespace

void add_features(http::Router& router, Context& context) {
  using http::Method;
  const auto on = [&context](auto f) {
    return guarded([&context, f](Request& request) { return f(context, request); });
  };
  const std::string pattern = "/tins/{tin}/collections/{collection}/items";
  router.add({.method = Method::kGet,
              .pattern = pattern,
              .query = {"bbox", "bbox-crs", "crs", "datetime", "limit", "next"},
              .handler = on(items)});
  router.add({.method = Method::kGet, .pattern = pattern + "/{feature}", .query = {"crs"}, .handler = on(item)});
}

}  // namespace server::api
