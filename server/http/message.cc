#include "server/http/message.h"

#include <algorithm>
#include <array>

namespace server::http {
namespace {

constexpr std::array<std::pair<Method, std::string_view>, 7> kMethods = {{{Method::kGet, "GET"},
                                                                          {Method::kHead, "HEAD"},
                                                                          {Method::kPost, "POST"},
                                                                          {Method::kPut, "PUT"},
                                                                          {Method::kPatch, "PATCH"},
                                                                          {Method::kDelete, "DELETE"},
                                                                          {Method::kOptions, "OPTIONS"}}};

const std::string* find_value(const NamedValues& values, std::string_view name) {
  const auto found =
      std::find_if(values.begin(), values.end(), [&](const auto& v) { return v.first == name; });
  return found == values.end() ? nullptr : &found->second;
}

}  // namespace

std::string_view method_name(Method method) {
  for (const auto& [value, name] : kMethods) {
    if (value == method) return name;
  }
  return {};
}

std::optional<Method> method_named(std::string_view name) {
  for (const auto& [value, its_name] : kMethods) {
    if (its_name == name) return value;
  }
  return std::nullopt;
}

std::optional<std::string> Request::query_value(std::string_view name) const {
  const std::string* value = find_value(query, name);
  if (value == nullptr) return std::nullopt;
  return *value;
}

std::string_view Request::header(std::string_view lower_name) const {
  const std::string* value = find_value(headers, lower_name);
  return value == nullptr ? std::string_view() : std::string_view(*value);
}

std::string_view Request::path_parameter(std::string_view name) const {
  const auto found = path_parameters.find(name);
  return found == path_parameters.end() ? std::string_view() : std::string_view(found->second);
}

std::filesystem::path Request::release_body_file() {
  return std::exchange(body_file, {});
}

std::string lower_case(std::string_view text) {
  std::string lower(text);
  for (char& c : lower) {
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  }
  return lower;
}

}  // namespace server::http
