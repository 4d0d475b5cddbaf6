#include "server/http/url.h"

#include <algorithm>
#include <cstdint>

namespace server::http {
namespace {

int hex_digit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return -1;
}

bool has_control(std::string_view text) {
  return std::any_of(text.begin(), text.end(), [](char c) {
    const auto byte = static_cast<unsigned char>(c);
    return byte < 0x20 || byte == 0x7f;
  });
}

std::optional<std::string> decode_checked(std::string_view text, bool plus_is_space) {
  std::optional<std::string> decoded = percent_decode(text, plus_is_space);
  if (decoded && !valid_utf8(*decoded)) decoded.reset();
  return decoded;
}

bool parse_path(std::string_view path, Target& target) {
  if (path.empty() || path.front() != '/') return false;
  path.remove_prefix(1);
  while (true) {
    const std::size_t slash = path.find('/');
    std::optional<std::string> segment = decode_checked(path.substr(0, slash), false);
    if (!segment || has_control(*segment) || *segment == "." || *segment == "..") return false;
    target.path += '/';
    target.path += *segment;
    target.segments.push_back(std::move(*segment));
    if (slash == std::string_view::npos) return true;
    path.remove_prefix(slash + 1);
  }
}

bool parse_query(std::string_view query, Target& target) {
  while (!query.empty()) {
    const std::size_t end = std::min(query.find('&'), query.size());
    const std::string_view pair = query.substr(0, end);
    query.remove_prefix(std::min(end + 1, query.size()));
    if (pair.empty()) continue;
    const std::size_t equals = std::min(pair.find('='), pair.size());
    auto name = decode_checked(pair.substr(0, equals), true);
    auto value = decode_checked(pair.substr(std::min(equals + 1, pair.size())), true);
    if (!name || !value) return false;
    if (name->find('\0') != std::string::npos || value->find('\0') != std::string::npos) return false;
    target.query.emplace_back(std::move(*name), std::move(*value));
  }
  return true;
}

}  // namespace

std::optional<std::string> percent_decode(std::string_view text, bool plus_is_space) {
  std::string decoded;
  decoded.reserve(text.size());
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '+' && plus_is_space) {
      decoded += ' ';
    } else if (text[i] != '%') {
      decoded += text[i];
    } else {
      if (i + 2 >= text.size()) return std::nullopt;
      const int high = hex_digit(text[i + 1]);
      const int low = hex_digit(text[i + 2]);
      if (high < 0 || low < 0) return std::nullopt;
      decoded += static_cast<char>(high * 16 + low);
      i += 2;
    }
  }
  return decoded;
}

bool valid_utf8(std::string_view text) {
  std::size_t i = 0;
  while (i < text.size()) {
    const auto lead = static_cast<unsigned char>(text[i++]);
    if (lead < 0x80) continue;
    const int trailing = lead >= 0xf0 ? 3 : lead >= 0xe0 ? 2 : 1;
    if (lead < 0xc2 || lead > 0xf4) return false;
    std::uint32_t code_point = lead & (0x3fU >> trailing);
    for (int k = 0; k < trailing; ++k) {
      if (i == text.size()) return false;
      const auto byte = static_cast<unsigned char>(text[i++]);
      if ((byte & 0xc0) != 0x80) return false;
      code_point = (code_point << 6) | (byte & 0x3fU);
    }
    if (trailing == 2 && code_point < 0x800) return false;
    if (trailing == 3 && (code_point < 0x10000 || code_point > 0x10ffff)) return false;
    if (code_point >= 0xd800 && code_point <= 0xdfff) return false;
  }
  return true;
}

std::optional<Target> parse_target(std::string_view text) {
  if (text.find('#') != std::string_view::npos) return std::nullopt;
  const std::size_t mark = std::min(text.find('?'), text.size());
  Target target;
  if (!parse_path(text.substr(0, mark), target)) return std::nullopt;
  if (!parse_query(text.substr(std::min(mark + 1, text.size())), target)) return std::nullopt;
  return target;
}

}  // namespace server::http
