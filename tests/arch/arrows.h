// The rules of who may include whom, and the finding of includes that break them.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace arch {

struct Include {
  std::string header;
  int line = 0;
  bool quoted = false;  // "header" and not <header>
};

/// The #include lines of a source text; those in comments are left out.
std::vector<Include> includes_of(std::string_view source);

/// The two tables of this folder, read. A table's syntax is described at its top.
class Rules {
 public:
  /// Throws std::runtime_error with the line that is wrong.
  Rules(std::string_view arrows, std::string_view libraries);

  /// What is wrong with `include` in `file`, a path from the root like "tin/mesh/mesh.cc"; empty when nothing
  /// is.
  std::string objection(const std::string& file, const Include& include) const;

  /// The room of a path; empty when it lies in none.
  std::string room_of(const std::string& path) const;
  bool sees(const std::string& room, const std::string& other) const;

  /// A chain of arrows that comes back to where it began; empty when there is none.
  std::vector<std::string> cycle() const;
  std::vector<std::string> rooms() const;

 private:
  std::map<std::string, std::vector<std::string>> arrows_;
  std::vector<std::pair<std::vector<std::string>, std::vector<std::string>>> libraries_;
};

/// The C++ sources below these folders of `root`, as paths from `root`, sorted.
std::vector<std::string> sources_below(const std::filesystem::path& root,
                                       const std::vector<std::string>& folders);

std::string read_text(const std::filesystem::path& file);

}  // namespace arch
