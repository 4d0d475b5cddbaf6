#include "server/api/feature_tag.h"

#include <bit>

#include "server/api/links.h"

namespace server::api {
namespace {

class Hash {
 public:
  void add(std::uint64_t value) {
    for (int i = 0; i < 8; ++i) state_ = (state_ ^ (value >> (8 * i) & 0xff)) * 0x100000001b3ULL;
  }
  void add(std::string_view text) {
    for (const char c : text) state_ = (state_ ^ static_cast<unsigned char>(c)) * 0x100000001b3ULL;
  }
  std::string text() const {
    std::string digits;
    for (int i = 60; i >= 0; i -= 4) digits += "0123456789abcdef"[state_ >> i & 15];
    return digits;
  }

 private:
  std::uint64_t state_ = 0xcbf29ce484222325ULL;  // FNV-1a
};

/// `"created-state-`: what is the same for all ways to show a feature.
std::string prefix(const app::Tin& tin, const Feature& feature) {
  Hash state;
  for (const proto::VertexId id : feature.ids) state.add(id.value());
  for (const proto::Position& corner : feature.corners) {
    for (const double value : {corner.x, corner.y, corner.z}) state.add(std::bit_cast<std::uint64_t>(value));
  }
  state.add(static_cast<std::uint64_t>(feature.hull));
  return "\"" + std::to_string(tin.created_ms()) + "-f" + state.text() + "-";
}

}  // namespace

std::string feature_tag(const app::Tin& tin, const Feature& feature, const Request& request) {
  Hash shown;
  shown.add(request.query_value("crs").value_or(""));
  shown.add(wants_html(request) ? "html" : "json");
  return prefix(tin, feature) + shown.text() + "\"";
}

bool matches(std::string_view if_match, const app::Tin& tin, const Feature& feature) {
  if (if_match == "*") return true;
  const std::string wanted = prefix(tin, feature);
  while (!if_match.empty()) {
    const auto comma = std::min(if_match.find(','), if_match.size());
    std::string_view tag = if_match.substr(0, comma);
    if_match.remove_prefix(std::min(comma + 1, if_match.size()));
    while (tag.starts_with(' ') || tag.starts_with('\t')) tag.remove_prefix(1);
    if (tag.starts_with(wanted)) return true;
  }
  return false;
}

}  // namespace server::api
