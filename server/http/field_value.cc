#include "server/http/field_value.h"

#include <algorithm>
#include <charconv>

#include "server/http/message.h"

namespace server::http {
namespace {

/// The part of `rest` before the next separator, which is taken off with it.
std::string_view next(std::string_view& rest, char separator) {
  const std::size_t end = std::min(rest.find(separator), rest.size());
  const std::string_view part = rest.substr(0, end);
  rest.remove_prefix(std::min(end + 1, rest.size()));
  return trimmed(part);
}

/// Of "0.5"; nothing if it is malformed.
std::optional<double> weight_of(std::string_view text) {
  double weight = 0;
  const char* const all = text.data() + text.size();
  const auto [end, failure] = std::from_chars(text.data(), all, weight, std::chars_format::fixed);
  if (failure != std::errc() || end != all || !(weight >= 0 && weight <= 1)) return std::nullopt;
  return weight;
}

/// How closely a range names a type: 3 the type itself, 2 its kind, 1 anything, 0 not at all.
int closeness(std::string_view range, std::string_view type) {
  if (range == type) return 3;
  if (range == "*/*") return 1;
  const bool kind = range.ends_with("/*") && type.starts_with(range.substr(0, range.size() - 1));
  return kind ? 2 : 0;
}

/// By the closest range; 0: not wanted.
double weight_in(const std::vector<Preference>& accepted, std::string_view type) {
  int closest = 0;
  double weight = 0;
  for (const Preference& range : accepted) {
    const int close = closeness(range.name, type);
    if (close <= closest) continue;
    closest = close;
    weight = range.weight;
  }
  return weight;
}

}  // namespace

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && (text.front() == ' ' || text.front() == '\t')) text.remove_prefix(1);
  while (!text.empty() && (text.back() == ' ' || text.back() == '\t')) text.remove_suffix(1);
  return text;
}

std::optional<std::vector<Preference>> parse_preferences(std::string_view field) {
  std::vector<Preference> items;
  while (!field.empty()) {
    std::string_view item = next(field, ',');
    if (item.empty()) continue;
    Preference preference{lower_case(next(item, ';')), 1};
    while (!item.empty()) {
      const std::string_view parameter = next(item, ';');
      if (!parameter.starts_with("q=") && !parameter.starts_with("Q=")) continue;
      const auto weight = weight_of(parameter.substr(2));
      if (!weight) return std::nullopt;
      preference.weight = *weight;
    }
    items.push_back(std::move(preference));
  }
  return items;
}

bool prefers(std::string_view accept, std::string_view type, std::string_view other) {
  const auto accepted = parse_preferences(accept);
  if (!accepted) return false;
  const double weight = weight_in(*accepted, type), of_other = weight_in(*accepted, other);
  if (weight != of_other || weight == 0) return weight > of_other;
  const auto named = [&](std::string_view name) {
    return std::find_if(accepted->begin(), accepted->end(),
                        [&](const Preference& p) { return p.name == name; });
  };
  return named(type) < named(other);
}

}  // namespace server::http
