#include "server/http/body_parser.h"

#include <algorithm>
#include <optional>

namespace server::http {
namespace {

constexpr int kMostDigits = 16;  // of 64 bits

int hex_digit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return -1;
}

constexpr std::size_t kMostExtensionBytes = 1024;  // of one chunk

std::string_view skip_blanks(std::string_view text) {
  return text.substr(std::min(text.find_first_not_of(" \t"), text.size()));
}

/// What is left of `text` behind the token at its front, or nothing if there is none.
std::optional<std::string_view> skip_token(std::string_view text) {
  std::size_t size = 0;
  while (size < text.size() && is_token(text.substr(size, 1))) ++size;
  if (size == 0) return std::nullopt;
  return text.substr(size);
}

/// The same for a quoted string, which must end.
std::optional<std::string_view> skip_quoted(std::string_view text) {
  for (std::size_t i = 1; i < text.size(); ++i) {
    const char c = text[i];
    if (c == '"') return text.substr(i + 1);
    if (c == '\\') ++i;
    if (c != '\t' && (c < 0x20 || c == 0x7f)) return std::nullopt;
  }
  return std::nullopt;
}

/// Whether `text` is what may follow the first semicolon of a chunk's line: `a;b=c;d="e"`.
bool is_extension(std::string_view text) {
  while (true) {
    auto rest = skip_token(skip_blanks(text));
    if (!rest) return false;
    text = skip_blanks(*rest);
    if (text.starts_with('=')) {
      text = skip_blanks(text.substr(1));
      rest = text.starts_with('"') ? skip_quoted(text) : skip_token(text);
      if (!rest) return false;
      text = skip_blanks(*rest);
    }
    if (text.empty()) return true;
    if (!text.starts_with(';')) return false;
    text.remove_prefix(1);
  }
}

}  // namespace

BodyParser::BodyParser(const Head& head)
    : chunked_(head.chunked),
      at_(head.chunked                          ? At::kSize
          : head.content_length.value_or(0) > 0 ? At::kData
                                                : At::kEnd),
      left_(head.content_length.value_or(0)) {}

void BodyParser::set_limits(std::uint64_t body_bytes, std::size_t framing_bytes) {
  body_left_ = body_bytes;
  framing_left_ = framing_bytes;
  if (!chunked_ && left_ > body_bytes) at_ = At::kTooLarge;
}

BodyParser::Step BodyParser::parse(std::string_view input, std::span<char> block) {
  Step step;
  while (at_ != At::kEnd && at_ != At::kBroken && at_ != At::kTooLarge && step.used < input.size()) {
    if (at_ != At::kData) {
      take_framing(input[step.used++]);
      continue;
    }
    const std::size_t room = block.size() - step.filled;
    if (room == 0) break;
    const auto count =
        static_cast<std::size_t>(std::min<std::uint64_t>(left_, std::min(room, input.size() - step.used)));
    std::copy_n(input.data() + step.used, count, block.data() + step.filled);
    step.used += count;
    step.filled += count;
    left_ -= count;
    if (left_ == 0) at_ = chunked_ ? At::kDataCr : At::kEnd;
  }
  step.state = at_ == At::kEnd            ? State::kDone
               : at_ == At::kTooLarge     ? State::kTooLarge
               : at_ == At::kBroken       ? State::kBroken
               : step.used < input.size() ? State::kAgain
                                          : State::kNeedMore;
  return step;
}

void BodyParser::take_framing(char c) {
  const auto expect = [&](char wanted, At next) { at_ = c == wanted ? next : At::kBroken; };
  switch (at_) {
    case At::kSize:
      return take_size(c);
    case At::kExtension:
      if (c == '\r') {
        at_ = is_extension(line_) ? At::kSizeLf : At::kBroken;
        line_.clear();
        return;
      }
      if (line_.size() == kMostExtensionBytes) at_ = At::kBroken;
      return take_of_line(c);
    case At::kSizeLf:
      if (c != '\n') {
        at_ = At::kBroken;
        return;
      }
      return end_size_line();
    case At::kDataCr:
      return expect('\r', At::kDataLf);
    case At::kDataLf:
      return expect('\n', At::kSize);
    case At::kTrailer:
      if (c == '\r') {
        at_ = At::kTrailerLf;
        return;
      }
      return take_of_line(c);
    case At::kTrailerLf:
      if (c != '\n') {
        at_ = At::kBroken;
        return;
      }
      return end_trailer_line();
    case At::kData:
    case At::kEnd:
    case At::kBroken:
    case At::kTooLarge:
      return;
  }
}

void BodyParser::take_of_line(char c) {
  if (at_ == At::kBroken || framing_left_ == 0 || c == '\n') {
    at_ = At::kBroken;
    return;
  }
  --framing_left_;
  line_ += c;
}

void BodyParser::take_size(char c) {
  const int digit = hex_digit(c);
  if (digit >= 0 && digits_ < kMostDigits) {
    left_ = left_ * 16 + static_cast<unsigned>(digit);
    ++digits_;
  } else if (digits_ > 0 && c == '\r') {
    at_ = At::kSizeLf;
  } else if (digits_ > 0 && c == ';') {
    at_ = At::kExtension;
  } else {
    at_ = At::kBroken;
  }
}

void BodyParser::end_size_line() {
  digits_ = 0;
  if (left_ > body_left_) {
    at_ = At::kTooLarge;
    return;
  }
  body_left_ -= left_;
  at_ = left_ > 0 ? At::kData : At::kTrailer;
}

/// The fields of a trailer are dropped: they could not be told from those of the head.
void BodyParser::end_trailer_line() {
  if (line_.empty()) {
    at_ = At::kEnd;
    return;
  }
  at_ = is_field_line(line_) ? At::kTrailer : At::kBroken;
  line_.clear();
}

}  // namespace server::http
