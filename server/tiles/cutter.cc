#include "server/tiles/cutter.h"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace server::tiles {

using proto::formats::kQuantizedMax;
using proto::formats::QuantizedVertex;
using proto::formats::TileRectangle;
using tin::base::Code;
using tin::base::error;
using tin::base::Result;

namespace {

double along(const Corner& c, bool lon) {
  return lon ? c.lon : c.lat;
}

bool before(const Corner& a, const Corner& b) {
  return std::tie(a.lon, a.lat, a.height) < std::tie(b.lon, b.lat, b.height);
}

/// Where the edge between two corners meets a side: one result for either direction and for every tile.
Corner on_edge(const Corner& one, const Corner& other, bool lon, double side) {
  const bool swap = before(other, one);
  const Corner &a = swap ? other : one, &b = swap ? one : other;
  const double t = std::clamp((side - along(a, lon)) / (along(b, lon) - along(a, lon)), 0.0, 1.0);
  Corner c;
  c.lon = lon ? side : a.lon + t * (b.lon - a.lon);
  c.lat = lon ? a.lat + t * (b.lat - a.lat) : side;
  c.height = a.height + t * (b.height - a.height);
  for (std::size_t i = 0; i < 3; ++i) {
    c.normal[i] = a.normal[i] + static_cast<float>(t) * (b.normal[i] - a.normal[i]);
  }
  return c;
}

/// The place of the triangle at a corner of the tile.
Corner on_plane(std::array<Corner, 3> corners, double lon, double lat) {
  std::sort(corners.begin(), corners.end(), before);
  const auto& [a, b, c] = corners;
  const double area = (b.lon - a.lon) * (c.lat - a.lat) - (c.lon - a.lon) * (b.lat - a.lat);
  Corner at{lon, lat, a.height, a.normal};
  if (area == 0) return at;
  const double wb = std::clamp(((lon - a.lon) * (c.lat - a.lat) - (c.lon - a.lon) * (lat - a.lat)) / area, 0.0, 1.0);
  const double wc = std::clamp(((b.lon - a.lon) * (lat - a.lat) - (lon - a.lon) * (b.lat - a.lat)) / area, 0.0, 1.0);
  at.height += wb * (b.height - a.height) + wc * (c.height - a.height);
  for (std::size_t i = 0; i < 3; ++i) {
    at.normal[i] += static_cast<float>(wb) * (b.normal[i] - a.normal[i]) + static_cast<float>(wc) * (c.normal[i] - a.normal[i]);
  }
  return at;
}

/// Positions on a side keep to it, others keep off it.
std::uint16_t quantised(double value, double low, double high) {
  if (value == low) return 0;
  if (value == high) return kQuantizedMax;
  return static_cast<std::uint16_t>(std::clamp(std::round((value - low) / (high - low) * kQuantizedMax), 1.0, kQuantizedMax - 1.0));
}

std::array<float, 3> unit(std::array<float, 3> v) {
  const float size = std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
  if (!(size > 0)) return {0, 0, 1};
  return {v[0] / size, v[1] / size, v[2] / size};
}

}  // namespace

Cutter::Cutter(const TileRectangle& rectangle, const HeightLattice& heights) : rectangle_(rectangle), heights_(heights) {
  mesh_.rectangle = rectangle;
  mesh_.min_height = static_cast<float>(heights.base_m);
  mesh_.max_height = static_cast<float>(heights.top_m());
}

void Cutter::set_stray(double lon, double lat) {
  stray_lon_ = lon;
  stray_lat_ = lat;
}

/// Sutherland and Hodgman's clipping by one side, 1974; each new position is computed from the triangle itself.
void Cutter::cut(Polygon& polygon, const std::array<Corner, 3>& corners, Axis axis, double at, bool keep_above) const {
  const bool lon = axis == Axis::kLon;
  const auto kept = [&](const Point& p) { return keep_above ? along(p.at, lon) >= at : along(p.at, lon) <= at; };
  Polygon out;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Point &p = polygon[i], &q = polygon[(i + 1) % polygon.size()];
    const bool p_kept = kept(p), q_kept = kept(q);
    if (p_kept) out.push_back(p);
    if (p_kept == q_kept) continue;
    Point crossing;
    if (p.edge == kCutSide) {
      crossing.at = on_plane(corners, lon ? at : p.at.lon, lon ? p.at.lat : at);
    } else {
      const auto edge = static_cast<std::size_t>(p.edge);
      crossing.at = on_edge(corners[edge], corners[(edge + 1) % 3], lon, at);
    }
    crossing.edge = p_kept ? kCutSide : p.edge;  // leaving: along the side to where the polygon comes back
    out.push_back(crossing);
  }
  polygon.swap(out);
}

std::uint32_t Cutter::vertex(const Corner& at) {
  QuantizedVertex q;
  q.u = quantised(at.lon, rectangle_.west, rectangle_.east);
  q.v = quantised(at.lat, rectangle_.south, rectangle_.north);
  q.h = heights_.quantised(at.height);
  q.normal = unit(at.normal);
  const std::uint32_t key = std::uint32_t{q.u} << 16 | q.v;
  const auto [entry, fresh] = vertices_.try_emplace(key, static_cast<std::uint32_t>(mesh_.vertices.size()));
  if (fresh) {
    mesh_.vertices.push_back(q);
  } else if (auto& known = mesh_.vertices[entry->second]; q.h > known.h) {
    known = q;  // of positions that fall together the highest stands, whichever comes first
  }
  return entry->second;
}

/// Remembers how steep the terrain is, for the error.
void Cutter::add_slope(const std::array<Corner, 3>& c) {
  any_terrain_ = true;
  const double x1 = c[1].lon - c[0].lon, y1 = c[1].lat - c[0].lat, z1 = c[1].height - c[0].height;
  const double x2 = c[2].lon - c[0].lon, y2 = c[2].lat - c[0].lat, z2 = c[2].height - c[0].height;
  const double area = x1 * y2 - x2 * y1;
  if (!(area > 0)) return;
  steepest_lon_ = std::max(steepest_lon_, std::abs(z1 * y2 - z2 * y1) / area);
  steepest_lat_ = std::max(steepest_lat_, std::abs(z2 * x1 - z1 * x2) / area);
}

void Cutter::add(const std::array<Corner, 3>& corners, bool terrain) {
  polygon_.clear();
  for (int i = 0; i < 3; ++i) polygon_.push_back({corners[static_cast<std::size_t>(i)], i});
  cut(polygon_, corners, Axis::kLon, rectangle_.west, true);
  cut(polygon_, corners, Axis::kLon, rectangle_.east, false);
  cut(polygon_, corners, Axis::kLat, rectangle_.south, true);
  cut(polygon_, corners, Axis::kLat, rectangle_.north, false);
  if (polygon_.empty()) return;
  // Positions that only touch the tile are vertices too: the neighbour has them, and may have them higher.
  std::vector<std::uint32_t> corner;
  for (const Point& p : polygon_) corner.push_back(vertex(p.at));
  if (terrain) add_slope(corners);
  for (std::size_t i = 1; i + 1 < corner.size(); ++i) {
    const std::array<std::uint32_t, 3> triangle{corner[0], corner[i], corner[i + 1]};
    const auto& a = mesh_.vertices[triangle[0]];
    const auto& b = mesh_.vertices[triangle[1]];
    const auto& c = mesh_.vertices[triangle[2]];
    const std::int64_t area = (std::int64_t{b.u} - a.u) * (std::int64_t{c.v} - a.v) - (std::int64_t{c.u} - a.u) * (std::int64_t{b.v} - a.v);
    if (area > 0) mesh_.triangles.push_back(triangle);
  }
}

Result<TerrainTile> Cutter::finish() {
  if (mesh_.triangles.empty()) return error(Code::kNotFound, "There is nothing in this tile.");
  // The format knows no vertices without triangles.
  std::vector<std::uint32_t> place(mesh_.vertices.size(), 0);
  for (const auto& triangle : mesh_.triangles) {
    for (const std::uint32_t corner : triangle) place[corner] = 1;
  }
  std::uint32_t used = 0;
  for (std::size_t i = 0; i < place.size(); ++i) {
    if (place[i] == 0) continue;
    mesh_.vertices[used] = mesh_.vertices[i];
    place[i] = used++;
  }
  mesh_.vertices.resize(used);
  for (auto& triangle : mesh_.triangles) {
    for (std::uint32_t& corner : triangle) corner = place[corner];
  }
  TerrainTile tile{std::move(mesh_), -1};
  if (any_terrain_) {
    // A position is rounded by half a step, or kept off a side by a whole one.
    const double lon = (rectangle_.east - rectangle_.west) / kQuantizedMax + stray_lon_,
                 lat = (rectangle_.north - rectangle_.south) / kQuantizedMax + stray_lat_;
    tile.error_m = heights_.step_m / 2 + steepest_lon_ * lon + steepest_lat_ * lat;
  }
  return tile;
}

}  // namespace server::tiles
