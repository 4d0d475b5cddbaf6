// The pages that people get where programs get JSON: one plain layout, no scripts.
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace server::web {

struct PageLink {
  std::string href, title, type;
};

struct Page {
  std::string title;
  std::string description;
  std::string path;  // of the resource: its steps become links
  std::vector<PageLink> links;
  std::vector<std::pair<std::string, std::string>> facts;
  std::vector<std::string> columns;
  std::vector<std::vector<std::string>> rows;
};

/// The page as UTF-8 HTML. All texts are escaped.
std::string render(const Page& page);

}  // namespace server::web
