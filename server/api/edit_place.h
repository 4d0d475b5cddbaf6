// What every request that edits a TIN needs first, whatever resource it comes to.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "proto/messages.h"
#include "server/api/answer.h"
#include "server/api/routes.h"
#include "server/api/slots.h"

namespace server::api {

/// A place among the edits under way, until the end of the scope, and the key that the request bears.
struct EditPlace {
  Slot slot;
  std::optional<app::RequestKey> key;

  /// What the edit is bound to. Borrows `expected`.
  app::Terms terms(std::span<const std::uint64_t> expected, const proto::Remark& remark = {}) const;
};

/// Errors: kTooMany (edits at once), kMalformed (the key).
Result<EditPlace> edit_place(Context& context, const Request& request);

/// Whether there is memory for the vertices that the edits insert, and for the copy that the edit makes where
/// somebody holds a version. Errors: kTooMany.
Result<void> room_for_edit(const Context& context, const app::Tin& tin,
                           std::span<const app::WorldEdit> edits);

}  // namespace server::api
