// Lines, fields and numbers of delimited text. For this folder and its tests only.
#pragma once

#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace server::gdal {

/// Reads a file line by line in bounded memory; accepts LF and CR LF, and skips a UTF-8 byte order mark.
class LineReader {
 public:
  static constexpr std::size_t kLongestLine = std::size_t{1} << 20;

  explicit LineReader(const std::filesystem::path& file);

  /// The next line without its end, valid until the next call; nothing at the end of the file, or when
  /// failed().
  std::optional<std::string_view> next();

  /// The number of the line that next() gave, from 1.
  std::uint64_t number() const { return number_; }
  std::uint64_t bytes_read() const { return bytes_; }
  /// Whether the file could not be read, or has a line longer than kLongestLine.
  bool failed() const { return failed_; }

 private:
  bool fill();

  struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  std::unique_ptr<std::FILE, Close> file_;
  std::vector<char> buffer_;
  std::size_t begin_ = 0, end_ = 0;
  std::uint64_t number_ = 0, bytes_ = 0;
  bool failed_ = false, at_end_ = false;
};

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
