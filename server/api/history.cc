// /tins/{tin}/revisions and /tins/{tin}/changes: what became of a TIN, following it, and undoing it.
#include "server/api/history.h"

#include <algorithm>
#include <limits>

#include "proto/bbox.h"
#include "server/api/answer.h"
#include "server/api/change_stream.h"
#include "server/api/edit_place.h"
#include "server/api/routes.h"
#include "server/http/field_value.h"

namespace server::api {

using tin::base::Code;
using tin::base::error;

proto::RevisionDocument revision_document(const app::RevisionSummary& revision,
                                          const tin::frame::Frame& frame) {
  proto::RevisionDocument document;
  document.revision = revision.revision;
  document.time = rfc3339(revision.info.time_ms);
  document.remark = {revision.info.author, revision.info.note};
  document.inserted = revision.inserted;
  document.removed = revision.removed;
  document.changed = revision.changed;
  document.bbox = {frame.x.world(revision.bounds.min.x), frame.y.world(revision.bounds.min.y),
                   frame.x.world(revision.bounds.max.x), frame.y.world(revision.bounds.max.y)};
  return document;
}

namespace {

constexpr std::uint64_t kDefaultListed = 100, kMostListed = 1000;
constexpr std::uint64_t kMostRevision = std::numeric_limits<std::int64_t>::max();

tin::frame::Frame frame_of(const app::Tin& tin) {
  return tin.read([](const tin::terrain::Terrain& terrain, std::uint64_t) { return terrain.frame(); });
}

Result<std::uint64_t> limit_of(const Request& request) {
  const auto text = request.query_value("limit");
  return text ? proto::parse_count(*text, 1, kMostListed, "query:limit")
              : Result<std::uint64_t>(kDefaultListed);
}

std::vector<proto::RevisionDocument> documents(const app::RevisionPage& page, const app::Tin& tin) {
  const auto frame = frame_of(tin);
  std::vector<proto::RevisionDocument> out;
  for (const app::RevisionSummary& revision : page.revisions)
    out.push_back(revision_document(revision, frame));
  return out;
}

Response tagged(std::string body, const app::Tin& tin, std::uint64_t revision, const Request& request) {
  Response response = json_answer(std::move(body));
  response.headers.emplace_back("ETag", entity_tag(tin, revision, request));
  return response;
}

Result<Response> list(Context& context, const Request& request) {
  const auto tin = context.catalogue.find(request.path_parameter("tin"));
  if (!tin) return tin.error();
  const auto limit = limit_of(request);
  if (!limit) return limit.error();
  std::uint64_t last = kMostRevision;
  if (const auto text = request.query_value("next")) {
    const auto parsed = proto::parse_count(*text, 0, kMostRevision, "query:next");
    if (!parsed) return error(Code::kMalformed, "This is no token that a page gave.", "query:next");
    last = *parsed;
  }
  const auto page = app::read_revisions(
      context.catalogue.store(), (*tin)->id(),
      {.last = last, .newest_first = true, .most_rows = static_cast<std::size_t>(*limit)});
  if (!page) return page.error();
  proto::RevisionList answer{documents(*page, **tin), page->present, std::nullopt, {}};
  if (page->oldest > 0) answer.oldest = page->oldest;
  const std::string asked = request.path + "?limit=" + std::to_string(*limit);
  answer.links.push_back({request.path, "self", std::string(kJson), ""});
  if (!page->revisions.empty() && page->revisions.back().revision > page->oldest) {
    const std::string next = std::to_string(page->revisions.back().revision - 1);
    answer.links.push_back({asked + "&next=" + next, "next", std::string(kJson), ""});
  }
  return tagged(proto::revision_list_json(answer), **tin, page->present, request);
}

/// The revision that the client has: what it says, or the present one. Errors: kMalformed, kInvalidValue.
Result<std::uint64_t> since_of(const app::Tin& tin, const Request& request, bool stream) {
  const std::uint64_t present = tin.revision();
  const std::string_view resumed = request.header("last-event-id");
  std::uint64_t since = present;
  const char* where = "query:since";
  if (stream && !resumed.empty()) {
    where = "header:Last-Event-ID";
    const auto parsed = proto::parse_count(std::string(resumed), 1, kMostRevision, where);
    if (!parsed) return parsed.error();
    since = *parsed;
  } else if (const auto text = request.query_value("since")) {
    const auto parsed = proto::parse_count(*text, 1, kMostRevision, where);
    if (!parsed) return parsed.error();
    since = *parsed;
  }
  if (since <= present) return since;
  return error(Code::kInvalidValue, "The TIN is at revision " + std::to_string(present) + " only.", where);
}

tin::base::Error not_kept(std::uint64_t since) {
  return error(Code::kGone, "What came after revision " + std::to_string(since) +
                                " is no longer kept as changes: fetch the TIN anew.");
}

Result<Response> stream(Context& context, const std::shared_ptr<app::Tin>& tin, std::uint64_t since) {
  const auto first = context.catalogue.store().journal_extent(tin->id());
  if (!first) return first.error();
  if (since < first->last && (first->first == 0 || since + 1 < first->first)) return not_kept(since);
  if (!context.listeners.try_acquire())
    return error(Code::kTooMany, "So many listen already that there is no place left.");
  Response response{200,
                    {{"Content-Type", "text/event-stream"}, {"Cache-Control", "no-store"}},
                    std::make_unique<ChangeStream>(context.catalogue, tin, since, context.listeners)};
  return response;
}

Result<Response> changes(Context& context, const Request& request) {
  const auto tin = context.catalogue.find(request.path_parameter("tin"));
  if (!tin) return tin.error();
  const auto limit = limit_of(request);
  if (!limit) return limit.error();
  const bool streams = http::prefers(request.header("accept"), "text/event-stream", kJson);
  const auto since = since_of(**tin, request, streams);
  if (!since) return since.error();
  if (streams) return stream(context, *tin, *since);
  const auto page = app::read_revisions(context.catalogue.store(), (*tin)->id(),
                                        {.first = *since + 1, .most_rows = static_cast<std::size_t>(*limit)});
  if (!page) return page.error();
  if (*since < page->present && (page->revisions.empty() || page->revisions.front().revision != *since + 1))
    return not_kept(*since);
  const std::uint64_t after = page->revisions.empty() ? *since : page->revisions.back().revision;
  proto::ChangeList answer{*since, after, documents(*page, **tin), {}};
  answer.links.push_back({request.path + "?since=" + std::to_string(*since), "self", std::string(kJson), ""});
  if (after < page->present) {
    answer.links.push_back(
        {request.path + "?since=" + std::to_string(after) + "&limit=" + std::to_string(*limit), "next",
         std::string(kJson), ""});
  }
  return tagged(proto::change_list_json(answer), **tin, page->present, request);
}

Result<Response> revert(Context& context, const Request& request) {
  const auto tin = context.catalogue.find(request.path_parameter("tin"));
  if (!tin) return tin.error();
  const auto revision =
      proto::parse_count(std::string(request.path_parameter("revision")), 0, kMostRevision, "path:revision");
  if (!revision) return revision.error();
  if (!request.body.empty()) {
    if (auto json = require_json(request); !json) return json.error();
  }
  auto remark = proto::read_revert_request(request.body);
  if (!remark) return remark.error();
  if (remark->note.empty()) remark->note = "undo of revision " + std::to_string(*revision);
  const auto place = edit_place(context, request);
  if (!place) return place.error();
  const auto expected = expected_revisions(**tin, request.header("if-match"));
  if (!expected) return expected.error();
  const auto reverted =
      (*tin)->revert(*revision, place->terms(*expected, *remark), &context.catalogue.memory());
  if (!reverted) return reverted.error();
  return tagged(proto::edit_result_json(reverted->revision, reverted->ids), **tin, reverted->revision,
                request);
}

}  // namespace

void add_history(http::Router& router, Context& context) {
  using http::Method;
  const auto on = [&context](auto f) {
    return guarded([&context, f](Request& request) { return f(context, request); });
  };
  router.add({.method = Method::kGet,
              .pattern = "/tins/{tin}/revisions",
              .query = {"limit", "next"},
              .handler = on(list)});
  router.add({.method = Method::kPost,
              .pattern = "/tins/{tin}/revisions/{revision}/revert",
              .body = http::BodyKind::kMemory,
              .handler = on(revert)});
  router.add({.method = Method::kGet,
              .pattern = "/tins/{tin}/changes",
              .query = {"since", "limit"},
              .handler = on(changes)});
}

}  // namespace server::api
