// Collections of a TIN and their items, page by page.
#include <algorithm>
#include <charconv>

#include "proto/crs_uri.h"
#include "server/api/answer.h"
#include "server/api/feature_reader.h"
#include "server/api/routes.h"

namespace server::api {

using tin::base::Code;
using tin::base::error;
using tin::terrain::Terrain;

namespace {

constexpr std::size_t kScanUnderLock = 50'000;  // vertices that a box may be searched in while editors wait

/// What a `next` token says: a revision, and where to go on in it.
struct PageToken {
  std::uint64_t revision = 0;
  FeatureCursor cursor;
};

std::string write_token(const PageToken& token) {
  return std::to_string(token.revision) + "." + std::to_string(token.cursor.vertex) + "." +
         std::to_string(token.cursor.done);
}

Result<PageToken> read_token(const std::string& text) {
  PageToken token;
  const char* end = text.data() + text.size();
  const auto revision = std::from_chars(text.data(), end, token.revision);
  if (revision.ec == std::errc{} && revision.ptr != end && *revision.ptr == '.') {
    const auto vertex = std::from_chars(revision.ptr + 1, end, token.cursor.vertex);
    if (vertex.ec == std::errc{} && vertex.ptr != end && *vertex.ptr == '.') {
      const auto done = std::from_chars(vertex.ptr + 1, end, token.cursor.done);
      if (done.ec == std::errc{} && done.ptr == end) return token;
    }
  }
  return error(Code::kMalformed, "This is no token that a page gave.", "query:next");
}

struct PageRequest {
  FeatureKind kind = FeatureKind::kVertices;
  std::string path;  // of the items, for links
  std::string bbox_text;
  std::optional<proto::Bbox> box;
  std::size_t limit = 0;
  std::optional<PageToken> token;
};

struct Page {
  std::uint64_t revision = 0;
  std::string body;
  bool has_next = false;
};

Result<PageRequest> read_page_request(const Context& context, const Request& request) {
  PageRequest page;
  const auto kind = feature_kind(request.path_parameter("collection"));
  if (!kind) return error(Code::kNotFound, "The collections are vertices and triangles.");
  page.kind = *kind;
  page.path = request.path;
  const auto& limits = context.config.limits;
  page.limit = static_cast<std::size_t>(limits.page_size);
  if (const auto text = request.query_value("limit")) {
    const auto limit = proto::parse_count(*text, 1, UINT32_MAX, "query:limit");
    if (!limit) return limit.error();
    page.limit = static_cast<std::size_t>(
        std::min<std::uint64_t>(*limit, static_cast<std::uint64_t>(limits.page_size_max)));
  }
  if (const auto text = request.query_value("bbox")) {
    const auto box = proto::parse_bbox(*text, "query:bbox");
    if (!box) return box.error();
    page.box = *box;
    page.bbox_text = *text;
  }
  if (const auto text = request.query_value("next")) {
    const auto token = read_token(*text);
    if (!token) return token.error();
    page.token = *token;
  }
  return page;
}

std::string page_href(const PageRequest& page, const std::optional<PageToken>& token) {
  std::string href = page.path + "?limit=" + std::to_string(page.limit);
  if (!page.bbox_text.empty()) href += "&bbox=";
  for (const char c : page.bbox_text)
    href += c == '+' ? "%2B" : std::string(1, c);  // "1e+5": a bare plus would be a space
  if (token) href += "&next=" + write_token(*token);
  return href;
}

Result<Page> build_page(const PageRequest& request, const Terrain& terrain, std::uint64_t revision) {
  auto positions = Positions::to_geojson(terrain.frame());
  if (!positions) return positions.error();
  const FeatureCursor from = request.token ? request.token->cursor : FeatureCursor{};
  FeatureReader reader(terrain, request.kind, from, std::move(*positions), request.box);
  std::vector<Feature> features;
  std::optional<Feature> feature = reader.next();
  for (; feature && features.size() < request.limit; feature = reader.next()) features.push_back(*feature);
  proto::formats::CollectionHead head;
  head.number_returned = features.size();
  if (!request.box) {
    head.number_matched =
        request.kind == FeatureKind::kVertices ? terrain.vertex_count() : terrain.triangle_count();
  }
  const std::string type(proto::formats::kGeoJsonMediaType);
  head.links.push_back({page_href(request, request.token), "self", type, ""});
  Page page{revision, {}, feature.has_value()};
  if (feature) head.links.push_back({page_href(request, PageToken{revision, feature->at}), "next", type, ""});
  proto::formats::GeoJsonWriter writer(page.body, geojson_in_degrees(terrain.frame())
                                                      ? proto::formats::Coordinates::kDegrees
                                                      : proto::formats::Coordinates::kProjected);
  writer.begin(head);
  for (const Feature& f : features) write_feature(writer, request.kind, f);
  writer.end();
  return page;
}

/// The page from the present revision under the lock if that is quick, else from a version.
Result<Page> make_page(const app::Tin& tin, const PageRequest& request) {
  const auto quick =
      tin.read([&](const Terrain& terrain, std::uint64_t revision) -> std::optional<Result<Page>> {
        const bool present = !request.token || request.token->revision == revision;
        if (!present || (request.box && terrain.vertex_count() > kScanUnderLock)) return std::nullopt;
        return build_page(request, terrain, revision);
      });
  if (quick) return *quick;
  if (!request.token) {
    const app::Version version = tin.version();
    return build_page(request, *version.terrain, version.revision);
  }
  const auto version = tin.page_version(request.token->revision);
  if (!version) return version.error();
  return build_page(request, *version->terrain, version->revision);
}

Result<Response> items(Context& context, const Request& request) {
  const auto tin = context.catalogue.find(request.path_parameter("tin"));
  if (!tin) return tin.error();
  const auto asked = read_page_request(context, request);
  if (!asked) return asked.error();
  auto page = make_page(**tin, *asked);
  if (!page) return page.error();
  if (page->has_next) {
    if (auto version = (*tin)->page_version(page->revision)) (*tin)->keep_for_pages(*version);
  }
  Response response{
      200, {{"Content-Type", std::string(proto::formats::kGeoJsonMediaType)}}, std::move(page->body)};
  response.headers.emplace_back("ETag", entity_tag(**tin, page->revision, request));
  return response;
}

/// The extent in CRS84, from the corners and edges of the extent in the TIN's CRS.
std::optional<std::array<double, 4>> geojson_bbox(const app::Tin& tin, const app::Summary& summary) {
  if (!summary.bounds) return std::nullopt;
  const auto frame = tin.read([](const Terrain& terrain, std::uint64_t) { return terrain.frame(); });
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

proto::CollectionDocument collection_document(const app::Tin& tin, const app::Summary& summary,
                                              FeatureKind kind) {
  const bool vertices = kind == FeatureKind::kVertices;
  proto::CollectionDocument document;
  document.id = vertices ? "vertices" : "triangles";
  document.title = vertices ? "Vertices" : "Triangles";
  document.description = vertices ? "The vertices of the TIN: 3D points whose ids edits use"
                                  : "The triangles of the TIN: 3D polygons with their three vertex ids";
  document.bbox = geojson_bbox(tin, summary);
  const std::string crs = tin.read([](const Terrain& terrain, std::uint64_t) { return terrain.frame().crs; });
  if (!crs.empty()) document.crs = {std::string(proto::kCrs84Uri)};
  document.storage_crs = proto::crs_uri(crs).value_or("");
  const std::string self = "/tins/" + tin.id() + "/collections/" + document.id;
  document.links = {
      {self, "self", std::string(kJson), ""},
      {self + "/items", "items", std::string(proto::formats::kGeoJsonMediaType), document.title}};
  return document;
}

Result<Response> collections(Context& context, const Request& request) {
  const auto tin = context.catalogue.find(request.path_parameter("tin"));
  if (!tin) return tin.error();
  const app::Summary summary = (*tin)->summary();
  const std::vector<proto::CollectionDocument> documents{
      collection_document(**tin, summary, FeatureKind::kVertices),
      collection_document(**tin, summary, FeatureKind::kTriangles)};
  const std::vector<proto::Link> links{{request.path, "self", std::string(kJson), ""}};
  Response response = json_answer(proto::collections_json(documents, links));
  response.headers.emplace_back("ETag", entity_tag(**tin, summary.revision, request));
  return response;
}

Result<Response> collection(Context& context, const Request& request) {
  const auto tin = context.catalogue.find(request.path_parameter("tin"));
  if (!tin) return tin.error();
  const auto kind = feature_kind(request.path_parameter("collection"));
  if (!kind) return error(Code::kNotFound, "The collections are vertices and triangles.");
  const app::Summary summary = (*tin)->summary();
  Response response = json_answer(proto::collection_json(collection_document(**tin, summary, *kind)));
  response.headers.emplace_back("ETag", entity_tag(**tin, summary.revision, request));
  return response;
}

}  // namespace

void add_features(http::Router& router, Context& context) {
  using http::Method;
  const auto on = [&context](auto f) {
    return guarded([&context, f](Request& request) { return f(context, request); });
  };
  const std::string base = "/tins/{tin}/collections";
  router.add({.method = Method::kGet, .pattern = base, .handler = on(collections)});
  router.add({.method = Method::kGet, .pattern = base + "/{collection}", .handler = on(collection)});
  router.add({.method = Method::kGet,
              .pattern = base + "/{collection}/items",
              .query = {"bbox", "limit", "next"},
              .handler = on(items)});
}

}  // namespace server::api
