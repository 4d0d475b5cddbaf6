// Just enough of UTF-8 to never send or cut a broken text.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace proto {

/// Bytes of the well-formed character (RFC 3629: shortest form, no surrogates, up to U+10FFFF) that `text`
/// begins with; 0 when it begins with none.
std::size_t utf8_length(std::string_view text);

/// At most `max_bytes` of `text`, cut between characters, with "..." where something was cut.
std::string utf8_prefix(std::string_view text, std::size_t max_bytes);

}  // namespace proto
