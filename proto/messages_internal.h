// What the readers and the writers of messages share.
#pragma once

#include <span>
#include <string>

#include "proto/json_read.h"
#include "proto/json_write.h"
#include "proto/messages.h"

namespace proto {

/// Errors: kTooLarge, kInvalidValue (control characters, or no UTF-8), at `author_where` or `note_where`.
tin::base::Result<void> check_remark(const Remark& remark, std::string author_where, std::string note_where);

/// The members "author" and "note". Errors: kMalformed, kTooLarge, kInvalidValue (control characters).
tin::base::Result<Remark> read_remark(const Object& object);

/// The member "links".
void write_links(JsonWriter& json, std::span<const Link> links);

}  // namespace proto
