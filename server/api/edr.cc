// /tins/{tin}/collections/surface/{position|trajectory|area|cube}: the surface by OGC API EDR, as
// CoverageJSON, GeoJSON, or a page.
#include "server/api/edr.h"

#include <algorithm>
#include <cmath>

#include "proto/edr.h"
#include "proto/formats/geojson.h"
#include "proto/wkt.h"
#include "server/api/coverage.h"
#include "server/api/edr_internal.h"
#include "server/api/elevation.h"
#include "server/api/export_grid.h"
#include "server/api/feature_query.h"
#include "server/api/links.h"
#include "server/api/routes.h"
#include "server/api/surface_work.h"
#include "server/http/field_value.h"
#include "tin/query/profile.h"

namespace server::api {

using edr::Asked;
using edr::Coverages;
using edr::Format;
using edr::node;
using edr::swapped_if;
using proto::Levels;
using proto::Position2;
using proto::SurfaceCoverage;
using proto::WktGeometry;
using tin::base::Code;
using tin::base::error;
using tin::terrain::Terrain;

namespace {

using Kind = WktGeometry::Kind;

constexpr std::string_view kPositionQuery = "position", kTrajectory = "trajectory", kArea = "area",
                           kCube = "cube";
/// Nodes on a side of a grid, at most, and at least where nobody asks for a number.
constexpr std::int64_t kMostNodes = 10'000, kFewestNodes = 17;

Result<Format> format_of(const Request& request) {
  if (const auto name = request.query_value("f")) {
    const std::string lower = http::lower_case(*name);
    if (lower == http::lower_case(proto::kCoverageJson)) return Format::kCoverageJson;
    if (lower == http::lower_case(proto::kGeoJsonName)) return Format::kGeoJson;
    return error(Code::kMalformed, "The formats are CoverageJSON and GeoJSON.", "query:f");
  }
  if (wants_html(request)) return Format::kPage;
  const bool geojson = http::prefers(request.header("accept"), proto::formats::kGeoJsonMediaType,
                                     proto::kCovJsonMediaType);
  return geojson ? Format::kGeoJson : Format::kCoverageJson;
}

Result<Asked> read_asked(const app::Tin& tin, const Request& request, bool has_distance) {
  if (!has_surface(tin.summary()))
    return error(Code::kNotFound, "The TIN has no surface with a place on the globe.");
  Asked asked{tin.version(), {}, {}, {}, {}};
  const auto format = format_of(request);
  if (!format) return format.error();
  asked.format = *format;
  auto crs = wire_crs(asked.version.terrain->frame(), request.query_value("crs"), "query:crs");
  if (!crs) return crs.error();
  asked.crs = std::move(*crs);
  if (auto fine = check_datetime(request); !fine) return fine.error();
  if (const auto z = request.query_value("z")) {
    auto levels = Levels::parse(*z, "query:z");
    if (!levels) return as_bad_parameter(levels.error());
    asked.levels = std::move(*levels);
  }
  const auto parameters = proto::parse_parameter_names(request.query_value("parameter-name"), has_distance,
                                                       "query:parameter-name");
  if (!parameters) return parameters.error();
  asked.parameters = *parameters;
  return asked;
}

/// The geometry of "coords", easting or longitude first. Errors: kMalformed also for kinds other than `one`
/// and `many`.
Result<WktGeometry> read_coords(const Request& request, const Asked& asked, std::int64_t most, Kind one,
                                Kind many, const std::string& wanted) {
  const auto text = request.query_value("coords");
  if (!text) return error(Code::kMalformed, "The parameter coords is missing.", "query:coords");
  auto geometry = proto::parse_wkt(*text, static_cast<std::size_t>(most), "query:coords");
  if (!geometry) return as_bad_parameter(geometry.error());
  if (geometry->kind != one && geometry->kind != many)
    return error(Code::kMalformed, "This query takes " + wanted + ".", "query:coords");
  for (auto& part : geometry->parts) {
    for (auto& sequence : part) {
      for (Position2& at : sequence) at = swapped_if(asked.crs.northing_first, at);
    }
  }
  return geometry;
}

/// Takes away the elevations that "z" does not select.
void keep_levels(const Asked& asked, std::vector<std::optional<double>>& elevations) {
  if (!asked.levels) return;
  for (auto& z : elevations) {
    if (z && !asked.levels->contains(*z)) z.reset();
  }
}

Result<std::vector<std::optional<double>>> sample(const Asked& asked, std::vector<double> x,
                                                  std::vector<double> y) {
  auto z = elevations_at(*asked.version.terrain, asked.crs.name, "query:crs", {}, std::move(x), std::move(y));
  if (z) keep_levels(asked, *z);
  return z;
}

Result<Coverages> position(const Context& context, const Request& request, const Asked& asked) {
  const auto geometry = read_coords(request, asked, context.config.limits.positions_per_request, Kind::kPoint,
                                    Kind::kMultiPoint, "a POINT or a MULTIPOINT");
  if (!geometry) return geometry.error();
  SurfaceCoverage coverage;
  coverage.at = geometry->parts[0][0];
  coverage.single = geometry->kind == Kind::kPoint;
  std::vector<double> x, y;
  for (const Position2& at : coverage.at) {
    x.push_back(at.x);
    y.push_back(at.y);
  }
  auto z = sample(asked, std::move(x), std::move(y));
  if (!z) return z.error();
  coverage.elevation = std::move(*z);
  return Coverages{std::move(coverage)};
}

Result<Coverages> trajectory(const Context& context, const Request& request, const Asked& asked) {
  const auto& limits = context.config.limits;
  const auto geometry = read_coords(request, asked, limits.positions_per_request, Kind::kLineString,
                                    Kind::kMultiLineString, "a LINESTRING or a MULTILINESTRING");
  if (!geometry) return geometry.error();
  const Terrain& terrain = *asked.version.terrain;
  const auto ground = ground_of(terrain);
  if (!ground) return ground.error();
  auto positions = SurfacePositions::make(terrain, asked.crs.name, "query:crs");
  if (!positions) return positions.error();
  Coverages coverages;
  std::size_t room = static_cast<std::size_t>(limits.answer_positions);
  for (const auto& part : geometry->parts) {
    const auto line = positions->to_lattice(part[0], "query:coords");
    if (!line) return error(line.error().code, line.error().message, "query:coords");
    const auto points = tin::query::profile(terrain, *ground, *line, tin::query::Voids::kKeep, room);
    if (!points) return points.error();
    room -= points->size();
    SurfaceCoverage& coverage = coverages.emplace_back();
    std::vector<tin::frame::Place> places;
    for (const auto& point : *points) {
      places.push_back(point.at);
      coverage.elevation.push_back(point.z);
      coverage.distance.push_back(point.distance);
    }
    coverage.at = positions->from_lattice(places);
    keep_levels(asked, coverage.elevation);
  }
  return coverages;
}

// Grids -----------------------------------------------------------------------------------------------

using tin::frame::Extent;

/// How many nodes a parameter asks for; 0: as close as the vertices lie; nothing: as close as that, within
/// limits.
Result<std::optional<std::int64_t>> read_resolution(const Request& request, const std::string& name) {
  const auto text = request.query_value(name);
  if (!text) return std::optional<std::int64_t>();
  const auto count = proto::parse_count(*text, 0, static_cast<std::uint64_t>(kMostNodes), "query:" + name);
  if (!count) return as_bad_parameter(count.error());
  return std::optional(static_cast<std::int64_t>(*count));
}

/// The nodes of a side: from one end to the other.
SurfaceCoverage::Axis axis(double low, double high, std::int64_t count) {
  if (high == low || count == 1) return {(low + high) / 2, (low + high) / 2, 1};
  return {low, high, count};
}

/// How many nodes a query wants along x and y.
struct Resolution {
  std::optional<std::int64_t> x, y;
};

Result<Resolution> read_resolutions(const Request& request) {
  const auto x = read_resolution(request, "resolution-x"), y = read_resolution(request, "resolution-y");
  if (!x) return x.error();
  if (!y) return y.error();
  return Resolution{*x, *y};
}

/// A grid over a box, without elevations. Errors: kTooLarge.
Result<SurfaceCoverage> lay_grid(const Context& context, const Resolution& wanted, const Terrain& terrain,
                                 const Extent& all, const Extent& box) {
  const double cell = std::sqrt((all.max_x - all.min_x) * (all.max_y - all.min_y) /
                                static_cast<double>(std::max<std::size_t>(1, terrain.vertex_count())));
  const auto as_vertices = [cell](double length) {
    return static_cast<std::int64_t>(std::min(std::ceil(length / cell), 1e9)) + 1;
  };
  const auto most = context.config.limits.answer_positions;
  const auto otherwise = [&](double length) {
    const auto side = static_cast<std::int64_t>(std::sqrt(static_cast<double>(most)));
    const std::int64_t fewest = std::min(kFewestNodes, side);
    return std::clamp(as_vertices(length), fewest, std::max(fewest, std::min(kMostNodes, side)));
  };
  const auto choose = [&](const std::optional<std::int64_t>& asked, double length) {
    if (!asked) return otherwise(length);
    return *asked == 0 ? as_vertices(length) : *asked;
  };
  SurfaceCoverage grid;
  grid.x = axis(box.min_x, box.max_x, choose(wanted.x, box.max_x - box.min_x));
  grid.y = axis(box.min_y, box.max_y, choose(wanted.y, box.max_y - box.min_y));
  if (grid.x.count > kMostNodes || grid.y.count > kMostNodes || grid.x.count * grid.y.count > most) {
    return error(Code::kTooLarge,
                 "The answer would have more than " + std::to_string(most) + " positions, or more than " +
                     std::to_string(kMostNodes) +
                     " along a side, the limits here: ask for a smaller resolution-x and -y.");
  }
  return grid;
}

/// Whether places of a row lie in polygons: even-odd in each, and in any of them.
class RowMask {
 public:
  explicit RowMask(const std::vector<std::vector<WktGeometry::Sequence>>& polygons) : polygons_(polygons) {}

  /// Places on the boundary may count as inside or outside.
  void inside(const SurfaceCoverage::Axis& x, double y, std::vector<bool>& out) {
    out.assign(static_cast<std::size_t>(x.count), false);
    for (const auto& polygon : polygons_) {
      crossings_.clear();
      for (const auto& ring : polygon) {
        for (std::size_t i = 1; i < ring.size(); ++i) cross(ring[i - 1], ring[i], y);
      }
      std::sort(crossings_.begin(), crossings_.end());
      std::size_t passed = 0;
      for (std::int64_t i = 0; i < x.count; ++i) {
        const double at = node(x, i);
        while (passed < crossings_.size() && crossings_[passed] < at) ++passed;
        if (passed % 2 == 1) out[static_cast<std::size_t>(i)] = true;
      }
    }
  }

 private:
  void cross(Position2 a, Position2 b, double y) {
    if ((a.y <= y) == (b.y <= y)) return;
    crossings_.push_back(a.x + (y - a.y) / (b.y - a.y) * (b.x - a.x));
  }

  const std::vector<std::vector<WktGeometry::Sequence>>& polygons_;
  std::vector<double> crossings_;
};

/// The part of a box in which the surface may lie; nothing when they do not meet.
std::optional<Extent> common(const Extent& a, const Extent& b) {
  const Extent both{std::max(a.min_x, b.min_x), std::max(a.min_y, b.min_y), std::min(a.max_x, b.max_x),
                    std::min(a.max_y, b.max_y)};
  if (both.min_x > both.max_x || both.min_y > both.max_y) return std::nullopt;
  return both;
}

/// Elevations on a grid over a box, within polygons if any are given. None: the box does not meet the
/// surface.
Result<Coverages> sample_grid(Context& context, const Request& request, const Asked& asked, const Extent& box,
                              const std::vector<std::vector<WktGeometry::Sequence>>& polygons) {
  const auto resolution = read_resolutions(request);
  if (!resolution) return resolution.error();
  const Slot slot(context.exports);
  if (!slot.taken()) return too_many_questions();
  const Terrain& terrain = *asked.version.terrain;
  auto from_own = Positions::between(terrain.frame().crs, asked.crs.name, "query:crs");
  if (!from_own) return from_own.error();
  const auto all = extent_in(terrain, *from_own);
  if (!all) return as_bad_parameter(all.error());
  const auto part = common(*all, box);
  if (!part) return Coverages{};
  auto grid = lay_grid(context, *resolution, terrain, *all, *part);
  if (!grid) return grid.error();
  RowMask mask(polygons);
  std::vector<bool> inside(static_cast<std::size_t>(grid->x.count), true);
  std::vector<double> x, y;
  std::vector<std::size_t> which;
  for (std::int64_t j = 0; j < grid->y.count; ++j) {
    const double row = node(grid->y, j);
    if (!polygons.empty()) mask.inside(grid->x, row, inside);
    for (std::int64_t i = 0; i < grid->x.count; ++i) {
      if (!inside[static_cast<std::size_t>(i)]) continue;
      x.push_back(node(grid->x, i));
      y.push_back(row);
      which.push_back(static_cast<std::size_t>(j * grid->x.count + i));
    }
  }
  const auto z = sample(asked, std::move(x), std::move(y));
  if (!z) return z.error();
  grid->elevation.resize(static_cast<std::size_t>(grid->x.count * grid->y.count));
  for (std::size_t k = 0; k < which.size(); ++k) grid->elevation[which[k]] = (*z)[k];
  return Coverages{std::move(*grid)};
}

Result<Coverages> area(Context& context, const Request& request, const Asked& asked) {
  const auto geometry = read_coords(request, asked, context.config.limits.polygon_positions, Kind::kPolygon,
                                    Kind::kMultiPolygon, "a POLYGON or a MULTIPOLYGON");
  if (!geometry) return geometry.error();
  Extent box{INFINITY, INFINITY, -INFINITY, -INFINITY};
  for (const auto& polygon : geometry->parts) {
    for (const Position2& at : polygon[0]) {
      box = {std::min(box.min_x, at.x), std::min(box.min_y, at.y), std::max(box.max_x, at.x),
             std::max(box.max_y, at.y)};
    }
  }
  return sample_grid(context, request, asked, box, geometry->parts);
}

Result<Coverages> cube(Context& context, const Request& request, Asked& asked) {
  if (!request.query_value("bbox"))
    return error(Code::kMalformed, "The parameter bbox is missing.", "query:bbox");
  const auto boxes = read_boxes(request, asked.crs);
  if (!boxes) return boxes.error();
  if (boxes->size() != 1)
    return error(Code::kMalformed, "A cube cannot go over the antimeridian.", "query:bbox");
  const proto::Bbox& box = boxes->front();
  if (box.min_z && !asked.levels) asked.levels = Levels::between(*box.min_z, *box.max_z);
  return sample_grid(context, request, asked, {box.min_x, box.min_y, box.max_x, box.max_y}, {});
}

/// 204: the query is fine, and nothing of the surface lies there.
template <class F>
Result<Response> query(Context& context, const Request& request, bool has_distance, const F& find) {
  const auto tin = context.catalogue.find(request.path_parameter("tin"));
  if (!tin) return tin.error();
  auto asked = read_asked(**tin, request, has_distance);
  if (!asked) return asked.error();
  const auto coverages = find(context, request, *asked);
  if (!coverages) return coverages.error();
  if (coverages->empty()) {
    return Response{204, {{"ETag", entity_tag(**tin, asked->version.revision, request)}}, std::string()};
  }
  return edr::answer(context, **tin, request, *asked, *coverages, coverages->size() > 1);
}

}  // namespace

void add_queries(proto::CollectionDocument& document, const std::string& self) {
  document.formats = {std::string(proto::kCoverageJson), std::string(proto::kGeoJsonName)};
  for (const auto& [type, title] :
       {std::pair(kPositionQuery, "Elevations at positions"), std::pair(kTrajectory, "Profiles along lines"),
        std::pair(kArea, "Elevations within polygons"), std::pair(kCube, "Elevations within a box")}) {
    const std::string href = self + "/" + std::string(type);
    document.queries.push_back({std::string(type), href, title, document.formats});
    document.links.push_back({href, "data", std::string(proto::kCovJsonMediaType), title});
  }
}

void add_edr(http::Router& router, Context& context) {
  using http::Method;
  const std::string base = "/tins/{tin}/collections/surface/";
  const auto add = [&](std::string_view name, std::vector<std::string> parameters, bool has_distance,
                       auto find) {
    for (const char* common : {"z", "datetime", "parameter-name", "crs", "f"})
      parameters.emplace_back(common);
    router.add({.method = Method::kGet,
                .pattern = base + std::string(name),
                .query = {parameters.begin(), parameters.end()},
                .handler = guarded([&context, has_distance, find](Request& request) {
                  return query(context, request, has_distance, find);
                })});
  };
  add(kPositionQuery, {"coords"}, false, position);
  add(kTrajectory, {"coords"}, true, trajectory);
  add(kArea, {"coords", "resolution-x", "resolution-y"}, false, area);
  add(kCube, {"bbox", "resolution-x", "resolution-y"}, false, cube);
}

}  // namespace server::api
