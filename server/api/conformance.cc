#include "server/api/conformance.h"

#include <array>

namespace server::api {

std::span<const std::string> server_conformance() {
  static const std::array<std::string, 10> classes{
      "http://www.opengis.net/spec/ogcapi-common-1/1.0/conf/core",
      "http://www.opengis.net/spec/ogcapi-common-1/1.0/conf/landing-page",
      "http://www.opengis.net/spec/ogcapi-common-1/1.0/conf/json",
      "http://www.opengis.net/spec/ogcapi-common-1/1.0/conf/oas30",
      "http://www.opengis.net/spec/ogcapi-processes-1/1.0/conf/core",
      "http://www.opengis.net/spec/ogcapi-processes-1/1.0/conf/ogc-process-description",
      "http://www.opengis.net/spec/ogcapi-processes-1/1.0/conf/json",
      "http://www.opengis.net/spec/ogcapi-processes-1/1.0/conf/oas30",
      "http://www.opengis.net/spec/ogcapi-processes-1/1.0/conf/job-list",
      "http://www.opengis.net/spec/ogcapi-processes-1/1.0/conf/dismiss",
  };
  return classes;
}

HtmlPage conformance_page(std::span<const std::string> classes) {
  HtmlPage page{"What this service conforms to", "", {}, {}, {}, {}};
  for (const std::string& name : classes) page.links.push_back({name, name, "", ""});
  return page;
}

std::span<const std::string> tin_conformance(bool has_surface) {
  constexpr std::size_t kOfEdr = 7;  // the last ones
  static const std::array<std::string, 20> classes{
      "http://www.opengis.net/spec/ogcapi-common-1/1.0/conf/core",
      "http://www.opengis.net/spec/ogcapi-common-1/1.0/conf/landing-page",
      "http://www.opengis.net/spec/ogcapi-common-1/1.0/conf/json",
      "http://www.opengis.net/spec/ogcapi-common-1/1.0/conf/oas30",
      "http://www.opengis.net/spec/ogcapi-common-2/1.0/conf/collections",
      "http://www.opengis.net/spec/ogcapi-features-1/1.0/conf/core",
      "http://www.opengis.net/spec/ogcapi-features-1/1.0/conf/geojson",
      "http://www.opengis.net/spec/ogcapi-features-1/1.0/conf/oas30",
      "http://www.opengis.net/spec/ogcapi-features-2/1.0/conf/crs",
      "http://www.opengis.net/spec/ogcapi-features-4/1.0/conf/create-replace-delete",
      "http://www.opengis.net/spec/ogcapi-features-4/1.0/conf/update",
      "http://www.opengis.net/spec/ogcapi-features-4/1.0/conf/optimistic-locking-etags",
      "http://www.opengis.net/spec/ogcapi-features-4/1.0/conf/features",
      "http://www.opengis.net/spec/ogcapi-edr-1/1.1/conf/core",
      "http://www.opengis.net/spec/ogcapi-edr-1/1.1/conf/collections",
      "http://www.opengis.net/spec/ogcapi-edr-1/1.1/conf/json",
      "http://www.opengis.net/spec/ogcapi-edr-1/1.1/conf/geojson",
      "http://www.opengis.net/spec/ogcapi-edr-1/1.1/conf/covjson",
      "http://www.opengis.net/spec/ogcapi-edr-1/1.1/conf/queries",
      "http://www.opengis.net/spec/ogcapi-edr-1/1.1/conf/oas30",
  };
  return std::span(classes).first(has_surface ? classes.size() : classes.size() - kOfEdr);
}

}  // namespace server::api
