// The framing guard and the body parser. The bytes are read as a connection's: whether they come at once or
// one by one, the same requests must be seen, ending at the same bytes.
#include <algorithm>
#include <array>
#include <optional>

#include "server/http/body_parser.h"
#include "server/http/framing.h"
#include "server/http/url.h"
#include "tests/fuzz/target.h"
#include "tin/base/check.h"

namespace tests::fuzz {

std::vector<std::string> seeds() {
  const std::string get =
      "GET /tins/a%20b?limit=10&crs=x HTTP/1.1\r\nHost: t:80\r\nAccept: a\r\nAccept: b\r\n\r\n";
  const std::string post = "POST /tins HTTP/1.1\r\nHost: t\r\nContent-Length: 11\r\n\r\nhello world";
  const std::string chunked =
      "POST / HTTP/1.1\r\nHost: t\r\nTransfer-Encoding: chunked\r\n\r\n"
      "5;a=b\r\nhello\r\n006\r\n world\r\n0\r\nX-Sum: 1\r\n\r\n";
  return {get,
          post,
          chunked,
          get + post + chunked + get,
          "GET http://T/ HTTP/1.1\r\nHost: t\r\nConnection: close, TE\r\n\r\n",
          "GET / HTTP/1.0\r\nConnection: keep-alive\r\n\r\n",
          "POST / HTTP/1.1\r\nHost: t\r\nContent-Length: 5\r\nTransfer-Encoding: chunked\r\n\r\n0\r\n\r\n",
          "POST / HTTP/1.1\r\nHost: t\r\nTransfer-Encoding: xchunked\r\nExpect: 100-continue\r\n\r\n",
          "OPTIONS /a/../b%2f%00?%zz HTTP/1.1\r\nHost: [::1]\r\n folded: 1\r\nX\r\n\r\n"};
}

namespace {

using server::http::BodyParser;

constexpr std::uint64_t kBodyLimit = 4096;
constexpr std::size_t kFramingLimit = 512;

/// What a connection was taken for.
struct Seen {
  std::vector<std::string> requests;  // target and body
  std::size_t used = 0;               // up to where the bytes belong to whole requests
  bool broken = false;                // a head or a body was refused there
  friend bool operator==(const Seen&, const Seen&) = default;
};

/// Reads a body, giving the parser at most `step` bytes more at a time. Nothing: it is not whole.
std::optional<std::string> read_body(BodyParser& parser, std::string_view bytes, std::size_t step,
                                     std::size_t& used, bool& broken) {
  std::string body;
  std::array<char, 61> block{};
  std::size_t given = std::min(step, bytes.size());
  parser.set_limits(kBodyLimit, kFramingLimit);
  while (!parser.done()) {
    const auto result = parser.parse(bytes.substr(used, given - used), block);
    TIN_CHECK(result.used <= given - used && result.filled <= block.size());
    used += result.used;
    body.append(block.data(), result.filled);
    TIN_CHECK(body.size() <= kBodyLimit);
    if (result.state == BodyParser::State::kTooLarge || result.state == BodyParser::State::kBroken) {
      broken = true;
      return std::nullopt;
    }
    if (result.state != BodyParser::State::kNeedMore) continue;
    if (given == bytes.size()) return std::nullopt;
    given = std::min(given + step, bytes.size());
  }
  return body;
}

Seen read_connection(std::string_view bytes, std::size_t step) {
  Seen seen;
  while (!seen.broken) {
    const std::string_view rest = bytes.substr(seen.used);
    const std::size_t end = server::http::find_head_end(rest, 0);
    if (end == std::string_view::npos) return seen;
    const auto read = server::http::read_head(rest.substr(0, end), {});
    const auto* head = std::get_if<server::http::Head>(&read);
    if (head == nullptr) {
      seen.broken = true;
      return seen;
    }
    BodyParser parser(*head);
    TIN_CHECK(!(head->chunked && head->content_length));
    std::size_t used = 0;
    const auto body = head->has_body() ? read_body(parser, rest.substr(end), step, used, seen.broken)
                                       : std::optional<std::string>("");
    if (!body) return seen;
    TIN_CHECK(!head->content_length || *head->content_length == body->size());
    seen.requests.push_back(head->target + "\n" + *body);
    seen.used += end + used;
  }
  return seen;
}

}  // namespace
}  // namespace tests::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes = tests::fuzz::text(data, size);
  const tests::fuzz::Seen whole = tests::fuzz::read_connection(bytes, bytes.size() + 1);
  TIN_CHECK(tests::fuzz::read_connection(bytes, 1) == whole);
  TIN_CHECK(tests::fuzz::read_connection(bytes, 7) == whole);
  const auto target = server::http::parse_target(bytes.substr(0, 2000));
  if (target) {
    for (const std::string& segment : target->segments) TIN_CHECK(segment != ".." && segment != ".");
  }
  return 0;
}
