// POST /tins/{tin}/edits: all or nothing.
#include "server/api/answer.h"
#include "server/api/edit_place.h"
#include "server/api/positions.h"
#include "server/api/routes.h"
#include "server/obs/metrics.h"

namespace server::api {

using tin::base::Code;
using tin::base::error;

namespace {

/// Edits in the TIN's CRS. Errors: kInvalidValue at "/ops/i" where a position has no counterpart there.
Result<std::vector<app::WorldEdit>> to_world_edits(const proto::EditRequest& message, Positions& positions) {
  std::vector<app::WorldEdit> edits;
  edits.reserve(message.ops.size());
  for (std::size_t i = 0; i < message.ops.size(); ++i) {
    const auto converted = [&](double x, double y) { return positions.convert(proto::Position2{x, y}); };
    std::optional<proto::Position2> at = proto::Position2{};
    std::string where = "/ops/" + std::to_string(i);
    if (const auto* insert = std::get_if<proto::InsertOp>(&message.ops[i])) {
      if ((at = converted(insert->x, insert->y))) edits.emplace_back(app::InsertAt{at->x, at->y, insert->z});
    } else if (const auto* move = std::get_if<proto::MoveOp>(&message.ops[i])) {
      if ((at = converted(move->x, move->y))) edits.emplace_back(app::MoveTo{move->id, at->x, at->y});
    } else if (const auto* set = std::get_if<proto::SetZOp>(&message.ops[i])) {
      edits.emplace_back(tin::terrain::SetZ{set->id, set->z});
    } else if (const auto* within = std::get_if<proto::RemoveWithinOp>(&message.ops[i])) {
      app::RemoveWithin area;
      for (const proto::Position2& corner : within->polygon) {
        if (!(at = converted(corner.x, corner.y))) break;
        area.polygon.push_back({at->x, at->y});
      }
      if (!at) where += "/polygon/" + std::to_string(area.polygon.size());
      edits.emplace_back(std::move(area));
    } else {
      edits.emplace_back(tin::terrain::Remove{std::get<proto::RemoveOp>(message.ops[i]).id});
    }
    if (!at)
      return error(Code::kInvalidValue, "The position cannot be converted to the TIN's CRS.",
                   std::move(where));
  }
  return edits;
}

Result<Response> edit(Context& context, const Request& request) {
  const auto tin = context.catalogue.find(request.path_parameter("tin"));
  if (!tin) return tin.error();
  if (auto json = require_json(request); !json) return json.error();
  const auto place = edit_place(context, request);
  if (!place) return place.error();
  const auto expected = expected_revisions(**tin, request.header("if-match"));
  if (!expected) return expected.error();
  const LimitConfig& limits = context.config.limits;
  const auto most = static_cast<std::size_t>(limits.edits_per_request);
  const auto message =
      proto::read_edit_request(request.body, {most, static_cast<std::size_t>(limits.areas_per_request),
                                              static_cast<std::size_t>(limits.polygon_positions)});
  if (!message) return message.error();
  const std::string own_crs =
      (*tin)->read([](const auto& terrain, std::uint64_t) { return terrain.frame().crs; });
  auto positions = Positions::between(message->crs.value_or(own_crs), own_crs, "/crs");
  if (!positions) return positions.error();
  const auto edits = to_world_edits(*message, *positions);
  if (!edits) return edits.error();
  if (auto room = room_for_edit(context, **tin, *edits); !room) return room.error();
  app::Terms terms = place->terms(*expected, message->remark);
  terms.most_within = most;
  const auto edited = (*tin)->edit(*edits, terms);
  if (!edited) {
    const bool has_place = edited.error().where.starts_with("/");
    return has_place ? within("/ops", edited.error()) : edited.error();
  }
  obs::metrics().edits.fetch_add(edits->size(), std::memory_order_relaxed);
  Response response = json_answer(proto::edit_result_json(edited->revision, edited->ids, edited->areas));
  response.headers.emplace_back("ETag", entity_tag(**tin, edited->revision, request));
  return response;
}

}  // namespace

void add_edits(http::Router& router, Context& context) {
  router.add({.method = http::Method::kPost,
              .pattern = "/tins/{tin}/edits",
              .body = http::BodyKind::kMemory,
              .handler = guarded([&context](Request& request) { return edit(context, request); })});
}

}  // namespace server::api
