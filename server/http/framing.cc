#include "server/http/framing.h"

#include <algorithm>
#include <array>

#include "server/http/field_value.h"

namespace server::http {
namespace {

constexpr std::string_view kTokenSymbols = "!#$%&'*+-.^_`|~";
constexpr std::string_view kHostSymbols = "-._~!$&'()*+;=:[]%";
constexpr std::size_t kMaxLengthDigits = 18;  // fits into 64 bits whatever the digits are

bool alphanumeric(char c) {
  return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
}

bool consists_of(std::string_view text, std::string_view symbols) {
  return std::all_of(text.begin(), text.end(),
                     [&](char c) { return alphanumeric(c) || symbols.find(c) != std::string_view::npos; });
}

/// Visible ASCII, bytes above it, spaces and tabs: what a field value may hold.
bool is_field_value(std::string_view text) {
  return std::all_of(text.begin(), text.end(), [](char c) {
    const auto byte = static_cast<unsigned char>(c);
    return byte == '\t' || (byte >= 0x20 && byte != 0x7f);
  });
}

Refusal bad(std::string detail) {
  return Refusal{400, std::move(detail)};
}

/// Goes through the lines of a head once and gathers what they say.
class HeadReader {
 public:
  explicit HeadReader(const HeadLimits& limits) : limits_(limits) {}

  std::variant<Head, Refusal> read(std::string_view raw) {
    bool first = true;
    while (!raw.empty()) {
      const std::size_t end = raw.find('\n');
      if (end == std::string_view::npos || end == 0 || raw[end - 1] != '\r') {
        return bad("a line of the request's head does not end with CR LF");
      }
      const std::string_view line = raw.substr(0, end - 1);
      raw.remove_prefix(end + 1);
      if (line.empty() && raw.empty()) break;
      const std::optional<Refusal> refusal = first ? read_request_line(line) : read_field(line);
      if (refusal) return *refusal;
      first = false;
    }
    if (std::optional<Refusal> refusal = conclude()) return std::move(*refusal);
    return std::move(head_);
  }

 private:
  std::optional<Refusal> read_request_line(std::string_view line) {
    const std::size_t space = line.find(' ');
    const std::size_t last = line.rfind(' ');
    if (space == std::string_view::npos || last == space)
      return bad("the request line is not METHOD target VERSION");
    const std::string_view method = line.substr(0, space);
    const std::string_view target = line.substr(space + 1, last - space - 1);
    const std::string_view version = line.substr(last + 1);
    if (!is_token(method)) return bad("the method is not a token");
    if (version.size() != 8 || !version.starts_with("HTTP/"))
      return bad("the request line ends without a version");
    if (version != "HTTP/1.1" && version != "HTTP/1.0")
      return Refusal{505, "only HTTP/1.0 and HTTP/1.1 are spoken here"};
    head_.minor = version.back() - '0';
    if (target.size() > limits_.target_bytes) return Refusal{414, "the request target is too long"};
    if (std::optional<Refusal> refusal = read_target(target)) return refusal;
    const std::optional<Method> known = method_named(method);
    if (!known) return Refusal{501, "this method is not implemented"};
    head_.method = *known;
    return std::nullopt;
  }

  std::optional<Refusal> read_target(std::string_view target) {
    const bool printable =
        std::all_of(target.begin(), target.end(), [](char c) { return c > 0x20 && c < 0x7f; });
    if (!printable) return bad("the request target holds a character that must be percent-encoded");
    for (const std::string_view scheme : {"http://", "https://"}) {
      if (lower_case(target.substr(0, scheme.size())) != scheme) continue;
      target.remove_prefix(scheme.size());
      const std::size_t end = std::min(target.find_first_of("/?"), target.size());
      authority_ = lower_case(target.substr(0, end));
      if (authority_->empty()) return bad("the request target has no host");
      target.remove_prefix(end);
      head_.target = target;
      if (!target.starts_with('/')) head_.target.insert(head_.target.begin(), '/');
      return std::nullopt;
    }
    if (!target.starts_with('/')) return bad("the request target must begin with a slash");
    head_.target = target;
    return std::nullopt;
  }

  std::optional<Refusal> read_field(std::string_view line) {
    if (++fields_ > limits_.fields) return Refusal{431, "the request has too many header fields"};
    if (line.starts_with(' ') || line.starts_with('\t'))
      return bad("a header field is folded over two lines");
    const std::size_t colon = line.find(':');
    if (colon == std::string_view::npos) return bad("a header field has no colon");
    if (!is_token(line.substr(0, colon))) return bad("a header field's name is not a token");
    const std::string name = lower_case(line.substr(0, colon));
    const std::string_view value = trimmed(line.substr(colon + 1));
    if (!is_field_value(value)) return bad("a header field's value holds a control character");
    if (std::optional<Refusal> refusal = read_framing_field(name, value)) return refusal;
    const auto same = std::find_if(head_.headers.begin(), head_.headers.end(),
                                   [&](const auto& h) { return h.first == name; });
    if (same == head_.headers.end()) {
      head_.headers.emplace_back(name, value);
    } else {
      same->second.append(", ").append(value);
    }
    return std::nullopt;
  }

  std::optional<Refusal> read_framing_field(std::string_view name, std::string_view value) {
    if (name == "host") return read_host(value);
    if (name == "content-length") return read_length(value);
    if (name == "transfer-encoding") return read_transfer_encoding(value);
    if (name == "connection") return read_connection(value);
    if (name == "expect") {
      if (lower_case(value) != "100-continue")
        return Refusal{417, "only the expectation 100-continue is known"};
      head_.expects_continue = true;
    }
    return std::nullopt;
  }

  std::optional<Refusal> read_host(std::string_view value) {
    if (host_) return bad("the request has more than one Host");
    if (!consists_of(value, kHostSymbols)) return bad("the Host is not a host name");
    host_ = lower_case(value);
    return std::nullopt;
  }

  std::optional<Refusal> read_length(std::string_view value) {
    if (head_.content_length) return bad("the request has more than one Content-Length");
    const bool digits = std::all_of(value.begin(), value.end(), [](char c) { return c >= '0' && c <= '9'; });
    if (value.empty() || !digits) return bad("the Content-Length is not a number");
    if (value.size() > kMaxLengthDigits) return Refusal{413, "the Content-Length is beyond all measure"};
    std::uint64_t length = 0;
    for (const char c : value) length = length * 10 + static_cast<std::uint64_t>(c - '0');
    head_.content_length = length;
    return std::nullopt;
  }

  std::optional<Refusal> read_transfer_encoding(std::string_view value) {
    if (head_.chunked) return bad("the request has more than one Transfer-Encoding");
    const std::string coding = lower_case(value);
    if (coding.find(',') != std::string::npos && coding.find("chunked") != coding.rfind("chunked")) {
      return bad("the body is chunked more than once");
    }
    if (coding.empty()) return bad("the Transfer-Encoding is empty");
    if (coding != "chunked") return Refusal{501, "the only Transfer-Encoding known is exactly chunked"};
    head_.chunked = true;
    return std::nullopt;
  }

  std::optional<Refusal> read_connection(std::string_view value) {
    while (!value.empty()) {
      const std::size_t comma = std::min(value.find(','), value.size());
      const std::string option = lower_case(trimmed(value.substr(0, comma)));
      if (!option.empty() && !is_token(option)) return bad("the Connection field is not a list of options");
      close_ = close_ || option == "close";
      stay_ = stay_ || option == "keep-alive";
      value.remove_prefix(std::min(comma + 1, value.size()));
    }
    return std::nullopt;
  }

  /// What can be judged only when every line has been seen.
  std::optional<Refusal> conclude() {
    if (head_.minor == 1 && !host_) return bad("the request has no Host");
    if (authority_ && host_ && *authority_ != *host_)
      return bad("the Host and the request target name different hosts");
    if (head_.chunked && head_.minor == 0) return bad("an HTTP/1.0 request cannot be chunked");
    if (head_.chunked && head_.content_length)
      return bad("the request has both a Transfer-Encoding and a Content-Length");
    head_.keep_alive = !close_ && (head_.minor == 1 || stay_);
    if (head_.minor == 0) head_.expects_continue = false;
    return std::nullopt;
  }

  const HeadLimits& limits_;
  Head head_;
  std::size_t fields_ = 0;
  std::optional<std::string> host_;
  std::optional<std::string> authority_;
  bool close_ = false;
  bool stay_ = false;
};

}  // namespace

std::size_t find_head_end(std::string_view text, std::size_t from) {
  for (std::size_t i = text.find('\n', from); i != std::string_view::npos; i = text.find('\n', i + 1)) {
    if (text.substr(i + 1, 1) == "\n") return i + 2;
    if (text.substr(i + 1, 2) == "\r\n") return i + 3;
  }
  return std::string_view::npos;
}

bool is_token(std::string_view text) {
  return !text.empty() && consists_of(text, kTokenSymbols);
}

bool is_field_line(std::string_view line) {
  const std::size_t colon = line.find(':');
  return colon != std::string_view::npos && is_token(line.substr(0, colon)) &&
         is_field_value(line.substr(colon + 1));
}

std::variant<Head, Refusal> read_head(std::string_view raw, const HeadLimits& limits) {
  return HeadReader(limits).read(raw);
}

}  // namespace server::http
