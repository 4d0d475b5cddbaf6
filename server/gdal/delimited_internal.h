// Fields and numbers of delimited text. For this folder and its tests only.
#pragma once

#include <optional>
#include <string_view>
#include <vector>

namespace server::gdal {

/// How the lines of a file are divided.
struct Dialect {
  char delimiter = ',';  // ' ' stands for any run of blanks
  char decimal_point = '.';
};

/// Guesses from a line: semicolon, tab, comma, else blanks; decimal commas where semicolons leave them free.
Dialect guess_dialect(std::string_view line);

/// Splits a line into trimmed fields; a field in double quotes is taken without them and may hold delimiters.
void split(std::string_view line, const Dialect& dialect, std::vector<std::string_view>& fields);

/// The number that is the whole field (infinities and NaN included); nothing when it is none.
std::optional<double> parse_number(std::string_view field, const Dialect& dialect);

}  // namespace server::gdal
