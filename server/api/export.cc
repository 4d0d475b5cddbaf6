// GET /tins/{tin}/export: the whole TIN, or a part, as a file.
#include <utility>

#include "proto/crs_uri.h"
#include "server/api/export_formats.h"
#include "server/api/surface_work.h"

namespace server::api {

using tin::base::Code;
using tin::base::error;

namespace {

/// Parameters that would have no effect: saying so beats ignoring them.
Result<void> check_format_parameters(const Request& request, const ExportFormat& format) {
  for (const auto& [name, value] : request.query) {
    if (takes_parameter(format, name)) continue;
    return error(Code::kInvalidValue,
                 "The parameter " + name + " does not go with f=" + std::string(format.name) + ".",
                 "query:" + name);
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
  const auto kind = feature_kind(request.query_value("collection").value_or("triangles"));
  if (!kind)
    return error(Code::kInvalidValue, "The collections are vertices, triangles and edges.", "query:collection");
  const ExportFormat* format = find_export_format(request.query_value("f").value_or("geotiff"));
  if (format == nullptr) {
    return error(Code::kInvalidValue, "The formats are " + export_format_names() + ".", "query:f");
  }
  if (auto fine = check_format_parameters(request, *format); !fine) return fine.error();
  ExportTask task{context,
                  **tin,
                  (*tin)->version(),
                  *wanted,
                  *kind,
                  *format,
                  Patience(request, context.config.limits.export_seconds)};
  Response response;
  response.headers = {
      {"Content-Type", std::string(format->media_type)},
      {"Content-Disposition", "attachment; filename=\"" + (*tin)->id() + std::string(format->suffix) + "\""},
      {"ETag", entity_tag(**tin, task.version.revision, request)}};
  auto body = format->make(task);
  if (!body) return body.error();
  response.body = std::move(*body);
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
