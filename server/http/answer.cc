#include "server/http/answer.h"

#include <algorithm>
#include <array>
#include <boost/beast/http/status.hpp>
#include <ctime>
#include <optional>

#include "server/http/compress.h"
#include "server/http/files.h"
#include "tin/base/check.h"

namespace server::http {
namespace {

// Fields of the connection, of the framing, or of ours: what a handler says about them is not sent.
constexpr std::array<std::string_view, 12> kReserved = {"content-length",
                                                        "transfer-encoding",
                                                        "connection",
                                                        "keep-alive",
                                                        "trailer",
                                                        "upgrade",
                                                        "date",
                                                        "server",
                                                        "x-request-id",
                                                        "access-control-allow-origin",
                                                        "access-control-expose-headers",
                                                        "te"};
// Fields that describe a body which a 304 does not have.
constexpr std::array<std::string_view, 3> kOfTheBody = {"content-type", "content-encoding",
                                                        "content-disposition"};
constexpr std::string_view kCors =
    "Access-Control-Allow-Origin: *\r\n"
    "Access-Control-Expose-Headers: ETag, Location, Link, Content-Crs, X-Request-Id, Preference-Applied, "
    "Retry-After, WWW-Authenticate\r\n";

template <class List>
bool contains(const List& list, std::string_view name) {
  return std::find(list.begin(), list.end(), name) != list.end();
}

/// Of this second; made once in it for each thread.
const std::string& http_date() {
  thread_local std::time_t made_at = -1;
  thread_local std::string date;
  const std::time_t now = std::time(nullptr);
  if (now == made_at) return date;
  std::tm utc{};
  gmtime_r(&now, &utc);
  std::array<char, 40> text{};
  const std::size_t size = std::strftime(text.data(), text.size(), "%a, %d %b %Y %H:%M:%S GMT", &utc);
  date.assign(text.data(), size);
  made_at = now;
  return date;
}

/// A handler that echoes what a client sent must not let it begin a new line.
void append_one_line(std::string& head, std::string_view text) {
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    head += byte < 0x20 || byte == 0x7f ? ' ' : c;
  }
}

std::string_view field(const NamedValues& headers, std::string_view lower_name) {
  for (const auto& [name, value] : headers) {
    if (lower_case(name) == lower_name) return value;
  }
  return {};
}

bool reading(Method method) {
  return method == Method::kGet || method == Method::kHead;
}

/// The entity tag of an encoded body: two bodies that differ may not share a strong tag.
std::string tag_of_encoding(std::string_view tag, Encoding encoding) {
  if (encoding == Encoding::kIdentity || tag.empty() || tag.back() != '"') return std::string(tag);
  std::string changed(tag.substr(0, tag.size() - 1));
  return changed.append("-").append(encoding_name(encoding)).append("\"");
}

/// How the body is to be encoded, and whether that depends on what the client accepts.
struct Coding {
  Encoding encoding = Encoding::kIdentity;
  bool varies = false;
};

Coding choose_coding(const Response& response, const AnswerContext& context) {
  Coding coding;
  if (context.compress_from == 0 || context.minor == 0 || response.status != 200) return coding;
  if (std::holds_alternative<FileBody>(response.body)) return coding;
  if (!field(response.headers, "content-encoding").empty()) return coding;
  if (!compressible(field(response.headers, "content-type"))) return coding;
  const auto* text = std::get_if<std::string>(&response.body);
  if (text != nullptr && text->size() < context.compress_from) return coding;
  coding.varies = true;
  coding.encoding = choose_encoding(context.accept_encoding);
  return coding;
}

void encode_body(Response& response, const AnswerContext& context, Encoding encoding) {
  if (encoding == Encoding::kIdentity || context.method == Method::kHead) return;
  if (auto* text = std::get_if<std::string>(&response.body)) {
    *text = compress(*text, encoding);
  } else {
    auto& source = std::get<std::unique_ptr<BodySource>>(response.body);
    source = compressing(std::move(source), encoding);
  }
}

/// Settles status, framing and body; returns the length to state, if one is to be stated.
std::optional<std::uint64_t> settle_body(Response& response, const AnswerContext& context, Answer& answer) {
  auto* file = std::get_if<FileBody>(&response.body);
  if (answer.status == 204 || answer.status == 304) {
    if (file != nullptr && file->remove_after) std::filesystem::remove(file->path);
    return std::nullopt;
  }
  const bool head_only = context.method == Method::kHead;
  std::optional<std::uint64_t> length;
  if (auto* text = std::get_if<std::string>(&response.body)) {
    length = text->size();
    answer.framing = Framing::kString;
    answer.body = std::move(*text);
  } else if (file != nullptr) {
    auto source = std::make_unique<FileSource>(*file);
    length = source->size();
    answer.framing = Framing::kLength;
    answer.source = std::move(source);
  } else {
    answer.source = std::move(std::get<std::unique_ptr<BodySource>>(response.body));
    TIN_CHECK(answer.source != nullptr);
    answer.framing = context.minor == 1 ? Framing::kChunked : Framing::kClose;
    if (answer.framing == Framing::kClose) answer.keep_alive = false;
  }
  if (head_only) {
    answer.framing = Framing::kNone;
    answer.body.clear();
    answer.source.reset();
  }
  return length;
}

}  // namespace

bool none_match_hits(std::string_view list, std::string_view etag) {
  if (etag.starts_with("W/")) etag.remove_prefix(2);
  if (etag.empty()) return false;
  while (!list.empty()) {
    const std::size_t start = list.find_first_not_of(" \t,");
    if (start == std::string_view::npos) return false;
    list.remove_prefix(start);
    if (list.front() == '*') return true;
    if (list.starts_with("W/")) list.remove_prefix(2);
    if (!list.starts_with('"')) return false;  // not a list of tags: as if it were not there
    const std::size_t end = list.find('"', 1);
    if (end == std::string_view::npos) return false;
    if (list.substr(0, end + 1) == etag) return true;
    list.remove_prefix(end + 1);
  }
  return false;
}

Answer make_answer(Response response, const AnswerContext& context) {
  Answer answer;
  answer.status = response.status;
  answer.keep_alive = context.keep_alive;
  const Coding coding = choose_coding(response, context);
  for (auto& [name, value] : response.headers) {
    if (lower_case(name) == "etag") value = tag_of_encoding(value, coding.encoding);
  }
  const bool unchanged = response.status == 200 && reading(context.method) &&
                         none_match_hits(context.if_none_match, field(response.headers, "etag"));
  if (unchanged) {
    answer.status = 304;
  } else {
    encode_body(response, context, coding.encoding);
  }
  std::optional<std::uint64_t> length = settle_body(response, context, answer);

  const auto reason =
      boost::beast::http::obsolete_reason(static_cast<boost::beast::http::status>(answer.status));
  std::string& head = answer.head;
  head.reserve(512);
  head.append("HTTP/1.1 ").append(std::to_string(answer.status)).append(" ");
  head.append(reason.data(), reason.size());
  head.append("\r\nDate: ").append(http_date());
  head.append("\r\nServer: tinsmith\r\nX-Request-Id: ")
      .append(context.request_id)
      .append("\r\n")
      .append(kCors);
  for (const auto& [name, value] : response.headers) {
    const std::string lower = lower_case(name);
    if (contains(kReserved, lower) || (unchanged && contains(kOfTheBody, lower))) continue;
    append_one_line(head, name);
    head += ": ";
    append_one_line(head, value);
    head += "\r\n";
  }
  if (coding.varies) head += "Vary: Accept-Encoding\r\n";
  // HEAD does not make the body, so its length is not known where it would be encoded.
  const bool encoded = coding.encoding != Encoding::kIdentity;
  if (encoded && !unchanged)
    head += "Content-Encoding: " + std::string(encoding_name(coding.encoding)) + "\r\n";
  if (encoded && context.method == Method::kHead) length.reset();
  if (length) head += "Content-Length: " + std::to_string(*length) + "\r\n";
  if (answer.framing == Framing::kChunked) head += "Transfer-Encoding: chunked\r\n";
  if (!answer.keep_alive) {
    head += "Connection: close\r\n";
  } else if (context.minor == 0) {
    head += "Connection: keep-alive\r\n";
  }
  head += "\r\n";
  return answer;
}

}  // namespace server::http
