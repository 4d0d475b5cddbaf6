// From a head to a decision, before any byte of the body is read: which handler, how much body and where to,
// or an answer at once. And the call of the handler, which lets no exception out. Knows no sockets.
#pragma once

#include <cstdint>
#include <optional>

#include "server/http/framing.h"
#include "server/http/options.h"
#include "server/http/router.h"

namespace server::http {

struct Admission {
  Request request;
  const Route* route = nullptr;  // also set for some refusals, for whoever counts them
  bool to_file = false;          // the body goes to a file
  std::uint64_t body_limit = 0;
  std::optional<Response> answer;  // set: the request goes no further
};

/// Decides on `head` by the routes and the limits.
Admission admit(Head& head, std::string request_id, const Router& router, const ErrorPages& pages,
                const ServerOptions& options);

/// The answer to a body of more than `limit` bytes.
Response too_large(const ErrorPages& pages, std::uint64_t limit);

/// Calls the handler. An exception becomes a 503 (no memory) or a 500, and its text goes to the observer.
Response call_handler(const Route& route, Request& request, const ErrorPages& pages,
                      const Observer& observer);

/// Calls the quick handler, if there is one; its exceptions mean that it does not answer.
std::optional<Response> call_quick_handler(const Route& route, Request& request);

}  // namespace server::http
