#include "tests/bench/simplify_plot.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <limits>
#include <stdexcept>

namespace bench {

namespace {

constexpr double kLeft = 80, kTop = 50, kWidth = 560, kHeight = 380;
constexpr std::array kColours{"#3b6ea5", "#5b9a5b", "#b5763a", "#8a4b8f", "#c0392b", "#555555", "#1f9e9e"};

/// A logarithmic axis.
struct Axis {
  double low = std::numeric_limits<double>::infinity(), high = 0;
  void take(double value) {
    low = std::min(low, value);
    high = std::max(high, value);
  }
  double part(double value) const { return high > low ? std::log(value / low) / std::log(high / low) : 0.5; }
};

std::string text(double x, double y, const std::string& content, const char* more) {
  char place[128];
  std::snprintf(place, sizeof place, "<text x=\"%.1f\" y=\"%.1f\" %s>", x, y, more);
  return place + content + "</text>\n";
}

std::string number(double value) {
  char buffer[32];
  std::snprintf(buffer, sizeof buffer, "%g", value);
  return buffer;
}

std::string line(double x1, double y1, double x2, double y2) {
  char buffer[160];
  std::snprintf(buffer, sizeof buffer, "<line x1=\"%.1f\" y1=\"%.1f\" x2=\"%.1f\" y2=\"%.1f\" stroke=\"#ddd\"/>\n", x1, y1, x2, y2);
  return buffer;
}

}  // namespace

void add_point(std::vector<Curve>& curves, const std::string& name, double tolerance, std::size_t vertices) {
  auto curve = std::find_if(curves.begin(), curves.end(), [&name](const Curve& c) { return c.name == name; });
  if (curve == curves.end()) curve = curves.insert(curves.end(), Curve{name, {}});
  curve->points.push_back({tolerance, static_cast<double>(vertices)});
}

void write_curves(const std::string& path, const std::string& title, std::span<const Curve> curves) {
  Axis across, up;
  for (const Curve& curve : curves) {
    for (const auto& point : curve.points) {
      across.take(point.tolerance);
      up.take(point.vertices);
    }
  }
  const auto x = [&across](double tolerance) { return kLeft + kWidth * across.part(tolerance); };
  const auto y = [&up](double vertices) { return kTop + kHeight * (1 - up.part(vertices)); };
  std::string out = "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"800\" height=\"480\" font-family=\"sans-serif\" "
                    "font-size=\"12\">\n<rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n";
  out += text(kLeft, 28, title, "font-size=\"15\" font-weight=\"bold\"");
  if (!curves.empty()) {
    for (const auto& point : curves[0].points) {
      out += line(x(point.tolerance), kTop, x(point.tolerance), kTop + kHeight);
      out += text(x(point.tolerance), kTop + kHeight + 18, number(point.tolerance), "text-anchor=\"middle\"");
    }
  }
  for (double decade = std::pow(10, std::floor(std::log10(up.low))); decade <= up.high; decade *= 10) {
    for (const double vertices : {decade, 2 * decade, 5 * decade}) {
      if (vertices < up.low || vertices > up.high) continue;
      out += line(kLeft, y(vertices), kLeft + kWidth, y(vertices));
      out += text(kLeft - 8, y(vertices) + 4, number(vertices), "text-anchor=\"end\"");
    }
  }
  for (std::size_t i = 0; i < curves.size(); ++i) {
    const std::string colour = kColours[i % kColours.size()];
    out += "<polyline fill=\"none\" stroke-width=\"2\" stroke=\"" + colour + "\" points=\"";
    for (const auto& point : curves[i].points) out += number(x(point.tolerance)) + "," + number(y(point.vertices)) + " ";
    out += "\"/>\n";
    const double legend = kTop + 14 + 18 * static_cast<double>(i);
    out += text(kLeft + kWidth + 12, legend, curves[i].name, ("fill=\"" + colour + "\"").c_str());
  }
  std::ofstream file(path);
  file << out << "</svg>\n";
  if (!file) throw std::runtime_error("can't write " + path);
}

}  // namespace bench
