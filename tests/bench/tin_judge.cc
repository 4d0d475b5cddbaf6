#include "tests/bench/tin_judge.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <map>
#include <stdexcept>

namespace bench {

namespace {

__extension__ using Wide = __int128;

using Vertex = PixelTin::Vertex;

double turn(const Vertex& a, const Vertex& b, double column, double row) {
  return (b.column - a.column) * (row - a.row) - (b.row - a.row) * (column - a.column);
}

/// Compares the samples under one triangle, edges included.
void measure(const Dem& dem, const Vertex& a, const Vertex& b, const Vertex& c, std::vector<float>& errors) {
  const double area = turn(a, b, c.column, c.row);
  if (area == 0) return;
  const auto range = [](double x, double y, double z, std::int32_t count) {
    return std::pair(std::max(0, static_cast<std::int32_t>(std::ceil(std::min({x, y, z})))),
                     std::min(count - 1, static_cast<std::int32_t>(std::floor(std::max({x, y, z})))));
  };
  const auto columns = range(a.column, b.column, c.column, dem.width()), rows = range(a.row, b.row, c.row, dem.height());
  for (std::int32_t row = rows.first; row <= rows.second; ++row) {
    for (std::int32_t column = columns.first; column <= columns.second; ++column) {
      const double wa = turn(b, c, column, row) / area, wb = turn(c, a, column, row) / area, wc = turn(a, b, column, row) / area;
      if (wa < 0 || wb < 0 || wc < 0) continue;
      const std::size_t i = static_cast<std::size_t>(row) * static_cast<std::size_t>(dem.width()) + static_cast<std::size_t>(column);
      if (std::isnan(dem.z[i])) continue;
      const auto error = static_cast<float>(std::abs(wa * a.z + wb * b.z + wc * c.z - dem.z[i]));
      if (!(errors[i] >= error)) errors[i] = error;
    }
  }
}

/// Whether d lies strictly inside the circle of a, b, c, on the lattice.
bool in_circle(const std::array<std::int64_t, 2>& a, const std::array<std::int64_t, 2>& b, const std::array<std::int64_t, 2>& c,
               const std::array<std::int64_t, 2>& d) {
  std::array<std::array<Wide, 3>, 3> m{};
  const std::array points{a, b, c};
  for (std::size_t i = 0; i < 3; ++i) {
    const Wide x = points[i][0] - d[0], y = points[i][1] - d[1];
    m[i] = {x, y, x * x + y * y};
  }
  const Wide determinant = m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]) + m[1][2] * (m[2][0] * m[0][1] - m[2][1] * m[0][0]) +
                           m[2][2] * (m[0][0] * m[1][1] - m[0][1] * m[1][0]);
  const Wide orientation = (m[0][0] - m[2][0]) * (m[1][1] - m[2][1]) - (m[0][1] - m[2][1]) * (m[1][0] - m[2][0]);
  return orientation > 0 ? determinant > 0 : determinant < 0;
}

void look_at_edges(const Dem& dem, const PixelTin& tin, Judgement& out) {
  std::vector<std::array<std::int64_t, 2>> at;
  bool whole = true;
  for (const Vertex& v : tin.vertices) {
    whole = whole && v.column == std::round(v.column) && v.row == std::round(v.row);
    at.push_back({std::llround(v.column) * dem.grid->dx, std::llround(v.row) * dem.grid->dy});
  }
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::vector<std::uint32_t>> opposite;
  for (const auto& t : tin.triangles) {
    for (std::size_t i = 0; i < 3; ++i) opposite[std::minmax(t[i], t[(i + 1) % 3])].push_back(t[(i + 2) % 3]);
  }
  const auto on_border = [&dem](const Vertex& a, const Vertex& b) {
    const auto both = [](double x, double y, double line) { return x == line && y == line; };
    return both(a.column, b.column, 0) || both(a.column, b.column, dem.width() - 1) || both(a.row, b.row, 0) ||
           both(a.row, b.row, dem.height() - 1);
  };
  const bool has_voids = std::any_of(dem.z.begin(), dem.z.end(), [](double z) { return std::isnan(z); });
  for (const auto& [edge, apexes] : opposite) {
    const auto [a, b] = edge;
    if (apexes.size() == 2 && whole && in_circle(at[a], at[b], at[apexes[0]], at[apexes[1]])) ++out.not_delaunay;
    if (apexes.size() > 2) ++out.open_edges;
    if (apexes.size() == 1 && !has_voids && !on_border(tin.vertices[a], tin.vertices[b])) ++out.open_edges;
  }
}

}  // namespace

Judgement judge(const Dem& dem, const PixelTin& tin, double tolerance) {
  Judgement out;
  out.errors.assign(dem.z.size(), std::numeric_limits<float>::quiet_NaN());
  for (const auto& t : tin.triangles) measure(dem, tin.vertices[t[0]], tin.vertices[t[1]], tin.vertices[t[2]], out.errors);
  double squares = 0;
  std::size_t samples = 0;
  for (std::size_t i = 0; i < dem.z.size(); ++i) {
    if (std::isnan(dem.z[i])) continue;
    ++samples;
    if (std::isnan(out.errors[i])) {
      ++out.uncovered;
      continue;
    }
    const double error = out.errors[i];
    squares += error * error;
    out.max_error = std::max(out.max_error, error);
    if (error > tolerance * (1 + 1e-7)) ++out.over;  // single precision
  }
  out.rmse = std::sqrt(squares / static_cast<double>(std::max<std::size_t>(samples, 1)));
  look_at_edges(dem, tin, out);
  return out;
}

PixelTin read_tin(const std::string& path) {
  std::ifstream file(path);
  std::size_t vertices = 0, triangles = 0;
  if (!(file >> vertices >> triangles)) throw std::runtime_error("can't read " + path);
  PixelTin tin;
  tin.vertices.resize(vertices);
  tin.triangles.resize(triangles);
  for (Vertex& v : tin.vertices) file >> v.column >> v.row >> v.z;
  for (auto& t : tin.triangles) file >> t[0] >> t[1] >> t[2];
  if (!file) throw std::runtime_error(path + " ends too early");
  return tin;
}

}  // namespace bench
