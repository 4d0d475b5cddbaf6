// Moments and intervals of RFC 3339, as OGC APIs take them in "datetime".
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "tin/base/result.h"

namespace proto {

/// From one moment to another, both included, in milliseconds since 1970 in UTC; nothing: open.
struct TimeSpan {
  std::optional<std::int64_t> from_ms, until_ms;
  bool contains(std::int64_t ms) const {
    return (!from_ms || *from_ms <= ms) && (!until_ms || ms <= *until_ms);
  }
};

/// "2026-11-27T08:15:00Z" (that second), "2026-11-27T08:15Z" (that minute), "2026-11-27" (that day), "a/b",
/// "../b", "a/..". Errors: kMalformed.
tin::base::Result<TimeSpan> parse_datetime(std::string_view text, const std::string& where);

}  // namespace proto
