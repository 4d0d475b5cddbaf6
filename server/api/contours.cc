// /tins/{tin}/contours: contour lines as GeoJSON, traced while the client takes them.
#include <algorithm>
#include <cmath>

#include "proto/crs_uri.h"
#include "server/api/answer.h"
#include "server/api/routes.h"
#include "server/api/surface_work.h"
#include "server/gdal/crs.h"

namespace server::api {

using proto::formats::Coordinates;
using proto::formats::GeoJsonWriter;
using tin::base::Code;
using tin::base::error;

Result<ContourFile> ContourFile::begin(app::Version version, const proto::ContourInputs& inputs,
                                       const LimitConfig& limits, const std::string& where) {
  const auto most = static_cast<std::size_t>(limits.contour_levels);
  if (auto fine = proto::check_contour_inputs(inputs, most, where); !fine) return fine.error();
  ContourFile file(std::move(version));
  const auto& terrain = *file.version_.terrain;
  const auto& frame = terrain.frame();
  std::optional<std::string> crs = inputs.manner.crs;
  Coordinates coordinates = Coordinates::kProjected;
  if (crs) {
    const auto known = gdal::read_crs(*crs);
    if (!known) return error(Code::kInvalidValue, known.error().message, where + "crs");
    if (known->scale.geographic) coordinates = Coordinates::kDegrees;
    if (known->name != "EPSG:4326") file.crs_urn_ = proto::crs_urn(known->name);
  } else if (!frame.crs.empty()) {
    crs = "OGC:CRS84";
    coordinates = Coordinates::kDegrees;
  }
  auto positions = SurfacePositions::make(terrain, crs, where + "crs");
  if (!positions) return positions.error();
  file.positions_ = std::move(*positions);
  tin::query::ContourOptions options;
  options.voids = engine_voids(inputs.manner.voids);
  if (inputs.box) {
    const auto box = file.positions_->box(*inputs.box, where);
    if (!box) return box.error();
    options.box = *box;
  }
  std::vector<double> levels = inputs.levels;
  if (inputs.interval) {
    auto multiples = tin::query::contour_levels(terrain, *inputs.interval, inputs.base, most);
    if (!multiples) return error(multiples.error().code, multiples.error().message, where + "interval");
    levels = std::move(*multiples);
  }
  file.tracer_ = std::make_unique<tin::query::ContourTracer>(terrain, std::move(levels), options);
  file.coordinates_ = coordinates;
  return file;
}

bool ContourFile::next(std::string& out, std::size_t* positions) {
  if (ended_) return false;
  GeoJsonWriter writer(out, coordinates_, begun_lines_);
  if (!begun_) {
    writer.begin({std::nullopt, std::nullopt, {}, crs_urn_, std::nullopt});
    begun_ = true;
    return true;
  }
  tin::query::ContourLine line;
  if (!tracer_->next(line)) {
    writer.end();
    ended_ = true;
    return true;
  }
  const auto at = positions_->from_lattice(line.places);
  if (positions != nullptr) *positions += at.size();
  // Places beyond what the CRS can say are left out of the line.
  std::vector<proto::Position2> finite;
  for (const auto& p : at) {
    if (std::isfinite(p.x) && std::isfinite(p.y)) finite.push_back(p);
  }
  if (finite.size() < 2) return true;
  writer.contour(line.level, line.closed && finite.size() == at.size(), finite);
  begun_lines_ = true;
  return true;
}

Result<std::string> contours_answer(const app::Version& version, const proto::ContourInputs& inputs,
                                    const LimitConfig& limits, const std::string& where,
                                    tin::base::Progress* progress) {
  auto file = ContourFile::begin(version, inputs, limits, where);
  if (!file) return file.error();
  std::string out;
  std::size_t positions = 0;
  while (file->next(out, &positions)) {
    if (positions > static_cast<std::size_t>(limits.answer_positions)) {
      return error(Code::kTooLarge, "The contours have more than " + std::to_string(limits.answer_positions) +
                                        " positions, the limit here: ask for a smaller box or fewer levels, "
                                        "or for the stream at /contours.");
    }
    if (progress == nullptr) continue;
    progress->report(file->fraction());
    if (progress->cancelled()) return error(Code::kCancelled, "Stopped on request.");
  }
  return out;
}

namespace {

constexpr std::size_t kPiece = 64 * 1024;

class ContourSource : public http::BodySource {
 public:
  explicit ContourSource(ContourFile file) : file_(std::move(file)) {}
  bool next(std::string& piece) override {
    while (piece.size() < kPiece && file_.next(piece)) {
    }
    return !piece.empty();
  }

 private:
  ContourFile file_;
};

Result<std::vector<double>> levels_of(const Request& request, std::size_t most) {
  std::vector<double> out;
  const auto text = request.query_value("levels");
  if (!text) return out;
  std::string_view rest = *text;
  while (true) {
    const auto comma = std::min(rest.find(','), rest.size());
    const auto level = proto::parse_number(rest.substr(0, comma), "query:levels");
    if (!level) return level.error();
    out.push_back(*level);
    if (out.size() > most)
      return error(Code::kTooLarge, "There may be " + std::to_string(most) + " levels at most.",
                   "query:levels");
    if (comma == rest.size()) return out;
    rest.remove_prefix(comma + 1);
  }
}

Result<proto::ContourInputs> inputs_of(const Request& request, const LimitConfig& limits) {
  proto::ContourInputs inputs;
  if (const auto text = request.query_value("interval")) {
    const auto interval = proto::parse_number(*text, "query:interval");
    if (!interval) return interval.error();
    inputs.interval = *interval;
  }
  const auto base = number_or(request, "base", 0);
  if (!base) return base.error();
  inputs.base = *base;
  auto levels = levels_of(request, static_cast<std::size_t>(limits.contour_levels));
  if (!levels) return levels.error();
  inputs.levels = std::move(*levels);
  const auto box = flat_box(request);
  if (!box) return box.error();
  inputs.box = *box;
  const auto manner = manner_of(request);
  if (!manner) return manner.error();
  inputs.manner = *manner;
  return inputs;
}

Result<Response> contours(Context& context, const Request& request) {
  const auto tin = context.catalogue.find(request.path_parameter("tin"));
  if (!tin) return tin.error();
  const auto& limits = context.config.limits;
  const auto inputs = inputs_of(request, limits);
  if (!inputs) return inputs.error();
  const Slot slot(context.exports);
  if (!slot.taken()) return too_many_questions();
  const app::Version version = (*tin)->version();
  auto file = ContourFile::begin(version, *inputs, limits, "query:");
  if (!file) return file.error();
  Response response;
  response.headers = {{"Content-Type", std::string(proto::formats::kGeoJsonMediaType)},
                      {"ETag", entity_tag(**tin, version.revision, request)}};
  response.body = std::make_unique<ContourSource>(std::move(*file));
  return response;
}

}  // namespace

void add_contours(http::Router& router, Context& context) {
  router.add({.method = http::Method::kGet,
              .pattern = "/tins/{tin}/contours",
              .query = {"interval", "base", "levels", "bbox", "crs", "voids"},
              .handler = guarded([&context](Request& request) { return contours(context, request); })});
}

}  // namespace server::api
