#include "server/web/html.h"

#include "proto/markup.h"

namespace server::web {

using proto::escaped_markup;
namespace {

constexpr std::string_view kStyle =
    "body{font:16px/1.5 system-ui,sans-serif;max-width:60rem;margin:2rem auto;padding:0 1rem;color:#222}"
    "nav{color:#666}table{border-collapse:collapse}td,th{padding:.2rem .8rem .2rem 0;text-align:left;"
    "border-bottom:1px solid #ddd;vertical-align:top}a{color:#0b5394}small{color:#666}";

/// The steps of a path, each a link to itself.
void write_steps(std::string& out, std::string_view path) {
  out += "<nav><a href=\"/\">Tinsmith</a>";
  for (std::size_t at = 1; at < path.size();) {
    const std::size_t end = std::min(path.find('/', at), path.size());
    out += " / <a href=\"" + escaped_markup(path.substr(0, end)) + "\">" +
           escaped_markup(path.substr(at, end - at)) + "</a>";
    at = end + 1;
  }
  out += "</nav>\n";
}

void write_row(std::string& out, const std::vector<std::string>& cells, std::string_view tag) {
  out += "<tr>";
  for (const std::string& cell : cells) {
    out.append("<").append(tag).append(">").append(escaped_markup(cell)).append("</").append(tag).append(">");
  }
  out += "</tr>\n";
}

}  // namespace

std::string render(const Page& page) {
  std::string out = "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">";
  out += "<meta name=\"viewport\" content=\"width=device-width\"><title>" + escaped_markup(page.title) +
         "</title><style>";
  out.append(kStyle).append("</style></head><body>\n");
  write_steps(out, page.path);
  out += "<h1>" + escaped_markup(page.title) + "</h1>\n";
  if (!page.description.empty()) out += "<p>" + escaped_markup(page.description) + "</p>\n";
  if (!page.facts.empty()) {
    out += "<table>\n";
    for (const auto& [name, value] : page.facts) {
      out += "<tr><th>" + escaped_markup(name) + "</th><td>" + escaped_markup(value) + "</td></tr>\n";
    }
    out += "</table>\n";
  }
  if (!page.columns.empty()) {
    out += "<h2>Features</h2>\n<table>\n";
    write_row(out, page.columns, "th");
    for (const auto& row : page.rows) write_row(out, row, "td");
    out += "</table>\n";
  }
  out += "<h2>Links</h2>\n<ul>\n";
  for (const PageLink& link : page.links) {
    out += "<li><a href=\"" + escaped_markup(link.href) + "\">" + escaped_markup(link.title) +
           "</a> <small>" + escaped_markup(link.type) + "</small></li>\n";
  }
  out += "</ul>\n</body></html>\n";
  return out;
}

}  // namespace server::web
