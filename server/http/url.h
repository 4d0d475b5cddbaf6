// The request target: path segments and query parameters, percent-decoded once and checked.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "server/http/message.h"

namespace server::http {

/// A target in its parts.
struct Target {
  std::string path;                   // decoded, for people and logs: an escaped slash looks like any other
  std::vector<std::string> segments;  // decoded one by one, so that an escaped slash stays in its segment
  NamedValues query;                  // decoded, '+' as a space; in order
};

/// Takes an origin-form target ("/tins/a?limit=5") apart.
///
/// Returns nothing for bad percent-encoding, invalid UTF-8, control characters in the path, NUL in the query,
/// "." and ".." segments, a fragment, or a target that does not begin with a slash.
std::optional<Target> parse_target(std::string_view target);

/// Decodes %XX. Returns nothing when a percent sign is not followed by two hexadecimal digits.
std::optional<std::string> percent_decode(std::string_view text, bool plus_is_space);

/// Whether `text` is well-formed UTF-8: no overlong forms, no surrogates, nothing above U+10FFFF.
bool valid_utf8(std::string_view text);

}  // namespace server::http
