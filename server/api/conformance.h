// The OGC conformance classes that are met, and no others. tests/contract/ogc_test.cc goes through their requirements.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "server/api/links.h"

namespace server::api {

inline constexpr std::string_view kOpenApiType = "application/vnd.oai.openapi+json;version=3.0";

/// Of the server at its root: Common and Processes.
std::span<const std::string> server_conformance();
/// Of each TIN as a service: Common and Features, and EDR where there is a surface with a place on the globe,
/// since each of its collections must have an extent.
std::span<const std::string> tin_conformance(bool has_surface);

/// The classes for people, each a link.
HtmlPage conformance_page(std::span<const std::string> classes);

}  // namespace server::api
