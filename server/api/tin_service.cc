// What makes each TIN an OGC API of its own, at /tins/{tin}: its conformance and its contract. The landing page is the TIN's
// document (tins.cc).
#include "proto/messages.h"
#include "proto/openapi.h"
#include "server/api/conformance.h"
#include "server/api/coverage.h"
#include "server/api/links.h"
#include "server/api/routes.h"

namespace server::api {
namespace {

Result<Response> conformance(Context& context, const Request& request) {
  const auto tin = context.catalogue.find(request.path_parameter("tin"));
  if (!tin) return tin.error();
  const auto classes = tin_conformance(has_surface((*tin)->summary()));
  return negotiated(request, proto::conformance_json(classes), kJson, conformance_page(classes));
}

Result<Response> api(Context& context, const Request& request) {
  const auto tin = context.catalogue.find(request.path_parameter("tin"));
  if (!tin) return tin.error();
  return Response{200,
                  {{"Content-Type", std::string(kOpenApiType)}},
                  proto::tin_openapi_json(base_url(context.config, request) + "/tins/" + (*tin)->id())};
}

}  // namespace

void add_tin_service(http::Router& router, Context& context) {
  using http::Method;
  const auto on = [&context](auto f) {
    return guarded([&context, f](Request& request) { return f(context, request); });
  };
  router.add({.method = Method::kGet, .pattern = "/tins/{tin}/conformance", .handler = on(conformance)});
  router.add({.method = Method::kGet, .pattern = "/tins/{tin}/api", .handler = on(api)});
}

}  // namespace server::api
