// Tiles of the lowest level: the TIN's own triangles, cut at the tile's sides; and around the terrain ground that slopes down to 0 m.
#include <algorithm>
#include <cmath>
#include <tuple>
#include <unordered_map>
#include <unordered_set>

#include "server/gdal/crs.h"
#include "server/tiles/cutter.h"
#include "server/tiles/terrain_tile_internal.h"

namespace server::tiles {

using proto::formats::TileRectangle;
using tin::base::Code;
using tin::base::error;
using tin::base::Result;
using tin::mesh::HalfEdge;
using tin::mesh::Mesh;
using tin::mesh::TriangleSlot;
using tin::mesh::VertexSlot;
using tin::terrain::Terrain;

namespace {

/// Metres on the ground of a unit of the terrain's CRS, in x and in y, in its middle.
Result<std::array<double, 2>> unit_metres(const Terrain& terrain, const TileRectangle& extent) {
  const auto crs = gdal::read_crs(terrain.frame().crs);
  if (!crs) return error(Code::kNotFound, crs.error().message);
  if (!crs->scale.geographic) return std::array<double, 2>{crs->scale.unit_m, crs->scale.unit_m};
  const auto metres = tin::frame::degree_lengths((extent.south + extent.north) / 2);
  return std::array<double, 2>{metres.lon_m, metres.lat_m};
}

/// The direction up from the surface at a vertex: the mean over its triangles, by their angles' sines and lengths.
std::array<float, 3> vertex_normal(const Terrain& terrain, VertexSlot v, const std::array<double, 2>& metres) {
  const Mesh& mesh = terrain.mesh();
  const auto world = [&](VertexSlot slot) {
    const auto at = mesh.point(slot);
    return std::array<double, 3>{terrain.frame().x.world(at.x) * metres[0], terrain.frame().y.world(at.y) * metres[1],
                                 terrain.z(slot) * terrain.frame().vertical_unit_m};
  };
  std::array<double, 3> sum{};
  const auto a = world(v);
  const TriangleSlot first = mesh.triangle_at(v);
  TriangleSlot t = first;
  do {
    const int i = mesh.index_of(t, v);
    if (!mesh.is_infinite(t)) {
      const auto b = world(mesh.vertex(t, tin::mesh::next3(i))), c = world(mesh.vertex(t, tin::mesh::prev3(i)));
      const std::array<double, 3> p{b[0] - a[0], b[1] - a[1], b[2] - a[2]}, q{c[0] - a[0], c[1] - a[1], c[2] - a[2]};
      sum[0] += p[1] * q[2] - p[2] * q[1];
      sum[1] += p[2] * q[0] - p[0] * q[2];
      sum[2] += p[0] * q[1] - p[1] * q[0];
    }
    t = mesh.twin(t, tin::mesh::next3(i)).triangle();
  } while (t != first);
  const double size = std::sqrt(sum[0] * sum[0] + sum[1] * sum[1] + sum[2] * sum[2]);
  if (!(size > 0)) return {0, 0, 1};
  return {static_cast<float>(sum[0] / size), static_cast<float>(sum[1] / size), static_cast<float>(sum[2] / size)};
}

/// The vertices of a terrain in longitude and latitude, converted as they are needed, many at a time.
class Places {
 public:
  static Result<Places> create(const Terrain& terrain, const TileRectangle& extent) {
    const auto metres = unit_metres(terrain, extent);
    if (!metres) return metres.error();
    Places places(terrain, *metres);
    if (terrain.frame().crs != "EPSG:4326") {
      auto way = gdal::CrsTransform::create(terrain.frame().crs, "EPSG:4326");
      if (!way) return error(Code::kNotFound, way.error().message);
      places.to_lon_lat_ = std::move(*way);
    }
    return places;
  }

  void want(VertexSlot v) {
    if (places_.try_emplace(v.value()).second) wanted_.push_back(v);
  }
  /// Converts what is wanted.
  void fetch() {
    std::vector<double> x, y;
    for (const VertexSlot v : wanted_) {
      const auto at = terrain_.mesh().point(v);
      x.push_back(terrain_.frame().x.world(at.x));
      y.push_back(terrain_.frame().y.world(at.y));
    }
    std::vector<std::uint8_t> ok(x.size(), 1);
    if (to_lon_lat_) to_lon_lat_->transform(x, y, ok);
    for (std::size_t i = 0; i < wanted_.size(); ++i) {
      places_[wanted_[i].value()] = {x[i], y[i], terrain_.z(wanted_[i]) * terrain_.frame().vertical_unit_m,
                                     vertex_normal(terrain_, wanted_[i], metres_)};
    }
    wanted_.clear();
  }
  /// Requires: wanted and fetched.
  const Corner& operator[](VertexSlot v) const { return places_.at(v.value()); }

 private:
  Places(const Terrain& terrain, const std::array<double, 2>& metres) : terrain_(terrain), metres_(metres) {}
  const Terrain& terrain_;
  const std::array<double, 2> metres_;  // on the ground, of a unit of the CRS
  std::optional<gdal::CrsTransform> to_lon_lat_;
  std::unordered_map<std::uint32_t, Corner> places_;
  std::vector<VertexSlot> wanted_;
};

bool finite(const std::array<Corner, 3>& c) {
  return std::all_of(c.begin(), c.end(), [](const Corner& p) { return std::isfinite(p.lon) && std::isfinite(p.lat); });
}

/// Whether the bounding boxes meet: enough to gather triangles by.
bool near(const std::array<Corner, 3>& c, const TileRectangle& r) {
  const auto [west, east] = std::minmax({c[0].lon, c[1].lon, c[2].lon});
  const auto [south, north] = std::minmax({c[0].lat, c[1].lat, c[2].lat});
  return west <= r.east && east >= r.west && south <= r.north && north >= r.south;
}

/// Gathers the triangles whose boxes meet the tile, and says whether it reaches over the hull.
class Gatherer {
 public:
  Gatherer(const Terrain& terrain, Places& places, const TileRectangle& rectangle)
      : mesh_(terrain.mesh()), places_(places), rectangle_(rectangle) {}

  void start_from(TriangleSlot t) {
    if (!mesh_.is_infinite(t) && seen_.insert(t.value()).second) front_.push_back(t);
  }

  void run() {
    while (!front_.empty()) {
      for (const TriangleSlot t : front_) {
        for (int i = 0; i < 3; ++i) places_.want(mesh_.vertex(t, i));
      }
      places_.fetch();
      std::vector<TriangleSlot> next;
      next.swap(front_);
      for (const TriangleSlot t : next) visit(t);
    }
    // Storage order must not show in the tile.
    std::sort(found_.begin(), found_.end(), [&](TriangleSlot a, TriangleSlot b) { return key(a) < key(b); });
  }

  const std::vector<TriangleSlot>& found() const { return found_; }
  bool reaches_hull() const { return reaches_hull_; }
  std::array<Corner, 3> corners(TriangleSlot t) const {
    return {places_[mesh_.vertex(t, 0)], places_[mesh_.vertex(t, 1)], places_[mesh_.vertex(t, 2)]};
  }

 private:
  std::array<tin::exact::Point, 3> key(TriangleSlot t) const {
    std::array<tin::exact::Point, 3> points{mesh_.point(mesh_.vertex(t, 0)), mesh_.point(mesh_.vertex(t, 1)),
                                            mesh_.point(mesh_.vertex(t, 2))};
    std::rotate(points.begin(), std::min_element(points.begin(), points.end()), points.end());
    return points;
  }
  void visit(TriangleSlot t) {
    const auto c = corners(t);
    if (!finite(c) || !near(c, rectangle_)) return;
    found_.push_back(t);
    for (int i = 0; i < 3; ++i) {
      const TriangleSlot other = mesh_.twin(t, i).triangle();
      if (mesh_.is_infinite(other)) reaches_hull_ = true;
      start_from(other);
    }
  }

  const Mesh& mesh_;
  Places& places_;
  const TileRectangle rectangle_;
  std::vector<TriangleSlot> front_, found_;
  std::unordered_set<std::uint32_t> seen_;
  bool reaches_hull_ = false;
};

/// The hull's edges as their triangles have them, counter-clockwise from the smallest vertex on.
std::vector<HalfEdge> hull_of(const Mesh& mesh) {
  std::vector<HalfEdge> around, hull;
  mesh.link(tin::mesh::kInfinite, around);
  for (const HalfEdge edge : around) hull.push_back(mesh.twin(edge));
  std::reverse(hull.begin(), hull.end());  // around what is outside they run clockwise
  const auto smaller = [&](HalfEdge a, HalfEdge b) { return mesh.point(mesh.origin(a)) < mesh.point(mesh.origin(b)); };
  std::rotate(hull.begin(), std::min_element(hull.begin(), hull.end(), smaller), hull.end());
  return hull;
}

/// Triangles between the hull and a rectangle around it, at whose corners the ground is at 0 m.
std::vector<std::array<Corner, 3>> surrounding_ground(const std::vector<Corner>& hull, const TileRectangle& around) {
  const std::array<Corner, 4> frame{Corner{around.west, around.south, 0}, Corner{around.east, around.south, 0},
                                    Corner{around.east, around.north, 0}, Corner{around.west, around.north, 0}};
  // The corner that lies farthest out over the edge from a to b.
  const auto farthest = [&](const Corner& a, const Corner& b) {
    const double out_x = b.lat - a.lat, out_y = a.lon - b.lon;
    std::size_t best = 0;
    for (std::size_t k = 1; k < 4; ++k) {
      if (out_x * frame[k].lon + out_y * frame[k].lat > out_x * frame[best].lon + out_y * frame[best].lat) best = k;
    }
    return best;
  };
  std::vector<std::array<Corner, 3>> ground;
  const std::size_t n = hull.size();
  std::size_t corner = farthest(hull[n - 1], hull[0]);
  std::size_t turns = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const Corner &a = hull[i], &b = hull[(i + 1) % n];
    // At each hull vertex on to the next edge's corner, never back: the hull may be a hair off convex here.
    const std::size_t ahead = (farthest(a, b) + 4 - corner) % 4;
    for (std::size_t k = 0; k < ahead && ahead < 3 && turns < 4; ++k, ++turns) {
      ground.push_back({a, frame[corner], frame[(corner + 1) % 4]});
      corner = (corner + 1) % 4;
    }
    ground.push_back({b, a, frame[corner]});
  }
  return ground;
}

/// The rectangle that the ground around the terrain reaches to: two tiles beyond those that there are.
TileRectangle ground_rectangle(const Tileset& tiles, int level) {
  const auto [x0, y0, x1, y1] = tiles.available(level);
  const double size = tile_degrees(level);
  return {-180 + size * (x0 - 2.0), -90 + size * (y0 - 2.0), -180 + size * (x1 + 3.0), -90 + size * (y1 + 3.0)};
}

/// Where a gathering may begin: triangles at some places in the tile.
void seed(const Terrain& terrain, const TileRectangle& r, Gatherer& gatherer) {
  constexpr int kSeeds = 5;
  std::vector<double> x, y;
  for (int j = 0; j < kSeeds; ++j) {
    for (int i = 0; i < kSeeds; ++i) {
      x.push_back(r.west + (r.east - r.west) * i / (kSeeds - 1));
      y.push_back(r.south + (r.north - r.south) * j / (kSeeds - 1));
    }
  }
  std::vector<std::uint8_t> ok(x.size(), 1);
  if (terrain.frame().crs != "EPSG:4326") {
    auto way = gdal::CrsTransform::create("EPSG:4326", terrain.frame().crs);
    if (!way) return;
    way->transform(x, y, ok);
  }
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (ok[i] == 0) continue;
    const auto at = terrain.frame().to_lattice(x[i], y[i]);
    if (!at) continue;
    const auto where = terrain.triangulation().locate(*at);
    if (where.kind != tin::delaunay::Location::Kind::kOutsideHull) gatherer.start_from(where.triangle);
  }
}

/// How far the middle of the longest edge, which is straight in the terrain's CRS, lies from the straight line in longitude and
/// latitude: twice that, since another edge may bend more.
std::array<double, 2> longest_stray(const Terrain& terrain, const Gatherer& gatherer) {
  const Mesh& mesh = terrain.mesh();
  if (terrain.frame().crs == "EPSG:4326" || gatherer.found().empty()) return {0, 0};
  double longest = -1;
  TriangleSlot of = gatherer.found().front();
  int side = 0;
  for (const TriangleSlot t : gatherer.found()) {
    for (int i = 0; i < 3; ++i) {
      const auto a = mesh.point(mesh.vertex(t, i)), b = mesh.point(mesh.vertex(t, tin::mesh::next3(i)));
      const double length = std::hypot(static_cast<double>(a.x) - b.x, static_cast<double>(a.y) - b.y);
      if (length > longest) std::tie(longest, of, side) = std::tuple(length, t, i);
    }
  }
  const auto corners = gatherer.corners(of);
  const auto a = mesh.point(mesh.vertex(of, side)), b = mesh.point(mesh.vertex(of, tin::mesh::next3(side)));
  double x = terrain.frame().x.world((static_cast<double>(a.x) + b.x) / 2), y = terrain.frame().y.world((static_cast<double>(a.y) + b.y) / 2);
  std::uint8_t ok = 1;
  auto way = gdal::CrsTransform::create(terrain.frame().crs, "EPSG:4326");
  if (!way || !way->transform({&x, 1}, {&y, 1}, {&ok, 1})) return {0, 0};
  const Corner &p = corners[static_cast<std::size_t>(side)], &q = corners[static_cast<std::size_t>(tin::mesh::next3(side))];
  return {2 * std::abs((p.lon + q.lon) / 2 - x), 2 * std::abs((p.lat + q.lat) / 2 - y)};
}

}  // namespace

Result<TerrainTile> make_cut_tile(const Terrain& terrain, const Tileset& tiles, const TileId& id) {
  const Mesh& mesh = terrain.mesh();
  auto places = Places::create(terrain, tiles.extent);
  if (!places) return places.error();
  const TileRectangle rectangle = geographic_rectangle(id);
  Gatherer gatherer(terrain, *places, rectangle);
  seed(terrain, rectangle, gatherer);
  gatherer.run();
  std::vector<Corner> ring;
  if (gatherer.found().empty() || gatherer.reaches_hull()) {
    const std::vector<HalfEdge> hull = hull_of(mesh);
    for (const HalfEdge edge : hull) places->want(mesh.origin(edge));
    places->fetch();
    for (const HalfEdge edge : hull) {
      const Corner &a = (*places)[mesh.origin(edge)], &b = (*places)[mesh.destination(edge)];
      ring.push_back(a);
      if (near({a, b, b}, rectangle)) gatherer.start_from(edge.triangle());  // what only touches the tile
    }
    gatherer.run();
  }
  Cutter cutter(rectangle, tiles.heights);
  const auto stray = longest_stray(terrain, gatherer);
  cutter.set_stray(stray[0], stray[1]);
  for (const TriangleSlot t : gatherer.found()) cutter.add(gatherer.corners(t), true);
  if (!ring.empty()) {
    for (const auto& triangle : surrounding_ground(ring, ground_rectangle(tiles, id.z))) cutter.add(triangle, false);
  }
  return cutter.finish();
}

Result<TerrainTile> make_terrain_tile(const Terrain& terrain, const Tileset& tiles, const TileId& id) {
  return tiles.is_lowest(id) ? make_cut_tile(terrain, tiles, id) : make_grid_tile(terrain, tiles, id);
}

}  // namespace server::tiles
