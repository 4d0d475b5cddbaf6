// What the writers of messages share.
#pragma once

#include <span>

#include "proto/json_write.h"
#include "proto/messages.h"

namespace proto {

/// The member "links".
void write_links(JsonWriter& json, std::span<const Link> links);

}  // namespace proto
