#include "server/gdal/ascii_grid.h"

#include <charconv>
#include <cmath>
#include <cstdio>
#include <memory>
#include <optional>
#include <string>
#include <system_error>
#include <vector>

#include "server/gdal/not_written.h"

namespace server::gdal {
namespace {

using tin::base::Code;
using tin::base::error;
using tin::base::Error;
using tin::base::Result;

struct Close {
  void operator()(std::FILE* file) const { std::fclose(file); }
};
using File = std::unique_ptr<std::FILE, Close>;

template <class Number>
std::string shortest(Number value) {
  char buffer[64];
  return {buffer, std::to_chars(buffer, buffer + sizeof buffer, value).ptr};
}

std::string value_text(const RasterSpec& spec, double value) {
  return spec.data_type == "Float32" ? shortest(static_cast<float>(value)) : shortest(value);
}

std::string header(const RasterSpec& spec) {
  const auto& g = spec.geotransform;
  std::string text = "ncols " + std::to_string(spec.width) + "\nnrows " + std::to_string(spec.height) +
                     "\nxllcorner " + shortest(g[0]) + "\nyllcorner " +
                     shortest(g[3] + static_cast<double>(spec.height) * g[5]) + "\n";
  if (std::abs(g[1] / -g[5] - 1) < 1e-12) {
    text += "cellsize " + shortest(g[1]) + "\n";
  } else {
    text += "dx " + shortest(g[1]) + "\ndy " + shortest(-g[5]) + "\n";
  }
  return text + "NODATA_value " + value_text(spec, spec.nodata) + "\n";
}

Error not_written_to(const std::filesystem::path& out) {
  return not_written("The ASCII grid could not be written", out);
}

std::optional<Error> write(const std::filesystem::path& out, const RasterSpec& spec, const RowSource& rows) {
  const File file(std::fopen(out.c_str(), "wb"));
  if (!file) return not_written_to(out);
  std::string text = header(spec);
  std::vector<double> values(static_cast<std::size_t>(spec.width));
  for (std::int64_t row = 0; row < spec.height; ++row) {
    if (auto filled = rows(row, values); !filled) return filled.error();
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (i > 0) text += ' ';
      std::string number = value_text(spec, values[i]);
      // Readers tell integers from floats by the first number.
      if (row == 0 && i == 0 && number.find_first_not_of("-0123456789") == std::string::npos) number += ".0";
      text += number;
    }
    text += '\n';
    if (std::fwrite(text.data(), 1, text.size(), file.get()) != text.size()) return not_written_to(out);
    text.clear();
  }
  if (std::fflush(file.get()) != 0) return not_written_to(out);
  return std::nullopt;
}

}  // namespace

Result<void> write_ascii_grid(const std::filesystem::path& out, const RasterSpec& spec,
                              const RowSource& rows) {
  const auto& g = spec.geotransform;
  if (!(g[1] > 0) || !(g[5] < 0) || g[2] != 0 || g[4] != 0) {
    return error(Code::kInvalidValue,
                 "An ASCII grid runs from north to south, and the source does not: ask for a cell-size.",
                 "query:f");
  }
  if (auto bad = write(out, spec, rows)) {
    std::error_code ignored;
    std::filesystem::remove(out, ignored);
    return *std::move(bad);
  }
  return {};
}

}  // namespace server::gdal
