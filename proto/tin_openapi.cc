#include <nlohmann/json.hpp>

#include "proto/openapi.h"

namespace proto {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::string_view kTin = "/tins/{tin}";

/// The paths of a TIN without what stands before them, and without the parameter that names the TIN.
Json cut_to_tin() {
  Json document = Json::parse(openapi_json());
  Json paths = Json::object();
  for (const auto& [path, item] : document.at("paths").items()) {
    if (!path.starts_with(kTin)) continue;
    Json own = item;
    if (own.contains("parameters")) {
      Json rest = Json::array();
      for (const Json& parameter : own.at("parameters")) {
        if (parameter.value("$ref", "") != "#/components/parameters/Tin") rest.push_back(parameter);
      }
      own["parameters"] = rest;
    }
    paths[path.size() == kTin.size() ? "/" : path.substr(kTin.size())] = own;
  }
  document["paths"] = paths;
  return document;
}

}  // namespace

std::string tin_openapi_json(std::string_view url) {
  static const Json cut = cut_to_tin();
  Json document = cut;
  document["servers"] = Json::array({{{"url", url}, {"description", "This TIN"}}});
  return document.dump();
}

}  // namespace proto
