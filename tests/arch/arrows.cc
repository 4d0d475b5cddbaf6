#include "tests/arch/arrows.h"

#include <fnmatch.h>

#include <algorithm>
#include <fstream>
#include <functional>
#include <iterator>
#include <regex>
#include <set>
#include <sstream>
#include <stdexcept>

namespace arch {
namespace {

using Words = std::vector<std::string>;

Words words_of(const std::string& text) {
  std::istringstream in(text);
  return {std::istream_iterator<std::string>(in), {}};
}

/// The lines "left: right" of a table, each side split into words.
std::vector<std::pair<Words, Words>> table_of(std::string_view text) {
  std::vector<std::pair<Words, Words>> rows;
  std::istringstream in{std::string(text)};
  for (std::string line; std::getline(in, line);) {
    line.resize(std::min(line.find('#'), line.size()));
    if (words_of(line).empty()) continue;
    const auto colon = line.find(':');
    if (colon == std::string::npos || words_of(line.substr(0, colon)).empty()) {
      throw std::runtime_error("not \"name: names\": " + line);
    }
    rows.emplace_back(words_of(line.substr(0, colon)), words_of(line.substr(colon + 1)));
  }
  return rows;
}

bool is_in(const std::string& path, const std::string& place) {
  return path == place || path.starts_with(place + "/");
}

bool matches_any(const std::string& text, const Words& patterns) {
  return std::any_of(patterns.begin(), patterns.end(),
                     [&](const std::string& p) { return fnmatch(p.c_str(), text.c_str(), 0) == 0; });
}

bool is_ours(const std::string& header) {
  return is_in(header, "tin") || is_in(header, "proto") || is_in(header, "server");
}

}  // namespace

std::vector<Include> includes_of(std::string_view source) {
  static const std::regex directive(R"(^\s*#\s*include\s*(["<])([^">]+)[">])");
  std::vector<Include> found;
  std::istringstream in{std::string(source)};
  bool in_comment = false;
  int number = 0;
  for (std::string line; std::getline(in, line);) {
    ++number;
    std::smatch match;
    if (!in_comment && std::regex_search(line, match, directive)) {
      found.push_back({match[2], number, match[1] == "\""});
      continue;
    }
    // A block comment begins on a line and ends on a later one; "//" hides what follows it.
    for (std::size_t at = 0; at < line.size();) {
      const auto open = line.find("/*", at);
      if (!in_comment && (open == std::string::npos || line.find("//", at) < open)) break;
      const auto close = line.find("*/", in_comment ? at : open + 2);
      in_comment = close == std::string::npos;
      if (in_comment) break;
      at = close + 2;
    }
  }
  return found;
}

Rules::Rules(std::string_view arrows, std::string_view libraries) : libraries_(table_of(libraries)) {
  for (const auto& [left, right] : table_of(arrows)) {
    if (left.size() != 1)
      throw std::runtime_error("one room a line, not \"" + left[0] + " " + left[1] + "\"");
    if (!arrows_.emplace(left[0], right).second)
      throw std::runtime_error("two lines for the room " + left[0]);
  }
  for (const auto& [room, seen] : arrows_) {
    for (const auto& other : seen) {
      if (other != "*" && other != "tin" && !arrows_.contains(other)) {
        throw std::runtime_error(room + " sees " + other + ", which has no line");
      }
    }
  }
}

std::string Rules::room_of(const std::string& path) const {
  const auto name = std::filesystem::path(path).replace_extension().generic_string();
  std::string best;
  for (const auto& [room, seen] : arrows_) {
    if (is_in(name, room) && room.size() > best.size()) best = room;
  }
  return best;
}

bool Rules::sees(const std::string& room, const std::string& other) const {
  if (room == other) return true;
  std::set<std::string> visited;
  // Arrows are followed one step, and from there on only to what lies in tin/.
  const std::function<bool(const std::string&)> reaches = [&](const std::string& from) {
    if (!visited.insert(from).second || !arrows_.contains(from)) return false;
    for (const auto& next : arrows_.at(from)) {
      if (from == room && (next == "*" || next == other)) return true;
      if (is_in(other, "tin") && (next == "*" || next == "tin" || next == other || reaches(next)))
        return true;
    }
    return false;
  };
  return reaches(room);
}

std::string Rules::objection(const std::string& file, const Include& include) const {
  if (!is_ours(include.header)) {
    if (include.quoted) return "is not a path from the root into tin/, proto/ or server/";
    for (const auto& [headers, files] : libraries_) {
      if (matches_any(include.header, headers) && !matches_any(file, files)) {
        std::string where;
        for (const auto& place : files) where += " " + place;
        return "belongs in" + where;
      }
    }
    return "";
  }
  if (!include.quoted) return "is ours and wants quotation marks";
  const auto from = room_of(file);
  const auto to = room_of(include.header);
  if (from.empty()) return "stands in a file whose room has no line in arrows.txt";
  if (to.empty()) return "lies in a room that has no line in arrows.txt";
  if (!sees(from, to)) return "goes against the arrows: " + from + " does not see " + to;
  return "";
}

std::vector<std::string> Rules::cycle() const {
  std::set<std::string> done;
  std::vector<std::string> path;
  const std::function<bool(const std::string&)> visit = [&](const std::string& room) {
    const auto seen_before = std::find(path.begin(), path.end(), room);
    if (seen_before != path.end()) {
      path.erase(path.begin(), seen_before);
      path.push_back(room);
      return true;
    }
    if (done.contains(room) || !arrows_.contains(room)) return false;
    path.push_back(room);
    for (const auto& next : arrows_.at(room)) {
      if (visit(next)) return true;
    }
    path.pop_back();
    done.insert(room);
    return false;
  };
  for (const auto& [room, seen] : arrows_) {
    if (visit(room)) return path;
  }
  return {};
}

std::vector<std::string> Rules::rooms() const {
  std::vector<std::string> names;
  for (const auto& [room, seen] : arrows_) names.push_back(room);
  return names;
}

std::vector<std::string> sources_below(const std::filesystem::path& root,
                                       const std::vector<std::string>& folders) {
  std::vector<std::string> files;
  for (const auto& folder : folders) {
    for (const auto& entry : std::filesystem::recursive_directory_iterator(root / folder)) {
      const auto suffix = entry.path().extension();
      if (entry.is_regular_file() && (suffix == ".h" || suffix == ".cc")) {
        files.push_back(entry.path().lexically_relative(root).generic_string());
      }
    }
  }
  std::sort(files.begin(), files.end());
  return files;
}

std::string read_text(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  if (!in) throw std::runtime_error("cannot read " + file.string());
  return {std::istreambuf_iterator<char>(in), {}};
}

}  // namespace arch
