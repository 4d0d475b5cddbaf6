// Points in columns: CSV with any usual delimiter, XYZ, with or without a header.
#include <fast_float/fast_float.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <string>
#include <system_error>

#include "proto/formats/byte_reader.h"
#include "proto/formats/frame_note.h"
#include "server/gdal/delimited_internal.h"
#include "server/gdal/import_internal.h"

namespace server::gdal {
namespace {

using tin::base::Code;
using tin::base::error;
using tin::base::Error;
using tin::base::Result;

std::string_view trimmed(std::string_view text) {
  const auto blank = [](char c) { return c == ' ' || c == '\t' || c == '\r'; };
  while (!text.empty() && blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && blank(text.back())) text.remove_suffix(1);
  return text;
}

bool is_comment(std::string_view line) {
  return line.starts_with('#') || line.starts_with("//");
}

std::string lower(std::string_view text) {
  std::string out(text);
  std::transform(out.begin(), out.end(), out.begin(), [](unsigned char c) { return std::tolower(c); });
  return out;
}

Error at_line(Code code, const std::string& what, std::uint64_t line) {
  return error(code, "Line " + std::to_string(line) + ": " + what, "line " + std::to_string(line));
}

/// Which columns hold x, y and z.
struct Columns {
  std::size_t x = 0, y = 1, z = 2;
  bool degrees = false;  // called longitude and latitude
  std::size_t last() const { return std::max({x, y, z}); }
};

template <std::size_t N>
std::optional<std::size_t> column_named(const std::vector<std::string>& header,
                                        const std::array<std::string_view, N>& names) {
  for (const std::string_view name : names) {
    const auto at = std::find(header.begin(), header.end(), name);
    if (at != header.end()) return static_cast<std::size_t>(at - header.begin());
  }
  return std::nullopt;
}

/// The columns that the header names; nothing when it names neither x nor y. Errors: a missing one of the
/// three.
Result<std::optional<Columns>> named_columns(const std::vector<std::string>& header,
                                             const std::string& z_field) {
  static constexpr std::array<std::string_view, 3> kLon{"lon", "longitude", "long"};
  static constexpr std::array<std::string_view, 2> kLat{"lat", "latitude"};
  static constexpr std::array<std::string_view, 5> kX{"x", "easting", "e", "east", "x_coord"};
  static constexpr std::array<std::string_view, 5> kY{"y", "northing", "n", "north", "y_coord"};
  static constexpr std::array<std::string_view, 8> kZ{"z",        "elevation", "elev", "height",
                                                      "altitude", "alt",       "h",    "z_coord"};
  std::optional<std::size_t> z = column_named(header, kZ);
  if (!z_field.empty()) {
    z = column_named(header, std::array{std::string_view(z_field)});
    if (!z) return error(Code::kInvalidValue, "The file has no column of this name", "query:z-field");
  }
  const auto x = column_named(header, kX);
  const auto y = column_named(header, kY);
  const auto lon = column_named(header, kLon);
  const auto lat = column_named(header, kLat);
  if (!x && !y && !lon && !lat && z_field.empty()) return std::optional<Columns>();
  const bool degrees = !(x && y) && lon && lat;
  if (!degrees && !(x && y)) {
    return error(Code::kInvalidValue, "The header must name both x and y, or longitude and latitude",
                 "line 1");
  }
  if (!z) {
    return error(Code::kInvalidValue, "No column is called z, elevation or height: name it with z-field",
                 "line 1");
  }
  return std::optional(Columns{degrees ? *lon : *x, degrees ? *lat : *y, *z, degrees});
}

/// The first three columns of numbers in a row of data.
std::optional<Columns> numeric_columns(const std::vector<std::string_view>& fields, const Dialect& dialect) {
  std::vector<std::size_t> numeric;
  for (std::size_t i = 0; i < fields.size() && numeric.size() < 3; ++i) {
    if (parse_number(fields[i], dialect)) numeric.push_back(i);
  }
  if (numeric.size() < 3) return std::nullopt;
  return Columns{numeric[0], numeric[1], numeric[2]};
}

/// Turns lines into points, learning dialect and columns from the first ones.
class PointParser {
 public:
  PointParser(const std::string& z_field, std::uint64_t limit) : z_field_(lower(z_field)), limit_(limit) {}

  std::optional<Error> add(std::string_view line, std::uint64_t number) {
    if (trimmed(line).empty()) return std::nullopt;
    if (is_comment(trimmed(line))) {
      const auto note = proto::formats::find_frame_note(trimmed(line).substr(1));
      if (!note.empty()) note_ = note;
      return std::nullopt;
    }
    if (!dialect_) {
      dialect_ = guess_dialect(line);
      split(line, *dialect_, fields_);
      if (is_header()) return take_header();
      if (!z_field_.empty()) {
        return error(Code::kInvalidValue, "The file has no header that could name this column",
                     "query:z-field");
      }
    }
    split(line, *dialect_, fields_);
    if (!columns_) {
      dialect_ = refined(*dialect_);
      columns_ = numeric_columns(fields_, *dialect_);
      if (!columns_)
        return at_line(Code::kMalformed, "there are no three numbers, as x, y and z need", number);
    }
    return add_point(number);
  }

  /// What a comment says of the lattice.
  const std::optional<std::string>& note() const { return note_; }
  bool degrees() const { return columns_ && columns_->degrees; }
  std::vector<RawPoint> take() { return std::move(points_); }

 private:
  /// A header has names, and no numbers.
  bool is_header() const {
    return std::none_of(fields_.begin(), fields_.end(), [&](std::string_view field) {
      return parse_number(field, refined(*dialect_)).has_value();
    });
  }

  std::optional<Error> take_header() {
    std::vector<std::string> header;
    for (const std::string_view field : fields_) header.push_back(lower(field));
    auto columns = named_columns(header, z_field_);
    if (!columns) return columns.error();
    columns_ = *columns;
    return std::nullopt;
  }

  /// Decimal commas, when the fields at hand have them and the delimiter leaves them free.
  Dialect refined(Dialect dialect) const {
    const bool comma = std::any_of(fields_.begin(), fields_.end(), [](std::string_view field) {
      return field.find(',') != std::string_view::npos;
    });
    if (dialect.delimiter != ',' && comma) dialect.decimal_point = ',';
    return dialect;
  }

  std::optional<Error> add_point(std::uint64_t number) {
    if (points_.empty()) dialect_ = refined(*dialect_);
    if (fields_.size() <= columns_->last())
      return at_line(Code::kMalformed, "there are too few columns", number);
    std::array<double, 3> values{};
    const std::array columns{columns_->x, columns_->y, columns_->z};
    for (std::size_t i = 0; i < 3; ++i) {
      const auto value = parse_number(fields_[columns[i]], *dialect_);
      const std::string column = "column " + std::to_string(columns[i] + 1);
      if (!value) return at_line(Code::kMalformed, column + " is not a number", number);
      if (!std::isfinite(*value))
        return at_line(Code::kNotFinite, column + " is not a finite number", number);
      values[i] = *value;
    }
    if (points_.size() >= limit_) return too_many_samples(limit_);
    points_.push_back({values[0], values[1], values[2]});
    return std::nullopt;
  }

  std::string z_field_;
  std::uint64_t limit_;
  std::optional<Dialect> dialect_;
  std::optional<Columns> columns_;
  std::vector<std::string_view> fields_;
  std::vector<RawPoint> points_;
  std::optional<std::string> note_;
};

}  // namespace

Dialect guess_dialect(std::string_view line) {
  for (const char delimiter : {';', '\t', ','}) {
    if (line.find(delimiter) != std::string_view::npos) return {delimiter, '.'};
  }
  return {' ', '.'};
}

void split(std::string_view line, const Dialect& dialect, std::vector<std::string_view>& fields) {
  fields.clear();
  const std::string_view ends =
      dialect.delimiter == ' ' ? std::string_view(" \t") : std::string_view(&dialect.delimiter, 1);
  std::string_view rest = trimmed(line);
  if (dialect.delimiter == '\t') rest = line;
  for (bool more = true; more;) {
    while (!rest.empty() && rest.front() == ' ') rest.remove_prefix(1);
    std::size_t end = 0;
    std::string_view field;
    const std::size_t quote = rest.starts_with('"') ? rest.find('"', 1) : std::string_view::npos;
    if (quote != std::string_view::npos) {
      field = rest.substr(1, quote - 1);
      end = std::min(rest.find_first_of(ends, quote), rest.size());
    } else {
      end = std::min(rest.find_first_of(ends), rest.size());
      field = rest.substr(0, end);
    }
    fields.push_back(trimmed(field));
    more = end < rest.size();
    rest.remove_prefix(more ? end + 1 : end);
    while (dialect.delimiter == ' ' && !rest.empty() && (rest.front() == ' ' || rest.front() == '\t')) {
      rest.remove_prefix(1);
    }
  }
}

std::optional<double> parse_number(std::string_view field, const Dialect& dialect) {
  if (field.starts_with('+')) field.remove_prefix(1);
  if (field.empty()) return std::nullopt;
  double value = 0;
  const fast_float::parse_options options{fast_float::chars_format::general, dialect.decimal_point};
  const auto [end, problem] =
      fast_float::from_chars_advanced(field.data(), field.data() + field.size(), value, options);
  if (problem != std::errc() || end != field.data() + field.size()) return std::nullopt;
  return value;
}

Result<RawPoints> read_delimited_points(const ImportTask& task) {
  proto::formats::FileReader file(task.workspace.file());
  proto::formats::LineReader lines(file);
  const double bytes = static_cast<double>(std::max<std::uint64_t>(1, file.size()));
  PointParser parser(task.options.z_field, task.options.max_samples);
  while (const auto line = lines.next()) {
    if (auto bad = parser.add(*line, lines.number())) return *std::move(bad);
    if (lines.number() % 10000 != 0) continue;
    if (task.cancelled()) return cancelled_error();
    task.report(0.9 * static_cast<double>(lines.bytes_read()) / bytes);
  }
  if (lines.failed())
    return at_line(Code::kMalformed, "it is too long to be a line of points", lines.number() + 1);
  RawPoints raw;
  raw.points = parser.take();
  raw.crs = task.asked_crs;
  raw.driver = "CSV";
  if (parser.note()) {
    if (auto taken = take_note(raw, *parser.note()); !taken) return taken.error();
  }
  if (!raw.crs && parser.degrees()) {
    auto crs = read_crs("OGC:CRS84");
    if (!crs) return crs.error();
    raw.crs = *std::move(crs);
  }
  return raw;
}

}  // namespace server::gdal
