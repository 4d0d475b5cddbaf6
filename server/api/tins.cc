// /tins: list, create, show, delete.
#include <map>
#include <mutex>

#include "proto/bbox.h"
#include "proto/history.h"
#include "server/api/conformance.h"
#include "server/api/export_formats.h"
#include "server/api/links.h"
#include "server/api/routes.h"
#include "server/api/tin_document.h"
#include "server/api/upload.h"
#include "server/app/source.h"
#include "server/app/threads.h"
#include "server/gdal/crs.h"

namespace server::api {

using tin::base::Code;
using tin::base::error;
using tin::frame::Axis;
using tin::frame::Extent;
using tin::frame::Frame;
using tin::terrain::Placement;
using tin::terrain::Terrain;

namespace {

/// Whether positions of a CRS are longitudes and latitudes. PROJ is asked once for each CRS.
bool in_degrees(const std::string& crs) {
  constexpr std::size_t kMostKnown = 1000;
  static std::mutex mutex;
  static std::map<std::string, bool, std::less<>> known;
  if (crs.empty()) return false;
  const std::lock_guard lock(mutex);
  if (const auto found = known.find(crs); found != known.end()) return found->second;
  if (known.size() >= kMostKnown) known.clear();
  const auto info = gdal::read_crs(crs);
  return known[crs] = info && info->scale.geographic;
}

}  // namespace

proto::TinDocument tin_document(const app::Tin& tin) {
  const app::Summary summary = tin.summary();
  proto::TinDocument document;
  document.id = tin.id();
  document.title = tin.title();
  document.revision = summary.revision;
  document.vertex_count = summary.vertex_count;
  document.triangle_count = summary.triangle_count;
  document.digest = summary.digest;
  const Frame& frame = summary.frame;
  document.crs = frame.crs;
  document.resolution = {frame.x.step(), frame.y.step()};
  document.origin = {frame.x.origin, frame.y.origin};
  document.vertical_unit = frame.vertical_unit;
  if (summary.bounds) {
    document.bbox = {frame.x.world(summary.bounds->min.x), frame.y.world(summary.bounds->min.y),
                     frame.x.world(summary.bounds->max.x), frame.y.world(summary.bounds->max.y)};
  }
  if (summary.source) {
    document.source = proto::SourceInfo{summary.source->width, summary.source->height,
                                        summary.source->data_type, summary.source->nodata};
  }
  if (summary.z_range) document.z_range = {summary.z_range->min, summary.z_range->max};
  const std::string self = "/tins/" + tin.id();
  document.links = {{self, "self", std::string(kJson), ""},
                    {self, "alternate", "text/html", "As a page"},
                    {self + "/api", "service-desc", std::string(kOpenApiType), "The contract of this TIN (OpenAPI 3.0)"},
                    {self + "/conformance", "conformance", std::string(kJson), "Conformance classes"},
                    {self + "/collections", "data", std::string(kJson), "Vertices, triangles and edges"}};
  const bool degrees = in_degrees(summary.frame.crs);
  for (const ExportFormat& format : export_formats()) {
    if (degrees && !format.degrees) continue;
    document.links.push_back({self + "/export?f=" + std::string(format.name), "enclosure",
                              std::string(format.media_type), std::string(format.title)});
  }
  return document;
}

Response created_answer(const Context& context, const app::Tin& tin, const Request& request,
                        const proto::FileReport* file) {
  proto::TinDocument document = tin_document(tin);
  make_absolute(document.links, base_url(context.config, request));
  Response response = json_answer(proto::tin_json(document, file), 201);
  response.headers.emplace_back("Location", "/tins/" + tin.id());
  Request self;
  self.path = "/tins/" + tin.id();
  self.id = request.id;
  response.headers.emplace_back("ETag", entity_tag(tin, document.revision, self));
  return response;
}

namespace {

constexpr std::uint64_t kDefaultListed = 100, kMostListed = 1000;

Result<Response> list(Context& context, const Request& request) {
  std::uint64_t limit = kDefaultListed;
  if (const auto text = request.query_value("limit")) {
    const auto parsed = proto::parse_count(*text, 1, kMostListed, "query:limit");
    if (!parsed) return parsed.error();
    limit = *parsed;
  }
  const auto tins = context.catalogue.list();
  proto::TinList answer;
  answer.number_matched = tins.size();
  for (std::size_t i = 0; i < tins.size() && i < limit; ++i) answer.tins.push_back(tin_document(*tins[i]));
  answer.links = {{"/tins", "self", std::string(kJson), ""}};
  HtmlPage page{"Terrains", std::to_string(tins.size()) + " in all", {}, {}, {}, {}};
  for (const auto& tin : answer.tins)
    page.links.push_back({"/tins/" + tin.id, "item", "", tin.title.empty() ? tin.id : tin.title});
  return negotiated(request, proto::tin_list_json(answer), kJson, page);
}

HtmlPage page_of(const proto::TinDocument& document) {
  HtmlPage page{document.title, "A terrain as a triangulated irregular network", document.links, {}, {}, {}};
  page.facts = {{"Vertices", std::to_string(document.vertex_count)},
                {"Triangles", std::to_string(document.triangle_count)},
                {"Revision", std::to_string(document.revision)},
                {"CRS", document.crs.empty() ? "not known" : document.crs},
                {"Unit of elevations", document.vertical_unit.empty() ? "not known" : document.vertical_unit}};
  return page;
}

Result<Response> show(Context& context, const Request& request) {
  const auto tin = context.catalogue.find(request.path_parameter("tin"));
  if (!tin) return tin.error();
  proto::TinDocument document = tin_document(**tin);
  make_absolute(document.links, base_url(context.config, request));
  Response response = negotiated(request, proto::tin_json(document), kJson, page_of(document));
  response.headers.emplace_back("ETag", negotiated_tag(**tin, document.revision, request));
  return response;
}

Result<Response> rename(Context& context, const Request& request) {
  const auto tin = context.catalogue.find(request.path_parameter("tin"));
  if (!tin) return tin.error();
  if (auto json = require_json(request); !json) return json.error();
  const auto title = proto::read_patch_tin(request.body);
  if (!title) return title.error();
  if (auto renamed = (*tin)->rename(*title); !renamed) return renamed.error();
  return show(context, request);
}

Result<Response> remove(Context& context, const Request& request) {
  if (auto removed = context.catalogue.remove(request.path_parameter("tin")); !removed)
    return removed.error();
  return Response{204, {}, std::string()};
}

/// The frame of a TIN made from JSON. `open` is set when it is to be fitted to the first vertices instead.
Result<Frame> frame_of(const proto::CreateTin& message, app::OpenResolution& open) {
  Frame frame;
  tin::frame::GroundScale scale;
  if (message.crs) {
    const auto crs = gdal::read_crs(*message.crs);
    if (!crs) return error(Code::kInvalidValue, crs.error().message, "/crs");
    frame.crs = crs->name;
    scale = crs->scale;
    if (crs->vertical) {
      frame.vertical_unit = crs->vertical->name;
      frame.vertical_unit_m = crs->vertical->metres;
    }
  }
  if (message.vertical_unit) {
    const auto unit = gdal::vertical_unit(*message.vertical_unit);
    if (!unit) return unknown_unit("/verticalUnit");
    frame.vertical_unit = unit->name;
    frame.vertical_unit_m = unit->metres;
  }
  const auto resolution = message.resolution.value_or(std::array<double, 2>{0, 0});
  if (!message.origin && message.vertices.empty()) open = resolution;
  Extent extent{0, 0, 0, 0};
  if (message.origin) {
    extent = {message.origin->x, message.origin->y, message.origin->x, message.origin->y};
  } else if (!message.vertices.empty()) {
    const auto& first = message.vertices.front();
    extent = {first.x, first.y, first.x, first.y};
    for (const proto::Position& v : message.vertices) {
      extent = {std::min(extent.min_x, v.x), std::min(extent.min_y, v.y), std::max(extent.max_x, v.x),
                std::max(extent.max_y, v.y)};
    }
  }
  const auto fitted = tin::frame::fit_points(extent, scale, resolution[0], resolution[1]);
  if (!fitted) return fitted.error();
  frame.x = fitted->x;
  frame.y = fitted->y;
  if (message.origin) {
    frame.x.origin = message.origin->x;
    frame.y.origin = message.origin->y;
  }
  return frame;
}

Result<Response> create_from_json(Context& context, const Request& request) {
  const auto message =
      proto::read_create_tin(request.body, static_cast<std::size_t>(context.config.limits.vertices_per_tin));
  if (!message) return message.error();
  if (auto room = context.catalogue.check_room(message->id); !room) return room.error();
  app::OpenResolution open;
  const auto frame = frame_of(*message, open);
  if (!frame) return frame.error();
  std::vector<Placement> placements;
  placements.reserve(message->vertices.size());
  for (std::size_t i = 0; i < message->vertices.size(); ++i) {
    const auto at = frame->to_lattice(message->vertices[i].x, message->vertices[i].y);
    if (!at) return within("/vertices/" + std::to_string(i), at.error());
    placements.push_back({*at, message->vertices[i].z});
  }
  auto terrain = Terrain::build(*frame, placements, message->duplicates, nullptr, app::engine_threads());
  if (!terrain) return within("/vertices", terrain.error());
  store::Pieces source;
  if (!placements.empty())
    source = app::attach_source(*terrain, app::vertices_as_source(*terrain), app::Completeness::kAllSamples);
  auto made = context.catalogue.create({message->id, message->title.value_or(""), std::move(*terrain),
                                        message->duplicates, open, std::move(source)});
  if (!made) return made.error();
  return created_answer(context, **made, request);
}

Result<Response> create(Context& context, Request& request) {
  if (media_type(request) == kJson) {
    if (!request.query.empty()) {
      return error(Code::kUnknownParameter, "With a JSON body everything stands in the body.",
                   "query:" + request.query.front().first);
    }
    return create_from_json(context, request);
  }
  return create_from_upload(context, request);
}

}  // namespace

void add_tins(http::Router& router, Context& context) {
  using http::Method;
  const auto on = [&context](auto f) {
    return guarded([&context, f](Request& request) { return f(context, request); });
  };
  router.add({.method = Method::kGet, .pattern = "/tins", .query = {"limit"}, .handler = on(list)});
  router.add({.method = Method::kPost,
              .pattern = "/tins",
              .query = {"id", "title", "crs", "resolution", "layer", "z-field", "class", "vertical-unit",
                        "duplicates", "format", "tolerance", "maxVertices", "effort", "elevations", "keepFlat", "against",
                        "maxSeconds", "seed"},
              .body = http::BodyKind::kByType,
              .handler = on(create)});
  router.add({.method = Method::kGet, .pattern = "/tins/{tin}", .handler = on(show)});
  router.add({.method = Method::kPatch,
              .pattern = "/tins/{tin}",
              .body = http::BodyKind::kMemory,
              .handler = on(rename)});
  router.add({.method = Method::kDelete, .pattern = "/tins/{tin}", .handler = on(remove)});
}

}  // namespace server::api
