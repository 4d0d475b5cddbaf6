// The table of routes, and the choice of one for a request.
//
//   Router router;
//   router.add({.method = Method::kGet, .pattern = "/tins/{tin}", .query = {"crs"}, .handler = show});
//   router.add({.method = Method::kGet, .pattern = "/dem/{z}/{x}/{y}.png", .handler = tile});
//
// A segment of a pattern is literal, or holds one parameter with literal text around it. Where several
// patterns fit a path, the leftmost segment in which one is more literal decides. HEAD is served by GET
// routes, OPTIONS by the server.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "server/http/message.h"
#include "tin/base/result.h"

namespace server::http {

enum class BodyKind {
  kNone,    // a body is refused
  kMemory,  // Request::body
  kFile,    // Request::body_file
  kByType,  // application/json in memory, anything else as a file
};

/// What a client must be allowed to do.
enum class Need {
  kByMethod,  // to read for GET and HEAD, else to write
  kNothing,
  kRead,
  kWrite,
};

struct Route {
  Method method = Method::kGet;
  std::string pattern;                  // "/tins/{tin}/edits"
  std::vector<std::string> query = {};  // the parameters that the resource knows
  BodyKind body = BodyKind::kNone;
  std::uint64_t body_limit = 0;  // bytes; 0: the server's own limit for that kind of body
  Need need = Need::kByMethod;
  Handler handler;
  QuickHandler quick = {};  // tried first; may be empty
};

/// What the router says about a method and a path.
struct RouteMatch {
  const Route* route = nullptr;                                     // the route, if there is one
  std::map<std::string, std::string, std::less<>> path_parameters;  // of that route
  std::vector<Method> allowed;  // every method the path has, HEAD and OPTIONS too; empty: no such path
};

/// Threads: add() first, from one thread; then any number of readers.
class Router {
 public:
  /// Requires: a pattern that begins with a slash and has no empty name; no HEAD or OPTIONS; a handler;
  ///           no route of the same method and the same shape before.
  void add(Route route);

  /// Every route, in the order of adding.
  const std::vector<Route>& routes() const { return routes_; }

  /// `segments` are the path's parts, decoded ("/" has one, empty).
  RouteMatch match(Method method, const std::vector<std::string>& segments) const;

 private:
  struct Piece {
    std::string prefix;  // the whole of a literal segment
    std::string name;    // empty: literal
    std::string suffix;
    bool operator==(const Piece& other) const;
  };
  using Pattern = std::vector<Piece>;

  static Pattern compile(std::string_view pattern);
  static bool fits(const Piece& piece, std::string_view segment);
  static bool fits(const Pattern& pattern, const std::vector<std::string>& segments);
  static bool more_literal(const Pattern& a, const Pattern& b);

  std::vector<Route> routes_;
  std::vector<Pattern> patterns_;  // of the route with the same index
};

/// Checks that each query parameter is one that `route` knows and stands there once.
///
/// Errors: kUnknownParameter, kMalformed; `where` is "query:NAME".
tin::base::Result<void> check_query(const Route& route, const NamedValues& query);

/// "GET, HEAD, OPTIONS" for an Allow field.
std::string allow_list(const std::vector<Method>& methods);

}  // namespace server::http
