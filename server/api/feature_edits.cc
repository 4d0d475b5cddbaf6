// Creating, replacing, updating and deleting single vertices (OGC API Features Part 4, a draft).
#include <algorithm>

#include "proto/feature_read.h"
#include "proto/history.h"
#include "proto/problems.h"
#include "server/api/edit_place.h"
#include "server/api/feature_query.h"
#include "server/api/feature_tag.h"
#include "server/api/links.h"
#include "server/api/routes.h"
#include "server/obs/metrics.h"

namespace server::api {

using tin::base::Code;
using tin::base::error;
using tin::terrain::Terrain;
using tin::terrain::VertexId;

namespace {

/// How often an edit is tried again when another one came between it and the check of its precondition.
constexpr int kAttempts = 8;

/// The CRS of the body: what Content-Crs says, else CRS84.
Result<WireCrs> body_crs(const Request& request, const tin::frame::Frame& frame) {
  std::string_view field = request.header("content-crs");
  if (field.starts_with('<') && field.ends_with('>')) field = field.substr(1, field.size() - 2);
  return wire_crs(frame, field.empty() ? std::nullopt : std::optional(std::string(field)), "header:Content-Crs");
}

/// Who makes the edit and why: the body is the vertex itself, so the address says it.
Result<proto::Remark> remark_of(const Request& request) {
  return proto::parse_remark(request.query_value("author"), request.query_value("note"));
}

/// A body's position in the TIN's CRS.
Result<proto::Position2> own_position(proto::Position2 at, const WireCrs& crs, const tin::frame::Frame& frame) {
  if (crs.northing_first) std::swap(at.x, at.y);
  auto positions = Positions::between(crs.name, frame.crs, "header:Content-Crs");
  if (!positions) return positions.error();
  const auto own = positions->convert(at);
  if (own) return *own;
  return error(Code::kInvalidValue, "The position cannot be converted to the TIN's CRS.", "/geometry/coordinates");
}

/// Errors of the engine name the edit; clients know the feature's geometry.
tin::base::Error in_geometry(tin::base::Error problem) {
  if (problem.where.starts_with('/')) problem.where = "/geometry";
  return problem;
}

/// The tag of the vertex as the edit left it, whatever became of it since; none when it is gone, or that is
/// not known.
void add_tag(Response& response, const app::Tin& tin, std::uint64_t revision, VertexId id) {
  const auto vertex = tin.vertex_after(revision, id);
  if (vertex)
    response.headers.emplace_back("ETag",
                                  feature_tag(tin, vertex_feature(*vertex, tin.summary().frame), Request{}));
}

Response created(const Context& context, const Request& request, const app::Tin& tin,
                 const app::Edited& edited) {
  Response response{201, {}, std::string()};
  const std::string path = request.path + "/" + std::to_string(edited.ids[0].value());
  response.headers.emplace_back("Location", base_url(context.config, request) + path);
  add_tag(response, tin, edited.revision, edited.ids[0]);
  return response;
}

Response changed(const app::Tin& tin, const app::Edited& edited) {
  Response response{204, {}, std::string()};
  // A patch of nothing that matters has no id to show.
  if (!edited.ids.empty()) add_tag(response, tin, edited.revision, edited.ids[0]);
  return response;
}

Result<app::Edited> carry_out(Context& context, app::Tin& tin, std::span<const app::WorldEdit> edits,
                              const app::Terms& terms) {
  if (auto room = room_for_edit(context, tin, edits); !room) return room.error();
  auto edited = tin.edit(edits, terms);
  if (edited) obs::metrics().edits.fetch_add(edits.size(), std::memory_order_relaxed);
  return edited;
}

Result<Response> create(Context& context, const Request& request) {
  const auto tin = context.catalogue.find(request.path_parameter("tin"));
  if (!tin) return tin.error();
  if (auto json = require_json(request); !json) return json.error();
  const auto place = edit_place(context, request);
  if (!place) return place.error();
  const auto remark = remark_of(request);
  if (!remark) return remark.error();
  const auto body = proto::read_vertex_feature(request.body, proto::FeatureBody::kWhole);
  if (!body) return body.error();
  const auto frame = (*tin)->summary().frame;
  const auto crs = body_crs(request, frame);
  if (!crs) return crs.error();
  const auto at = own_position(*body->at, *crs, frame);
  if (!at) return at.error();
  const app::WorldEdit insert = app::InsertAt{at->x, at->y, *body->z};
  const auto edited = carry_out(context, **tin, {&insert, 1}, place->terms({}, *remark));
  if (!edited) return in_geometry(edited.error());
  return created(context, request, **tin, *edited);
}

/// The edits that bring a vertex into the state that a body asks for.
using EditsOf = std::function<Result<std::vector<app::WorldEdit>>(const app::Tin& tin, VertexId id)>;

/// Checks If-Match against the vertex as it is, and edits that very revision. A key that was used before is
/// asked for after the vertex was looked at: whatever comes to both is there by then, or is met by the edit.
Result<Response> change(Context& context, const Request& request, const EditsOf& edits_of) {
  const auto tin = context.catalogue.find(request.path_parameter("tin"));
  if (!tin) return tin.error();
  const std::string_view id = request.path_parameter("feature");
  const std::string_view if_match = request.header("if-match");
  const auto remark = remark_of(request);
  if (!remark) return remark.error();
  const auto place = edit_place(context, request);
  if (!place) return place.error();
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    const auto [feature, revision] = (*tin)->read([&](const Terrain& terrain, std::uint64_t at) {
      return std::pair(find_feature(terrain, FeatureKind::kVertices, id), at);
    });
    if (place->key) {
      const auto before = (*tin)->answered(*place->key);
      if (!before) return before.error();
      if (*before) return changed(**tin, **before);
    }
    if (!feature) return error(Code::kNotFound, "There is no vertex \"" + std::string(id) + "\".");
    if (if_match.empty()) {
      return status_answer(428, "Say with If-Match which state of the vertex this is for: its ETag, or * for any.");
    }
    if (!matches(if_match, **tin, *feature)) {
      return error(Code::kPrecondition, "The vertex has changed: If-Match names another state of it.", "header:If-Match");
    }
    const auto edits = edits_of(**tin, feature->ids[0]);
    if (!edits) return edits.error();
    const std::uint64_t seen = revision;
    const auto edited = carry_out(context, **tin, *edits, place->terms({&seen, 1}, *remark));
    if (!edited && edited.error().code == Code::kPrecondition) continue;
    if (!edited) return in_geometry(edited.error());
    return changed(**tin, *edited);
  }
  return error(Code::kTooMany, "Other edits came first each time; try again.");
}

Result<Response> change_to_body(Context& context, const Request& request, proto::FeatureBody kind) {
  if (auto json = require_json(request); !json) return json.error();
  const auto body = proto::read_vertex_feature(request.body, kind);
  if (!body) return body.error();
  return change(context, request, [&](const app::Tin& tin, VertexId id) -> Result<std::vector<app::WorldEdit>> {
    std::vector<app::WorldEdit> edits;
    if (body->at) {
      const auto frame = tin.summary().frame;
      const auto crs = body_crs(request, frame);
      if (!crs) return crs.error();
      const auto at = own_position(*body->at, *crs, frame);
      if (!at) return at.error();
      edits.emplace_back(app::MoveTo{id, at->x, at->y});
    }
    if (body->z) edits.emplace_back(tin::terrain::SetZ{id, *body->z});
    return edits;
  });
}

Result<Response> replace(Context& context, const Request& request) {
  return change_to_body(context, request, proto::FeatureBody::kWhole);
}

Result<Response> update(Context& context, const Request& request) {
  return change_to_body(context, request, proto::FeatureBody::kPatch);
}

Result<Response> remove(Context& context, const Request& request) {
  return change(context, request, [](const app::Tin&, VertexId id) -> Result<std::vector<app::WorldEdit>> {
    return std::vector<app::WorldEdit>{tin::terrain::Remove{id}};
  });
}

}  // namespace

void add_feature_edits(http::Router& router, Context& context) {
  using http::BodyKind;
  using http::Method;
  const auto on = [&context](auto f) {
    return guarded([&context, f](Request& request) { return f(context, request); });
  };
  const std::string items = "/tins/{tin}/collections/vertices/items", item = items + "/{feature}";
  const std::vector<std::string> query{"author", "note"};
  const auto with_body = [&](Method method, const std::string& pattern, auto f) {
    router.add({.method = method, .pattern = pattern, .query = query, .body = BodyKind::kMemory, .handler = on(f)});
  };
  with_body(Method::kPost, items, create);
  with_body(Method::kPut, item, replace);
  with_body(Method::kPatch, item, update);
  router.add({.method = Method::kDelete, .pattern = item, .query = query, .handler = on(remove)});
}

}  // namespace server::api
