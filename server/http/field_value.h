// Values of header fields; above all what a client would rather have (RFC 9110, 12.5).
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace server::http {

/// Without spaces and tabs at both ends.
std::string_view trimmed(std::string_view text);

/// One item of Accept or Accept-Encoding.
struct Preference {
  std::string name;  // in lower case: "text/html", "text/*", "gzip"; parameters but the weight left out
  double weight = 1;
};

/// The items in their order. Nothing if one of them bears a malformed weight.
std::optional<std::vector<Preference>> parse_preferences(std::string_view field);

/// Whether the field Accept asks for the media type `type` before `other` (both in lower case): by weight,
/// then by which of them it names first. The range that names a type most closely gives its weight. False
/// where the field is malformed or names neither of them.
bool prefers(std::string_view accept, std::string_view type, std::string_view other);

}  // namespace server::http
