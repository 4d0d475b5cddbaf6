#include "server/http/router.h"

#include <algorithm>

#include "tin/base/check.h"

namespace server::http {

bool Router::Piece::operator==(const Piece& other) const {
  return prefix == other.prefix && suffix == other.suffix && name.empty() == other.name.empty();
}

Router::Pattern Router::compile(std::string_view pattern) {
  TIN_CHECK(pattern.starts_with('/'));
  Pattern pieces;
  while (!pattern.empty()) {
    pattern.remove_prefix(1);  // the slash
    const std::size_t end = std::min(pattern.find('/'), pattern.size());
    const std::string_view segment = pattern.substr(0, end);
    pattern.remove_prefix(end);
    Piece piece;
    const std::size_t open = segment.find('{');
    piece.prefix = segment.substr(0, open);
    if (open != std::string_view::npos) {
      const std::size_t close = segment.find('}', open);
      TIN_CHECK(close != std::string_view::npos && close > open + 1);
      piece.name = segment.substr(open + 1, close - open - 1);
      piece.suffix = segment.substr(close + 1);
      TIN_CHECK(piece.suffix.find('{') == std::string::npos);
    }
    pieces.push_back(std::move(piece));
  }
  return pieces;
}

void Router::add(Route route) {
  TIN_CHECK(route.method != Method::kHead && route.method != Method::kOptions);
  TIN_CHECK(route.handler != nullptr);
  Pattern pattern = compile(route.pattern);
  for (std::size_t i = 0; i < routes_.size(); ++i) {
    TIN_CHECK(routes_[i].method != route.method || !(patterns_[i] == pattern));
  }
  routes_.push_back(std::move(route));
  patterns_.push_back(std::move(pattern));
}

bool Router::fits(const Piece& piece, std::string_view segment) {
  if (piece.name.empty()) return segment == piece.prefix;
  return segment.size() > piece.prefix.size() + piece.suffix.size() && segment.starts_with(piece.prefix) &&
         segment.ends_with(piece.suffix);
}

bool Router::fits(const Pattern& pattern, const std::vector<std::string>& segments) {
  return std::equal(pattern.begin(), pattern.end(), segments.begin(), segments.end(),
                    [](const Piece& piece, const std::string& segment) { return fits(piece, segment); });
}

bool Router::more_literal(const Pattern& a, const Pattern& b) {
  for (std::size_t i = 0; i < a.size() && i < b.size(); ++i) {
    if (a[i].name.empty() != b[i].name.empty()) return a[i].name.empty();
    const std::size_t fixed_a = a[i].prefix.size() + a[i].suffix.size();
    const std::size_t fixed_b = b[i].prefix.size() + b[i].suffix.size();
    if (fixed_a != fixed_b) return fixed_a > fixed_b;
  }
  return false;
}

RouteMatch Router::match(Method method, const std::vector<std::string>& segments) const {
  const Method served = method == Method::kHead ? Method::kGet : method;
  RouteMatch match;
  const Pattern* best = nullptr;
  for (std::size_t i = 0; i < routes_.size(); ++i) {
    if (!fits(patterns_[i], segments)) continue;
    match.allowed.push_back(routes_[i].method);
    if (routes_[i].method != served || (best != nullptr && !more_literal(patterns_[i], *best))) continue;
    best = &patterns_[i];
    match.route = &routes_[i];
  }
  if (match.allowed.empty()) return match;
  if (std::find(match.allowed.begin(), match.allowed.end(), Method::kGet) != match.allowed.end()) {
    match.allowed.push_back(Method::kHead);
  }
  match.allowed.push_back(Method::kOptions);
  std::sort(match.allowed.begin(), match.allowed.end());
  match.allowed.erase(std::unique(match.allowed.begin(), match.allowed.end()), match.allowed.end());
  if (best == nullptr) return match;
  for (std::size_t i = 0; i < best->size(); ++i) {
    const Piece& piece = (*best)[i];
    if (piece.name.empty()) continue;
    const std::size_t length = segments[i].size() - piece.prefix.size() - piece.suffix.size();
    match.path_parameters[piece.name] = segments[i].substr(piece.prefix.size(), length);
  }
  return match;
}

tin::base::Result<void> check_query(const Route& route, const NamedValues& query) {
  for (auto it = query.begin(); it != query.end(); ++it) {
    const std::string& name = it->first;
    if (std::find(route.query.begin(), route.query.end(), name) == route.query.end()) {
      return tin::base::error(tin::base::Code::kUnknownParameter,
                              "this resource has no query parameter \"" + name + "\"", "query:" + name);
    }
    if (std::any_of(query.begin(), it, [&](const auto& earlier) { return earlier.first == name; })) {
      return tin::base::error(tin::base::Code::kMalformed,
                              "the query parameter \"" + name + "\" is given more than once",
                              "query:" + name);
    }
  }
  return {};
}

std::string allow_list(const std::vector<Method>& methods) {
  std::string list;
  for (const Method method : methods) {
    if (!list.empty()) list += ", ";
    list += method_name(method);
  }
  return list;
}

}  // namespace server::http
