#include "proto/history.h"

#include "proto/json_read.h"
#include "proto/json_write.h"
#include "proto/messages_internal.h"

namespace proto {

using tin::base::Code;
using tin::base::Result;

namespace {

constexpr std::size_t kMaxTitle = 512;

void write_revision(JsonWriter& json, const RevisionDocument& revision) {
  json.begin_object();
  json.key("revision").integer(revision.revision);
  json.key("time").string(revision.time);
  if (!revision.remark.author.empty()) json.key("author").string(revision.remark.author);
  if (!revision.remark.note.empty()) json.key("note").string(revision.remark.note);
  json.key("inserted").integer(revision.inserted);
  json.key("removed").integer(revision.removed);
  json.key("changed").integer(revision.changed);
  json.key("bbox").begin_array();
  for (const double bound : revision.bbox) json.number(bound);
  json.end_array().end_object();
}

void write_revisions(JsonWriter& json, const std::vector<RevisionDocument>& revisions) {
  json.begin_array();
  for (const RevisionDocument& revision : revisions) write_revision(json, revision);
  json.end_array();
}

}  // namespace

Result<std::string> read_patch_tin(std::string_view body) {
  auto document = Document::parse(body);
  if (!document) return std::move(document).error();
  auto object = document->root().object({"title"});
  if (!object) return std::move(object).error();
  auto member = object->require("title");
  if (!member) return std::move(member).error();
  auto text = member->string(kMaxTitle);
  if (!text) return std::move(text).error();
  if (auto fine = check_title(*text, member->pointer()); !fine) return std::move(fine).error();
  return std::string(*text);
}

Result<Remark> read_revert_request(std::string_view body) {
  if (body.empty()) return Remark{};
  auto document = Document::parse(body);
  if (!document) return std::move(document).error();
  auto object = document->root().object({"author", "note"});
  if (!object) return std::move(object).error();
  return read_remark(*object);
}

Result<Remark> parse_remark(std::optional<std::string> author, std::optional<std::string> note) {
  Remark remark{std::move(author).value_or(""), std::move(note).value_or("")};
  if (auto fine = check_remark(remark, "query:author", "query:note"); !fine) return std::move(fine).error();
  return remark;
}

std::string revision_json(const RevisionDocument& revision) {
  JsonWriter json;
  write_revision(json, revision);
  return json.take();
}

std::string revision_list_json(const RevisionList& list) {
  JsonWriter json;
  json.begin_object();
  json.key("revisions");
  write_revisions(json, list.revisions);
  json.key("current").integer(list.current);
  if (list.oldest) json.key("oldest").integer(*list.oldest);
  write_links(json, list.links);
  json.end_object();
  return json.take();
}

std::string change_list_json(const ChangeList& list) {
  JsonWriter json;
  json.begin_object();
  json.key("since").integer(list.since);
  json.key("revision").integer(list.revision);
  json.key("changes");
  write_revisions(json, list.changes);
  write_links(json, list.links);
  json.end_object();
  return json.take();
}

}  // namespace proto
