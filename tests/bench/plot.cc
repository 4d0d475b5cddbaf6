#include "tests/bench/plot.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <fstream>
#include <stdexcept>

namespace bench {
namespace {

constexpr int kRow = 24, kTop = 70, kLabels = 130, kColumn = 230, kLongest = 150;

struct Column {
  const char* title;
  const char* colour;
  const char* format;
  double unit;
  double Bar::*value;
};

constexpr std::array<Column, 3> kColumns{{
    {"deletion time, s", "#3b6ea5", "%.2f", 1, &Bar::seconds},
    {"in-circle tests, millions", "#5b9a5b", "%.1f", 1e6, &Bar::in_circle_tests},
    {"power computations, millions", "#b5763a", "%.1f", 1e6, &Bar::power_computations},
}};

std::string text(double x, double y, const std::string& content, const char* more = "") {
  char place[96];
  std::snprintf(place, sizeof place, "<text x=\"%.1f\" y=\"%.1f\" %s>", x, y, more);
  return place + content + "</text>\n";
}

std::string draw(const Column& column, int index, std::span<const Bar> bars) {
  const double left = kLabels + index * kColumn;
  std::string out = text(left, kTop - 12, column.title, "font-weight=\"bold\"");
  double largest = 0;
  for (const Bar& bar : bars) largest = std::max(largest, bar.*column.value);
  for (std::size_t i = 0; i < bars.size(); ++i) {
    const double value = bars[i].*column.value, width = largest > 0 ? kLongest * value / largest : 0;
    const double y = kTop + static_cast<double>(i) * kRow;
    char piece[160];
    std::snprintf(piece, sizeof piece, "<rect x=\"%.1f\" y=\"%.1f\" width=\"%.1f\" height=\"%d\" fill=\"%s\"/>\n", left, y,
                  width, kRow - 8, column.colour);
    out += piece;
    std::snprintf(piece, sizeof piece, column.format, value / column.unit);
    out += text(left + width + 5, y + 12, piece);
  }
  return out;
}

}  // namespace

void write_plot(const std::string& path, const std::string& title, std::span<const Bar> bars) {
  const int width = kLabels + 3 * kColumn, height = kTop + static_cast<int>(bars.size()) * kRow + 10;
  std::string svg = "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"" + std::to_string(width) + "\" height=\"" +
                    std::to_string(height) + "\" font-family=\"sans-serif\" font-size=\"12\">\n";
  svg += "<rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n" + text(10, 24, title, "font-size=\"16\"");
  for (std::size_t i = 0; i < bars.size(); ++i) {
    svg += text(kLabels - 10, kTop + static_cast<double>(i) * kRow + 12, bars[i].method, "text-anchor=\"end\"");
  }
  for (std::size_t c = 0; c < kColumns.size(); ++c) svg += draw(kColumns[c], static_cast<int>(c), bars);
  std::ofstream file(path, std::ios::binary);
  file << svg << "</svg>\n";
  file.close();
  if (!file) throw std::runtime_error("can't write " + path);
}

}  // namespace bench
