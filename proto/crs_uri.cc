#include "proto/crs_uri.h"

#include <algorithm>
#include <cctype>

namespace proto {

using tin::base::Code;
using tin::base::error;
using tin::base::Result;

namespace {

constexpr std::string_view kEpsg = "EPSG:";
constexpr std::size_t kMaxDigits = 9;

std::string lower(std::string_view text) {
  std::string result(text);
  std::transform(result.begin(), result.end(), result.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return result;
}

bool take_prefix(std::string_view& text, std::string_view prefix) {
  if (!text.starts_with(prefix)) return false;
  text.remove_prefix(prefix.size());
  return true;
}

bool is_code(std::string_view text) {
  return !text.empty() && text.size() <= kMaxDigits && text.front() != '0' &&
         std::all_of(text.begin(), text.end(), [](char c) { return c >= '0' && c <= '9'; });
}

/// What follows the authority is "version<separator>code"; the version may be empty in a URN.
std::string_view skip_version(std::string_view text, char separator) {
  const std::size_t at = text.find(separator);
  return at == std::string_view::npos ? std::string_view() : text.substr(at + 1);
}

/// "epsg:n" or "ogc:crs84" of any form in lower case; empty when it is none.
std::string short_form(std::string_view text) {
  for (const std::string_view scheme :
       {"http://www.opengis.net/def/crs/", "https://www.opengis.net/def/crs/"}) {
    if (!take_prefix(text, scheme)) continue;
    if (take_prefix(text, "epsg/")) return "epsg:" + std::string(skip_version(text, '/'));
    if (take_prefix(text, "ogc/")) return "ogc:" + std::string(skip_version(text, '/'));
    return {};
  }
  for (const std::string_view urn : {"urn:ogc:def:crs:", "urn:x-ogc:def:crs:"}) {
    if (!take_prefix(text, urn)) continue;
    if (take_prefix(text, "epsg:")) return "epsg:" + std::string(skip_version(text, ':'));
    if (take_prefix(text, "ogc:")) return "ogc:" + std::string(skip_version(text, ':'));
    return {};
  }
  return std::string(text);
}

}  // namespace

Result<std::string> parse_crs(std::string_view text, std::string where) {
  const std::string name = short_form(lower(text));
  if (name == "ogc:crs84") return std::string(kCrs84);
  std::string_view code = name;
  if (take_prefix(code, "epsg:") && is_code(code)) return std::string(kEpsg) + std::string(code);
  return error(Code::kMalformed,
               "a CRS is named EPSG:n, http://www.opengis.net/def/crs/EPSG/0/n or urn:ogc:def:crs:EPSG::n",
               std::move(where));
}

std::optional<std::string> crs_uri(std::string_view name) {
  if (name == kCrs84) return std::string(kCrs84Uri);
  if (!take_prefix(name, kEpsg) || !is_code(name)) return std::nullopt;
  return "http://www.opengis.net/def/crs/EPSG/0/" + std::string(name);
}

std::optional<std::string> crs_urn(std::string_view name) {
  if (name == kCrs84) return "urn:ogc:def:crs:OGC:1.3:CRS84";
  if (!take_prefix(name, kEpsg) || !is_code(name)) return std::nullopt;
  return "urn:ogc:def:crs:EPSG::" + std::string(name);
}

}  // namespace proto
