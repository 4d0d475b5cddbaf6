// The collections of a TIN, their schemas (OGC API Common Part 2, Features Part 1 and Part 5).
#include "server/api/collections.h"

#include <algorithm>

#include "proto/collection_schema.h"
#include "proto/crs_uri.h"
#include "proto/edr.h"
#include "server/api/coverage.h"
#include "server/api/feature_query.h"
#include "server/api/links.h"
#include "server/api/routes.h"

namespace server::api {

using tin::base::Code;
using tin::base::error;

std::optional<std::array<double, 4>> geojson_bbox(const app::Summary& summary) {
  if (!summary.bounds || summary.frame.crs.empty()) return std::nullopt;
  const tin::frame::Frame& frame = summary.frame;
  auto positions = Positions::to_geojson(frame);
  if (!positions) return std::nullopt;
  constexpr int kParts = 16;
  std::vector<double> x, y;
  const auto& [low, high] = *summary.bounds;
  for (int i = 0; i <= kParts; ++i) {
    const double u = static_cast<double>(i) / kParts;
    const double along_x = frame.x.world(low.x + u * (double(high.x) - low.x)),
                 along_y = frame.y.world(low.y + u * (double(high.y) - low.y));
    x.insert(x.end(), {along_x, along_x, frame.x.world(low.x), frame.x.world(high.x)});
    y.insert(y.end(), {frame.y.world(low.y), frame.y.world(high.y), along_y, along_y});
  }
  std::vector<std::uint8_t> ok;
  if (!positions->convert(x, y, ok)) return std::nullopt;
  const auto [min_x, max_x] = std::minmax_element(x.begin(), x.end());
  const auto [min_y, max_y] = std::minmax_element(y.begin(), y.end());
  return std::array<double, 4>{*min_x, *min_y, *max_x, *max_y};
}

proto::CollectionDocument collection_document(const app::Tin& tin, const app::Summary& summary, FeatureKind kind) {
  proto::CollectionDocument document;
  document.id = collection_name(kind);
  switch (kind) {
    case FeatureKind::kVertices:
      document.title = "Vertices";
      document.description = "The vertices of the TIN: 3D points whose ids edits use";
      break;
    case FeatureKind::kTriangles:
      document.title = "Triangles";
      document.description = "The triangles of the TIN: 3D polygons with their three vertex ids";
      break;
    case FeatureKind::kEdges:
      document.title = "Edges";
      document.description = "The edges of the TIN: 3D lines with their two vertex ids";
      break;
  }
  document.bbox = geojson_bbox(summary);
  document.crs = offered_crs(summary.frame);
  document.storage_crs = proto::crs_uri(summary.frame.crs).value_or("");
  const std::string self = "/tins/" + tin.id() + "/collections/" + document.id;
  document.links = {{self, "self", std::string(kJson), ""},
                    {self, "alternate", "text/html", "As a page"},
                    {self + "/items", "items", std::string(proto::formats::kGeoJsonMediaType), document.title},
                    {self + "/items", "items", "text/html", document.title + " as a page"},
                    {self + "/items", "data", std::string(proto::formats::kGeoJsonMediaType), document.title},
                    {self + "/schema", "describedby", std::string(proto::kSchemaMediaType), "Properties"},
                    {self + "/schema", "http://www.opengis.net/def/rel/ogc/1.0/schema",
                     std::string(proto::kSchemaMediaType), "Properties"}};
  document.formats = {std::string(proto::kGeoJsonName)};
  document.queries = {{"items", self + "/items", document.title, document.formats}};
  document.vertical_unit = summary.frame.vertical_unit;
  return document;
}

namespace {

constexpr FeatureKind kKinds[] = {FeatureKind::kVertices, FeatureKind::kTriangles, FeatureKind::kEdges};

std::string numbers_text(const std::array<double, 4>& box) {
  std::string text;
  for (const double bound : box) text += (text.empty() ? "" : ", ") + std::to_string(bound);
  return text;
}

HtmlPage page_of(const proto::CollectionDocument& document) {
  HtmlPage page{document.title, document.description, document.links, {}, {}, {}};
  if (document.bbox) page.facts.emplace_back("Extent (longitude, latitude)", numbers_text(*document.bbox));
  if (!document.storage_crs.empty()) page.facts.emplace_back("Stored in", document.storage_crs);
  return page;
}

Result<Response> collections(Context& context, const Request& request) {
  const auto tin = context.catalogue.find(request.path_parameter("tin"));
  if (!tin) return tin.error();
  const app::Summary summary = (*tin)->summary();
  const std::string base = base_url(context.config, request);
  std::vector<proto::CollectionDocument> documents;
  std::vector<proto::Link> links{{request.path, "self", std::string(kJson), ""},
                                 {request.path, "alternate", "text/html", "As a page"}};
  HtmlPage page{"Collections of " + (*tin)->title(), "", {}, {}, {}, {}};
  for (const FeatureKind kind : kKinds) documents.push_back(collection_document(**tin, summary, kind));
  if (has_surface(summary)) documents.push_back(surface_document(**tin, summary));
  for (proto::CollectionDocument& document : documents) {
    make_absolute(document, base);
    page.links.push_back({request.path + "/" + document.id, "item", "", document.title});
  }
  make_absolute(links, base);
  Response response = negotiated(request, proto::collections_json(documents, links), kJson, page);
  response.headers.emplace_back("ETag", negotiated_tag(**tin, summary.revision, request));
  return response;
}

Result<Response> collection(Context& context, const Request& request) {
  const auto tin = context.catalogue.find(request.path_parameter("tin"));
  if (!tin) return tin.error();
  const auto kind = collection_of(request);
  if (!kind) return kind.error();
  const app::Summary summary = (*tin)->summary();
  auto document = collection_document(**tin, summary, *kind);
  make_absolute(document, base_url(context.config, request));
  Response response = negotiated(request, proto::collection_json(document), kJson, page_of(document));
  response.headers.emplace_back("ETag", negotiated_tag(**tin, summary.revision, request));
  return response;
}

Result<Response> schema(Context& context, const Request& request) {
  const auto tin = context.catalogue.find(request.path_parameter("tin"));
  if (!tin) return tin.error();
  const auto kind = collection_of(request);
  if (!kind) return kind.error();
  const std::string self = base_url(context.config, request) + request.path;
  return Response{200,
                  {{"Content-Type", std::string(proto::kSchemaMediaType)}},
                  proto::collection_schema_json(collection_name(*kind), self)};
}

}  // namespace

void add_collections(http::Router& router, Context& context) {
  using http::Method;
  const auto on = [&context](auto f) {
    return guarded([&context, f](Request& request) { return f(context, request); });
  };
  const std::string base = "/tins/{tin}/collections";
  router.add({.method = Method::kGet, .pattern = base, .handler = on(collections)});
  router.add({.method = Method::kGet, .pattern = base + "/{collection}", .handler = on(collection)});
  router.add({.method = Method::kGet, .pattern = base + "/{collection}/schema", .handler = on(schema)});
}

}  // namespace server::api
