// The framing guard: the bytes of a request's head, read strictly, before anything else looks at them.
//
// Where two readers of one connection disagree about where a request ends, a second request can be smuggled
// past the first reader. Beast 1.74 accepts many ambiguous heads, so every head passes here first, and only
// heads with one meaning get to Beast. A refused head always ends the connection.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>

#include "server/http/message.h"

namespace server::http {

/// A head that has exactly one meaning.
struct Head {
  Method method = Method::kGet;
  std::string target;   // origin-form; an absolute-form target has lost its scheme and authority
  int minor = 1;        // HTTP/1.`minor`: 0 or 1
  NamedValues headers;  // lower-case names; repeated fields joined with ", "
  std::optional<std::uint64_t> content_length;
  bool chunked = false;
  bool keep_alive = true;
  bool expects_continue = false;

  bool has_body() const { return chunked || content_length.value_or(0) > 0; }
};

/// Why a head was refused, as an HTTP status (400, 414, 417, 431, 501, 505).
struct Refusal {
  int status = 400;
  std::string detail;
};

struct HeadLimits {
  std::size_t target_bytes = 8 * 1024;
  std::size_t fields = 100;
};

/// Where the head at the front of `text` ends (behind its empty line), or npos if it goes on. Lines that end
/// with LF alone count, so that read_head() can refuse them at once. `from`: where to begin, at most three
/// bytes before the end of what was searched already.
std::size_t find_head_end(std::string_view text, std::size_t from);

/// Whether `text` is a token: what names are made of (RFC 9110, 5.6.2).
bool is_token(std::string_view text);

/// Whether `line` (without its end) is one field, "name: value", not folded.
bool is_field_line(std::string_view line);

/// Reads a head, from the method to the empty line and no further.
///
/// Requires: `raw` was cut where find_head_end() says.
std::variant<Head, Refusal> read_head(std::string_view raw, const HeadLimits& limits);

}  // namespace server::http
