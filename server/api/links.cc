#include "server/api/links.h"

#include <algorithm>

#include "server/http/field_value.h"
#include "server/web/html.h"

namespace server::api {

std::string base_url(const Config& config, const Request& request) {
  if (!config.public_url.empty()) return config.public_url;
  const std::string_view host = request.header("host");
  const bool plain = std::all_of(host.begin(), host.end(), [](char c) {
    return (c >= '0' && c <= '9') || (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') ||
           std::string_view(".:-_[]").find(c) != std::string_view::npos;
  });
  return host.empty() || !plain ? std::string() : "http://" + std::string(host);
}

std::string encoded(std::string_view text) {
  std::string out;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    const bool plain = (c >= '0' && c <= '9') || (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') ||
                       std::string_view("-._~,:/").find(c) != std::string_view::npos;
    if (plain) {
      out += c;
    } else {
      constexpr char kDigits[] = "0123456789ABCDEF";
      out.append({'%', kDigits[byte >> 4], kDigits[byte & 15]});
    }
  }
  return out;
}

void make_absolute(std::vector<proto::Link>& links, const std::string& base) {
  for (proto::Link& link : links) {
    if (link.href.starts_with('/')) link.href = base + link.href;
  }
}

void make_absolute(proto::CollectionDocument& document, const std::string& base) {
  make_absolute(document.links, base);
  for (proto::DataQuery& query : document.queries) {
    if (query.href.starts_with('/')) query.href = base + query.href;
  }
}

bool wants_html(const Request& request) {
  constexpr std::string_view kHtml = "text/html";
  const std::string_view accept = request.header("accept");
  const auto accepted = http::parse_preferences(accept);
  // JSON has many names here: people get HTML where their browser puts it before all of them.
  return accepted && http::prefers(accept, kHtml, kJson) &&
         std::all_of(accepted->begin(), accepted->end(), [&](const http::Preference& one) {
           return !one.name.ends_with("json") || http::prefers(accept, kHtml, one.name);
         });
}

Response negotiated(const Request& request, std::string json, std::string_view json_type, const HtmlPage& page) {
  Response response{200, {{"Content-Type", std::string(json_type)}, {"Vary", "Accept"}}, std::move(json)};
  if (!wants_html(request)) return response;
  web::Page html{page.title, page.description, request.path, {}, page.facts, page.columns, page.rows};
  for (const proto::Link& link : page.links) {
    html.links.push_back({link.href, link.title.empty() ? link.rel : link.title, link.type});
  }
  response.headers[0].second = "text/html; charset=utf-8";
  response.body = web::render(html);
  return response;
}

std::string negotiated_tag(const app::Tin& tin, std::uint64_t revision, const Request& request) {
  if (!wants_html(request)) return entity_tag(tin, revision, request);
  std::string tag = entity_tag(tin, revision, request);
  tag.insert(tag.size() - 1, "-html");
  return tag;
}

}  // namespace server::api
