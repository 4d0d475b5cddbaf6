// The landing page, the contract and conformance.
#include "proto/messages.h"
#include "proto/openapi.h"
#include "server/api/answer.h"
#include "server/api/conformance.h"
#include "server/api/links.h"
#include "server/api/routes.h"
#include "server/web/pages.h"

namespace server::api {
namespace {

Result<Response> landing(const Request& request) {
  if (wants_html(request)) {
    return Response{200,
                    {{"Content-Type", "text/html; charset=utf-8"}, {"Vary", "Accept"}},
                    std::string(web::index_html())};
  }
  proto::Landing page{
      "Tinsmith",
      "A server for adaptive terrain TINs: canonical Delaunay triangulations that are edited while they are "
      "served.",
      {{"/", "self", std::string(kJson), "This document"},
       {"/", "alternate", "text/html", "The terrains in a browser"},
       {"/api", "service-desc", std::string(kOpenApiType), "The contract (OpenAPI 3.0)"},
       {"/conformance", "conformance", std::string(kJson), "Conformance classes"},
       {"/tins", "items", std::string(kJson), "The TINs"},
       {"/processes", "http://www.opengis.net/def/rel/ogc/1.0/processes", std::string(kJson), "Processes"},
       {"/jobs", "http://www.opengis.net/def/rel/ogc/1.0/job-list", std::string(kJson), "Jobs"}}};
  Response response = json_answer(proto::landing_json(page));
  response.headers.emplace_back("Vary", "Accept");
  return response;
}

Result<Response> conformance(const Request& request) {
  return negotiated(request, proto::conformance_json(server_conformance()), kJson,
                    conformance_page(server_conformance()));
}

}  // namespace

void add_landing(http::Router& router) {
  router.add({.method = http::Method::kGet,
              .pattern = "/",
              .need = http::Need::kNothing,
              .handler = guarded(landing)});
  router.add({.method = http::Method::kGet,
              .pattern = "/conformance",
              .need = http::Need::kNothing,
              .handler = guarded(conformance)});
  router.add({.method = http::Method::kGet,
              .pattern = "/api",
              .need = http::Need::kNothing,
              .handler = guarded([](Request&) -> Result<Response> {
                return Response{
                    200, {{"Content-Type", std::string(kOpenApiType)}}, std::string(proto::openapi_json())};
              })});
}

}  // namespace server::api
