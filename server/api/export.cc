// GET /tins/{tin}/export: the whole TIN, or a part, as a file.
#include <atomic>
#include <chrono>
#include <filesystem>

#include "proto/crs_uri.h"
#include "server/api/answer.h"
#include "server/api/export_grid.h"
#include "server/api/feature_reader.h"
#include "server/api/routes.h"
#include "server/api/surface_work.h"
#include "server/gdal/geotiff.h"

namespace server::api {

using proto::formats::Coordinates;
using proto::formats::GeoJsonWriter;
using tin::base::Code;
using tin::base::error;

namespace {

constexpr std::size_t kPiece = 64 * 1024;

/// A GeoJSON file made while the client takes it, from one version.
class GeoJsonSource : public http::BodySource {
 public:
  GeoJsonSource(app::Version version, FeatureKind kind, Positions positions,
                const std::optional<proto::Bbox>& box, Coordinates coordinates,
                std::optional<std::string> crs_urn)
      : version_(std::move(version)),
        kind_(kind),
        reader_(*version_.terrain, kind, {}, std::move(positions), box),
        writer_(buffer_, coordinates) {
    writer_.begin({std::nullopt, std::nullopt, {}, std::move(crs_urn)});
  }

  bool next(std::string& piece) override {
    while (!ended_ && buffer_.size() < kPiece) {
      if (const auto feature = reader_.next()) {
        write_feature(writer_, kind_, *feature);
      } else {
        writer_.end();
        ended_ = true;
      }
    }
    piece.swap(buffer_);
    buffer_.clear();
    return !piece.empty();
  }

 private:
  const app::Version version_;
  const FeatureKind kind_;
  FeatureReader reader_;
  std::string buffer_;
  GeoJsonWriter writer_;
  bool ended_ = false;
};

std::string attachment(const app::Tin& tin, std::string_view suffix) {
  return "attachment; filename=\"" + tin.id() + std::string(suffix) + "\"";
}

Result<Response> geojson(const app::Tin& tin, app::Version version, const ExportRequest& wanted,
                         FeatureKind kind) {
  const auto& frame = version.terrain->frame();
  auto positions = Positions::to_geojson(frame);
  Coordinates coordinates = frame.crs.empty() ? Coordinates::kProjected : Coordinates::kDegrees;
  std::optional<std::string> urn;
  if (!wanted.crs.empty()) {
    const auto crs = gdal::read_crs(wanted.crs);
    if (!crs) return error(Code::kInvalidValue, crs.error().message, "query:crs");
    positions = Positions::between(frame.crs, crs->name, "query:crs");
    coordinates = crs->scale.geographic ? Coordinates::kDegrees : Coordinates::kProjected;
    if (crs->name != "EPSG:4326") urn = proto::crs_urn(crs->name);
  }
  if (!positions) return positions.error();
  Response response;
  response.headers = {{"Content-Type", std::string(proto::formats::kGeoJsonMediaType)},
                      {"Content-Disposition", attachment(tin, ".geojson")}};
  response.body = std::make_unique<GeoJsonSource>(std::move(version), kind, std::move(*positions), wanted.box,
                                                  coordinates, urn);
  return response;
}

/// Removes a file that did not become an answer.
struct Unfinished {
  std::filesystem::path path;
  ~Unfinished() {
    std::error_code ignored;
    if (!path.empty()) std::filesystem::remove(path, ignored);
  }
};

/// Ends the making of a raster that takes too long, or that nobody will get.
class Patience {
 public:
  Patience(const Request& request, std::int64_t seconds)
      : request_(request),
        seconds_(seconds),
        end_(std::chrono::steady_clock::now() + std::chrono::seconds(seconds)) {}
  Result<void> check() const {
    if (request_.is_aborted()) return error(Code::kCancelled, "The server is stopping.");
    if (std::chrono::steady_clock::now() < end_) return {};
    return error(Code::kTooLarge, "Making the raster takes more than " + std::to_string(seconds_) +
                                      " s, the limit here: ask for a smaller box or larger cells.");
  }

 private:
  const Request& request_;
  const std::int64_t seconds_;
  const std::chrono::steady_clock::time_point end_;
};

Result<Response> geotiff(Context& context, const Request& request, const app::Tin& tin,
                         const app::Version& version, const ExportRequest& wanted) {
  const Slot slot(context.exports);
  if (!slot.taken()) return error(Code::kTooMany, "Too many rasters are being made; try again.");
  auto grid = ExportGrid::plan(*version.terrain, wanted);
  if (!grid) return grid.error();
  static std::atomic<std::uint64_t> exports{0};
  const auto folder = context.config.data_dir / "exports";
  std::filesystem::create_directories(folder);
  Unfinished file{folder / (std::to_string(exports++) + ".tif")};
  const Patience patience(request, context.config.limits.export_seconds);
  const auto row_source = [&](std::int64_t row, std::span<double> values) -> Result<void> {
    grid->sample_row(row, values);
    return patience.check();
  };
  if (auto written = gdal::write_geotiff(file.path, grid->spec(), row_source, nullptr); !written)
    return written.error();
  Response response;
  response.headers = {{"Content-Type", "image/tiff; application=geotiff"},
                      {"Content-Disposition", attachment(tin, ".tif")}};
  response.body = http::FileBody{std::exchange(file.path, {}), true};
  return response;
}

/// Parameters of the other format would have no effect: saying so beats ignoring them.
Result<void> check_format_parameters(const Request& request, std::string_view format) {
  const auto misplaced = [&](std::string_view name) -> Result<void> {
    if (!request.query_value(name)) return {};
    return error(Code::kInvalidValue,
                 "The parameter " + std::string(name) + " does not go with f=" + std::string(format) + ".",
                 "query:" + std::string(name));
  };
  if (format == "geotiff") return misplaced("collection");
  for (const std::string_view name : {"cell-size", "voids", "layer", "interpolation", "azimuth", "altitude", "exaggeration"}) {
    if (auto fine = misplaced(name); !fine) return fine;
  }
  return {};
}

Result<tin::query::RasterLayer> parse_layer(std::string_view text) {
  using tin::query::RasterLayer;
  if (text == "elevation") return RasterLayer::kElevation;
  if (text == "slope") return RasterLayer::kSlope;
  if (text == "aspect") return RasterLayer::kAspect;
  if (text == "hillshade") return RasterLayer::kHillshade;
  return error(Code::kInvalidValue, "The layers are elevation, slope, aspect and hillshade.", "query:layer");
}

/// What the raster shows, and how. What would have no effect on the layer is an error.
Result<void> read_layer(const Request& request, ExportRequest& wanted) {
  using tin::query::RasterLayer;
  const auto layer = parse_layer(request.query_value("layer").value_or("elevation"));
  if (!layer) return layer.error();
  wanted.layer = *layer;
  const auto only_for = [&](std::string_view name, RasterLayer with, std::string_view word) -> Result<void> {
    if (wanted.layer == with || !request.query_value(name)) return {};
    return error(Code::kInvalidValue, "The parameter " + std::string(name) + " goes with layer=" + std::string(word) + " only.",
                 "query:" + std::string(name));
  };
  if (auto fine = only_for("interpolation", RasterLayer::kElevation, "elevation"); !fine) return fine;
  const auto by =
      proto::parse_interpolation(request.query_value("interpolation").value_or("linear"), "query:interpolation");
  if (!by) return by.error();
  wanted.interpolation = *by;
  double* const numbers[] = {&wanted.sun.azimuth_degrees, &wanted.sun.altitude_degrees, &wanted.sun.exaggeration};
  const char* const names[] = {"azimuth", "altitude", "exaggeration"};
  for (std::size_t i = 0; i < 3; ++i) {
    if (auto fine = only_for(names[i], RasterLayer::kHillshade, "hillshade"); !fine) return fine;
    const auto number = number_or(request, names[i], *numbers[i]);
    if (!number) return number.error();
    *numbers[i] = *number;
  }
  if (wanted.sun.altitude_degrees < 0 || wanted.sun.altitude_degrees > 90) {
    return error(Code::kInvalidValue, "The sun's altitude is 0 to 90 degrees.", "query:altitude");
  }
  return {};
}

Result<ExportRequest> read_export_request(const Context& context, const Request& request) {
  ExportRequest wanted;
  wanted.max_pixels = context.config.limits.export_pixels;
  if (const auto text = request.query_value("crs")) {
    const auto name = proto::parse_crs(*text, "query:crs");
    if (!name) return name.error();
    const auto crs = gdal::read_crs(*name);
    if (!crs) return error(Code::kInvalidValue, crs.error().message, "query:crs");
    wanted.crs = crs->name;
  }
  if (const auto text = request.query_value("bbox")) {
    const auto box = proto::parse_bbox(*text, "query:bbox");
    if (!box) return box.error();
    wanted.box = *box;
  }
  if (const auto text = request.query_value("cell-size")) {
    const auto size = proto::parse_number(*text, "query:cell-size");
    if (!size) return size.error();
    wanted.cell_size = *size;
  }
  const auto voids = proto::parse_voids(request.query_value("voids").value_or("keep"), "query:voids");
  if (!voids) return voids.error();
  wanted.voids = engine_voids(*voids);
  if (auto read = read_layer(request, wanted); !read) return read.error();
  return wanted;
}

Result<Response> export_tin(Context& context, const Request& request) {
  const auto tin = context.catalogue.find(request.path_parameter("tin"));
  if (!tin) return tin.error();
  const auto wanted = read_export_request(context, request);
  if (!wanted) return wanted.error();
  const std::string collection = request.query_value("collection").value_or("triangles");
  const auto kind = feature_kind(collection);
  if (!kind)
    return error(Code::kInvalidValue, "The collections are vertices and triangles.", "query:collection");
  const std::string format = request.query_value("f").value_or("geotiff");
  if (format != "geotiff" && format != "geojson") {
    return error(Code::kInvalidValue, "The formats are geotiff and geojson.", "query:f");
  }
  if (auto fine = check_format_parameters(request, format); !fine) return fine.error();
  app::Version version = (*tin)->version();
  const std::string tag = entity_tag(**tin, version.revision, request);
  auto response = format == "geotiff" ? geotiff(context, request, **tin, version, *wanted)
                                      : geojson(**tin, std::move(version), *wanted, *kind);
  if (response) response->headers.emplace_back("ETag", tag);
  return response;
}

}  // namespace

void add_export(http::Router& router, Context& context) {
  router.add({.method = http::Method::kGet,
              .pattern = "/tins/{tin}/export",
              .query = {"f", "collection", "crs", "bbox", "cell-size", "voids", "layer", "interpolation", "azimuth", "altitude", "exaggeration"},
              .handler = guarded([&context](Request& request) { return export_tin(context, request); })});
}

}  // namespace server::api
