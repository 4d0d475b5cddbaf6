// Revisions on the wire: lists of them, what changed since one, undoing one. See openapi.json, tag History.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "proto/messages.h"
#include "tin/base/result.h"

namespace proto {

/// PATCH /tins/{tin}: the new title. Errors: as check_title; kMalformed.
tin::base::Result<std::string> read_patch_tin(std::string_view body);

/// POST /tins/{tin}/revisions/{revision}/revert: the body may be empty.
tin::base::Result<Remark> read_revert_request(std::string_view body);

/// What the parameters "author" and "note" say of an edit whose body is a resource itself. Errors: kTooLarge,
/// kInvalidValue (control characters, or no UTF-8), at the parameter.
tin::base::Result<Remark> parse_remark(std::optional<std::string> author, std::optional<std::string> note);

/// What a revision did.
struct RevisionDocument {
  std::uint64_t revision = 0;
  std::string time;  // RFC 3339
  Remark remark;     // what is empty is left out
  std::uint64_t inserted = 0, removed = 0, changed = 0;
  std::array<double, 4> bbox{};  // min x, min y, max x, max y in the TIN's CRS
};
std::string revision_json(const RevisionDocument& revision);

struct RevisionList {
  std::vector<RevisionDocument> revisions;
  std::uint64_t current = 0;
  std::optional<std::uint64_t> oldest;
  std::vector<Link> links;
};
std::string revision_list_json(const RevisionList& list);

struct ChangeList {
  std::uint64_t since = 0;
  std::uint64_t revision = 0;
  std::vector<RevisionDocument> changes;
  std::vector<Link> links;
};
std::string change_list_json(const ChangeList& list);

}  // namespace proto
