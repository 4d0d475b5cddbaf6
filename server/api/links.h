// Absolute links: some clients (QGIS before 3.30) follow no others.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "proto/messages.h"
#include "server/api/answer.h"
#include "server/config.h"

namespace server::api {

/// Where the client found this server: the configured public URL, else "http://" and the request's Host; empty when neither is
/// known, so that links stay relative to the root. Without a slash at the end.
std::string base_url(const Config& config, const Request& request);

/// A value as it stands in the query of a URL.
std::string encoded(std::string_view text);

/// Puts `base` before every href that begins with a slash.
void make_absolute(std::vector<proto::Link>& links, const std::string& base);
void make_absolute(proto::CollectionDocument& document, const std::string& base);

/// What a person sees instead of JSON: the same resource with the same links.
struct HtmlPage {
  std::string title;
  std::string description;
  std::vector<proto::Link> links;
  std::vector<std::pair<std::string, std::string>> facts;  // name and value
  std::vector<std::string> columns;                        // of a table of features, with their rows
  std::vector<std::vector<std::string>> rows;
};

/// Browsers ask for HTML first; programs for anything or for JSON.
bool wants_html(const Request& request);

/// The page as text/html, or the JSON, as the request's Accept says; with Vary.
Response negotiated(const Request& request, std::string json, std::string_view json_type, const HtmlPage& page);

/// entity_tag() of a resource that has both.
std::string negotiated_tag(const app::Tin& tin, std::uint64_t revision, const Request& request);

}  // namespace server::api
