// /tins/{tin}/collections/surface: the surface as a coverage, sampled on the grid that is asked for.
#include "server/api/coverage.h"

#include <cmath>
#include <filesystem>
#include <optional>
#include <tuple>

#include "proto/coverage_documents.h"
#include "proto/crs_uri.h"
#include "server/api/collections.h"
#include "server/api/edr.h"
#include "server/api/export_grid.h"
#include "server/api/feature_query.h"
#include "server/api/file_body.h"
#include "server/api/links.h"
#include "server/api/routes.h"
#include "server/gdal/geotiff.h"
#include "server/tiles/sampler.h"

namespace server::api {

using tin::base::Code;
using tin::base::error;
using tin::terrain::Terrain;

namespace {

constexpr std::string_view kTiff = "image/tiff; application=geotiff";
constexpr double kNoData = -9999;
/// Rows sampled at a time.
constexpr int kBand = 64;

struct Axes {
  std::optional<std::pair<double, double>> x, y;  // low and high, or twice the one number
};

bool is_x(std::string_view name) {
  return name == "long" || name == "lon" || name == "longitude" || name == "x" || name == "e";
}
bool is_y(std::string_view name) {
  return name == "lat" || name == "latitude" || name == "y" || name == "n";
}

/// "Long(7:8),Lat(45:46)" or "Long(100),Lat(50)". Errors: kMalformed.
Result<Axes> parse_axes(std::string_view text, const std::string& where) {
  const auto wrong = [&] {
    return error(Code::kMalformed, "Axes are given like Long(7:8),Lat(45:46), or with one number each for sizes.", where);
  };
  Axes axes;
  while (!text.empty()) {
    const std::size_t open = text.find('('), close = text.find(')');
    if (open == std::string_view::npos || close == std::string_view::npos || close < open) return wrong();
    const std::string name = http::lower_case(text.substr(0, open));
    const std::string_view inner = text.substr(open + 1, close - open - 1);
    text.remove_prefix(close + 1);
    if (!text.empty() && text.front() != ',') return wrong();
    if (!text.empty()) text.remove_prefix(1);
    const std::size_t colon = inner.find(':');
    const auto low = proto::parse_number(inner.substr(0, colon), where);
    const auto high = colon == std::string_view::npos ? low : proto::parse_number(inner.substr(colon + 1), where);
    if (!low || !high) return wrong();
    auto& axis = is_x(name) ? axes.x : axes.y;
    if (axis || !(is_x(name) || is_y(name)) || *low > *high) return wrong();
    axis = {*low, *high};
  }
  return axes;
}

struct Wanted {
  WireCrs crs;
  tin::frame::Extent extent;
  std::int64_t width = 0, height = 0;
};

/// The whole extent in a CRS, and about as many cells as the TIN has samples, or its source's own in that CRS.
Result<Wanted> whole(const Terrain& terrain, const WireCrs& crs) {
  auto positions = Positions::between(terrain.frame().crs, crs.name, "query:crs");
  if (!positions) return positions.error();
  const auto extent = extent_in(terrain, *positions);
  if (!extent) return as_bad_parameter(extent.error());
  Wanted wanted{crs, *extent, 1, 1};
  if (const auto* source = terrain.source_grid(); source != nullptr && positions->identity()) {
    const auto& gt = source->geotransform;
    const double x1 = gt[0] + source->width * gt[1], y1 = gt[3] + source->height * gt[5];
    wanted.extent = {std::min(gt[0], x1), std::min(gt[3], y1), std::max(gt[0], x1), std::max(gt[3], y1)};
    wanted.width = source->width;
    wanted.height = source->height;
    return wanted;
  }
  const double width = extent->max_x - extent->min_x, height = extent->max_y - extent->min_y;
  if (!(width > 0) || !(height > 0)) return error(Code::kNotFound, "The TIN has no area.");
  const double cell = std::sqrt(width * height / static_cast<double>(std::max<std::size_t>(1, terrain.vertex_count())));
  wanted.width = std::max<std::int64_t>(1, std::llround(std::min(width / cell, 1e6)));
  wanted.height = std::max<std::int64_t>(1, std::llround(std::min(height / cell, 1e6)));
  return wanted;
}

/// Takes the extent that bbox or subset name; cells keep about their size.
Result<void> take_box(const Request& request, Wanted& wanted) {
  const double cell_x = (wanted.extent.max_x - wanted.extent.min_x) / static_cast<double>(wanted.width),
               cell_y = (wanted.extent.max_y - wanted.extent.min_y) / static_cast<double>(wanted.height);
  const auto boxes = read_boxes(request, wanted.crs);
  if (!boxes) return boxes.error();
  if (boxes->size() > 1) return error(Code::kMalformed, "A coverage cannot go over the antimeridian.", "query:bbox");
  if (!boxes->empty()) {
    const proto::Bbox& box = boxes->front();
    wanted.extent = {box.min_x, box.min_y, box.max_x, box.max_y};
  }
  if (const auto text = request.query_value("subset")) {
    if (!boxes->empty()) return error(Code::kMalformed, "Give bbox or subset, not both.", "query:subset");
    const auto axes = parse_axes(*text, "query:subset");
    if (!axes) return axes.error();
    if (axes->x) std::tie(wanted.extent.min_x, wanted.extent.max_x) = *axes->x;
    if (axes->y) std::tie(wanted.extent.min_y, wanted.extent.max_y) = *axes->y;
  }
  if (!(wanted.extent.max_x > wanted.extent.min_x) || !(wanted.extent.max_y > wanted.extent.min_y)) {
    return error(Code::kMalformed, "The part asked for has no area.", request.query_value("bbox") ? "query:bbox" : "query:subset");
  }
  const auto cells = [](double length, double cell) { return std::max<std::int64_t>(1, std::llround(std::min(length / cell, 1e9))); };
  wanted.width = cells(wanted.extent.max_x - wanted.extent.min_x, cell_x);
  wanted.height = cells(wanted.extent.max_y - wanted.extent.min_y, cell_y);
  return {};
}

/// Takes the numbers of columns and rows that scale-size names, or scaleSize, as an older draft called it.
Result<void> take_size(const Request& request, Wanted& wanted) {
  for (const std::string name : {"scale-size", "scaleSize"}) {
    const auto text = request.query_value(name);
    if (!text) continue;
    const auto axes = parse_axes(*text, "query:" + name);
    if (!axes) return axes.error();
    for (const auto& [size, count] : {std::pair(axes->x, &wanted.width), std::pair(axes->y, &wanted.height)}) {
      if (!size) continue;
      if (!(size->first >= 1 && size->first <= 1e6) || size->first != std::floor(size->first)) {
        return error(Code::kMalformed, "A size is a whole number from 1 to 1000000.", "query:" + name);
      }
      *count = static_cast<std::int64_t>(size->first);
    }
  }
  return {};
}

Result<Wanted> read_wanted(const Context& context, const Request& request, const Terrain& terrain) {
  const auto crs = wire_crs(terrain.frame(), request.query_value("crs"), "query:crs");
  if (!crs) return crs.error();
  auto wanted = whole(terrain, *crs);
  if (!wanted) return wanted;
  const bool part = request.query_value("bbox") || request.query_value("subset");
  if (part) {
    if (auto taken = take_box(request, *wanted); !taken) return taken.error();
  }
  if (auto taken = take_size(request, *wanted); !taken) return taken.error();
  if (static_cast<double>(wanted->width) * static_cast<double>(wanted->height) >
      static_cast<double>(context.config.limits.export_pixels)) {
    return error(Code::kTooLarge, "The raster would have more than " + std::to_string(context.config.limits.export_pixels) +
                                      " pixels, the limit here: ask for a smaller scale-size.");
  }
  return wanted;
}

/// Rows of the raster, sampled some at a time.
class Rows {
 public:
  Rows(tiles::Sampler sampler, const Wanted& wanted, double unit_m)
      : sampler_(std::move(sampler)),
        wanted_(wanted),
        unit_m_(unit_m),
        dx_((wanted.extent.max_x - wanted.extent.min_x) / static_cast<double>(wanted.width)),
        dy_((wanted.extent.max_y - wanted.extent.min_y) / static_cast<double>(wanted.height)) {}

  void read(std::int64_t row, std::span<double> values) {
    if (row >= end_) {
      begin_ = row;
      end_ = std::min<std::int64_t>(row + kBand, wanted_.height);
      band_ = sampler_.heights({wanted_.extent.min_x + dx_ / 2, dx_, static_cast<int>(wanted_.width),
                                wanted_.extent.max_y - dy_ * (static_cast<double>(row) + 0.5), -dy_,
                                static_cast<int>(end_ - begin_)});
    }
    const double* from = band_.data() + (row - begin_) * wanted_.width;
    for (std::size_t i = 0; i < values.size(); ++i) values[i] = std::isnan(from[i]) ? kNoData : from[i] / unit_m_;
  }

 private:
  tiles::Sampler sampler_;
  const Wanted wanted_;
  const double unit_m_, dx_, dy_;
  std::int64_t begin_ = 0, end_ = 0;
  std::vector<double> band_;
};

Result<http::Body> raster(Context& context, const Request& request, const Terrain& terrain,
                          const Wanted& wanted) {
  const Patience patience(request, context.config.limits.export_seconds);
  return file_body(context, ".tif", [&](const std::filesystem::path& file) -> Result<void> {
    const std::string crs = wanted.crs.name == proto::kCrs84 ? "EPSG:4326" : wanted.crs.name;
    auto sampler = tiles::Sampler::create(terrain, crs);
    if (!sampler) return sampler.error();
    Rows rows(std::move(*sampler), wanted, terrain.frame().vertical_unit_m);
    const auto& box = wanted.extent;
    const auto columns = static_cast<double>(wanted.width), lines = static_cast<double>(wanted.height);
    gdal::RasterSpec spec;
    spec.width = wanted.width;
    spec.height = wanted.height;
    spec.crs = crs;
    spec.geotransform = {box.min_x, (box.max_x - box.min_x) / columns, 0, box.max_y,
                         0,         -(box.max_y - box.min_y) / lines};
    spec.nodata = kNoData;
    spec.vertical_unit = terrain.frame().vertical_unit;
    const auto source = [&](std::int64_t row, std::span<double> values) -> Result<void> {
      if (auto wait = patience.check(); !wait) return wait;
      rows.read(row, values);
      return {};
    };
    return gdal::write_geotiff(file, spec, source, nullptr);
  });
}

Result<Response> coverage(Context& context, const Request& request) {
  const auto tin = context.catalogue.find(request.path_parameter("tin"));
  if (!tin) return tin.error();
  const app::Version version = (*tin)->version();
  if (!has_surface((*tin)->summary())) return error(Code::kNotFound, "The TIN has no surface with a place on the globe.");
  const auto wanted = read_wanted(context, request, *version.terrain);
  if (!wanted) return wanted.error();
  auto body = raster(context, request, *version.terrain, *wanted);
  if (!body) return body.error();
  Response response;
  response.headers = {{"Content-Type", std::string(kTiff)},
                      {"Content-Disposition", "attachment; filename=\"" + (*tin)->id() + ".tif\""},
                      {"Content-Crs", "<" + wanted->crs.uri + ">"},
                      {"ETag", entity_tag(**tin, version.revision, request)}};
  response.body = std::move(*body);
  return response;
}

Result<Response> domain(Context& context, const Request& request) {
  const auto tin = context.catalogue.find(request.path_parameter("tin"));
  if (!tin) return tin.error();
  const app::Version version = (*tin)->version();
  if (!has_surface((*tin)->summary())) return error(Code::kNotFound, "The TIN has no surface with a place on the globe.");
  const auto crs = wire_crs(version.terrain->frame(), std::nullopt, "");
  if (!crs) return crs.error();
  const auto all = whole(*version.terrain, *crs);
  if (!all) return all.error();
  Response response = json_answer(proto::coverage_domain_json(
      {{all->extent.min_x, all->extent.min_y, all->extent.max_x, all->extent.max_y}, all->width, all->height}));
  response.headers.emplace_back("ETag", entity_tag(**tin, version.revision, request));
  return response;
}

Result<Response> range(Context& context, const Request& request) {
  const auto tin = context.catalogue.find(request.path_parameter("tin"));
  if (!tin) return tin.error();
  const app::Summary summary = (*tin)->summary();
  if (!has_surface(summary)) return error(Code::kNotFound, "The TIN has no surface with a place on the globe.");
  Response response = json_answer(proto::coverage_range_json(summary.frame.vertical_unit));
  response.headers.emplace_back("ETag", entity_tag(**tin, summary.revision, request));
  return response;
}

Result<Response> surface(Context& context, const Request& request) {
  const auto tin = context.catalogue.find(request.path_parameter("tin"));
  if (!tin) return tin.error();
  const app::Summary summary = (*tin)->summary();
  if (!has_surface(summary)) return error(Code::kNotFound, "The TIN has no surface with a place on the globe.");
  auto document = surface_document(**tin, summary);
  make_absolute(document, base_url(context.config, request));
  const HtmlPage page{document.title, document.description, document.links, {}, {}, {}};
  Response response = negotiated(request, proto::collection_json(document), kJson, page);
  response.headers.emplace_back("ETag", negotiated_tag(**tin, summary.revision, request));
  return response;
}

}  // namespace

bool has_surface(const app::Summary& summary) {
  return summary.triangle_count > 0 && geojson_bbox(summary).has_value();
}

proto::CollectionDocument surface_document(const app::Tin& tin, const app::Summary& summary) {
  proto::CollectionDocument document;
  document.id = "surface";
  document.title = "Surface";
  document.description = "The surface of the TIN as a coverage of elevations";
  document.features = false;
  document.bbox = geojson_bbox(summary);
  document.crs = offered_crs(summary.frame);
  document.storage_crs = proto::crs_uri(summary.frame.crs).value_or("");
  const std::string self = "/tins/" + tin.id() + "/collections/surface", relations = "http://www.opengis.net/def/rel/ogc/1.0/";
  document.links = {{self, "self", std::string(kJson), ""},
                    {self, "alternate", "text/html", "As a page"},
                    {self + "/coverage", relations + "coverage", std::string(kTiff), "Elevations"},
                    {self + "/coverage/domainset", relations + "coverage-domainset", std::string(kJson), "Where they are"},
                    {self + "/coverage/rangetype", relations + "coverage-rangetype", std::string(kJson), "What they are"}};
  add_queries(document, self);
  document.vertical_unit = summary.frame.vertical_unit;
  return document;
}

void add_coverage(http::Router& router, Context& context) {
  using http::Method;
  const auto on = [&context](auto f) {
    return guarded([&context, f](Request& request) { return f(context, request); });
  };
  const std::string base = "/tins/{tin}/collections/surface";
  router.add({.method = Method::kGet, .pattern = base, .handler = on(surface)});
  router.add({.method = Method::kGet,
              .pattern = base + "/coverage",
              .query = {"bbox", "subset", "scale-size", "scaleSize", "crs"},
              .handler = on(coverage)});
  router.add({.method = Method::kGet, .pattern = base + "/coverage/domainset", .handler = on(domain)});
  router.add({.method = Method::kGet, .pattern = base + "/coverage/rangetype", .handler = on(range)});
}

}  // namespace server::api
