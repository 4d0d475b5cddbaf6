#include "server/http/admission.h"

#include <new>

#include "server/http/url.h"

namespace server::http {
namespace {

constexpr std::string_view kRequestFields =
    "Accept, Authorization, Content-Disposition, Content-Type, Idempotency-Key, If-Match, "
    "If-None-Match, Last-Event-ID, Prefer";

Response describe_options(const std::vector<Method>& allowed) {
  Response response;
  response.status = 204;
  response.headers = {{"Allow", allow_list(allowed)},
                      {"Access-Control-Allow-Methods", allow_list(allowed)},
                      {"Access-Control-Allow-Headers", std::string(kRequestFields)},
                      {"Access-Control-Max-Age", "86400"}};
  return response;
}

bool wants_file(BodyKind kind, const Request& request) {
  if (kind != BodyKind::kByType) return kind == BodyKind::kFile;
  std::string_view type = request.header("content-type");
  type = type.substr(0, type.find(';'));
  type = type.substr(0, type.find_last_not_of(" \t") + 1);
  return lower_case(type) != "application/json";
}

std::optional<Response> check_body(const Head& head, Admission& admission, const ErrorPages& pages,
                                   const ServerOptions& options) {
  const Route& route = *admission.route;
  if (route.body == BodyKind::kNone) {
    if (head.has_body()) return pages.status(400, "this resource takes no request body with this method");
    return std::nullopt;
  }
  admission.to_file = wants_file(route.body, admission.request);
  const std::uint64_t general = admission.to_file ? options.file_body_limit : options.memory_body_limit;
  // With kByType the route's own limit is one for files: JSON keeps to what memory allows.
  const bool own = route.body_limit != 0 && (admission.to_file || route.body != BodyKind::kByType);
  admission.body_limit = own ? route.body_limit : general;
  if (head.content_length.value_or(0) > admission.body_limit) return too_large(pages, admission.body_limit);
  return std::nullopt;
}

}  // namespace

Admission admit(Head& head, std::string request_id, const Router& router, const ErrorPages& pages,
                const ServerOptions& options) {
  Admission admission;
  Request& request = admission.request;
  request.id = std::move(request_id);
  request.method = head.method;
  request.headers = std::move(head.headers);
  std::optional<Target> target = parse_target(head.target);
  if (!target) {
    admission.answer =
        pages.status(400, "the request target is not a path and query in valid percent-encoded UTF-8");
    return admission;
  }
  request.path = std::move(target->path);
  request.query = std::move(target->query);
  RouteMatch match = router.match(head.method, target->segments);
  admission.route = match.route;
  request.path_parameters = std::move(match.path_parameters);
  if (match.allowed.empty()) {
    admission.answer =
        pages.error(tin::base::error(tin::base::Code::kNotFound, "there is nothing at this path"));
  } else if (head.method == Method::kOptions) {
    admission.answer = describe_options(match.allowed);
  } else if (match.route == nullptr) {
    admission.answer =
        pages.status(405, "this resource does not know the method " + std::string(method_name(head.method)));
    admission.answer->headers.emplace_back("Allow", allow_list(match.allowed));
  } else if (const auto known = check_query(*match.route, request.query); !known) {
    admission.answer = pages.error(known.error());
  } else {
    admission.answer = check_body(head, admission, pages, options);
  }
  return admission;
}

Response too_large(const ErrorPages& pages, std::uint64_t limit) {
  return pages.error(tin::base::error(
      tin::base::Code::kTooLarge,
      "the request body is larger than the " + std::to_string(limit) + " bytes allowed here"));
}

Response call_handler(const Route& route, Request& request, const ErrorPages& pages,
                      const Observer& observer) {
  std::string problem;
  int status = 500;
  try {
    return route.handler(request);
  } catch (const std::bad_alloc&) {
    status = 503;
    problem = "out of memory";
  } catch (const std::exception& e) {
    problem = e.what();
  } catch (...) {
    problem = "an exception of unknown type";
  }
  if (observer.problem) observer.problem(request.id, "handler of " + route.pattern + ": " + problem);
  return pages.status(status, status == 503 ? "the server lacks the memory for this request at the moment"
                                            : "the server failed to handle this request");
}

}  // namespace server::http
