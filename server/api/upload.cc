#include "server/api/upload.h"

#include "proto/bbox.h"
#include "proto/crs_uri.h"
#include "proto/messages.h"
#include "server/api/job_answer.h"
#include "server/api/processes/simplify.h"
#include "server/api/tin_document.h"
#include "server/app/import.h"
#include "server/app/simplify.h"
#include "server/app/threads.h"
#include "server/gdal/crs.h"

namespace server::api {

using tin::base::Code;
using tin::base::error;

namespace {

/// "0.5" for both axes, or "0.5,0.25".
Result<std::array<double, 2>> parse_resolution(const std::string& text) {
  const auto comma = text.find(',');
  const auto x = proto::parse_number(text.substr(0, comma), "query:resolution");
  if (!x) return x.error();
  auto y = x;
  if (comma != std::string::npos) y = proto::parse_number(text.substr(comma + 1), "query:resolution");
  if (!y) return y.error();
  if (!(*x > 0) || !(*y > 0))
    return error(Code::kInvalidValue, "A resolution must be greater than 0.", "query:resolution");
  return std::array<double, 2>{*x, *y};
}

/// "2", or "2,8,9".
Result<std::vector<std::uint8_t>> parse_classes(const std::string& text) {
  std::vector<std::uint8_t> classes;
  for (std::size_t at = 0; at <= text.size();) {
    const std::size_t comma = std::min(text.find(',', at), text.size());
    const auto one = proto::parse_count(text.substr(at, comma - at), 0, 255, "query:class");
    if (!one) return one.error();
    classes.push_back(static_cast<std::uint8_t>(*one));
    at = comma + 1;
  }
  return classes;
}

/// The goals of a simplification, if one is asked for.
Result<std::optional<tin::simplify::Options>> read_goals(const Request& request) {
  tin::simplify::Options options;
  if (const auto text = request.query_value("tolerance")) {
    const auto tolerance = proto::parse_number(*text, "query:tolerance");
    if (!tolerance) return tolerance.error();
    if (!(*tolerance >= 0))
      return error(Code::kInvalidValue, "A tolerance must not be negative.", "query:tolerance");
    options.tolerance = *tolerance;
  }
  if (const auto text = request.query_value("maxVertices")) {
    const auto count = proto::parse_max_vertices(*text, "query:maxVertices");
    if (!count) return count.error();
    options.max_vertices = static_cast<std::size_t>(*count);
  }
  if (options.tolerance || options.max_vertices) return std::optional(std::move(options));
  for (const std::string name : {"effort", "elevations", "keepFlat", "against", "maxSeconds", "seed"}) {
    if (request.query_value(name))
      return error(Code::kInvalidValue, name + " goes with a tolerance or maxVertices.", "query:" + name);
  }
  return std::optional<tin::simplify::Options>();
}

/// What the parameters tolerance and maxVertices and those that go with them ask for, if one of them is there.
Result<std::optional<tin::simplify::Options>> read_simplification(const Request& request) {
  auto goals = read_goals(request);
  if (!goals || !*goals) return goals;
  tin::simplify::Options& options = **goals;
  options.threads = app::engine_threads();
  if (const auto effort = request.query_value("effort")) {
    const auto named = proto::parse_effort(*effort, "query:effort");
    if (!named) return named.error();
    options.effort = processes::effort_of(*named);
  }
  if (const auto elevations = request.query_value("elevations")) {
    const auto named = proto::parse_elevations(*elevations, "query:elevations");
    if (!named) return named.error();
    options.elevations = processes::elevations_of(*named);
  }
  if (const auto flat = request.query_value("keepFlat")) {
    const auto samples = proto::parse_keep_flat(*flat, "query:keepFlat");
    if (!samples) return samples.error();
    options.keep_flat = static_cast<std::size_t>(*samples);
  }
  if (const auto against = request.query_value("against")) {
    const auto named = proto::parse_against(*against, "query:against");
    if (!named) return named.error();
    options.against = processes::against_of(*named);
  }
  if (const auto text = request.query_value("seed")) {
    const auto seed = proto::parse_seed(*text, "query:seed");
    if (!seed) return seed.error();
    options.seed = *seed;
  }
  return goals;
}

/// How long a simplification may take.
Result<double> read_max_seconds(const Context& context, const Request& request) {
  const auto text = request.query_value("maxSeconds");
  if (!text) return processes::allowed_seconds(context, std::nullopt, {});
  const auto seconds = proto::parse_max_seconds(*text, "query:maxSeconds");
  if (!seconds) return seconds.error();
  return processes::allowed_seconds(context, *seconds, "query:maxSeconds");
}

Result<app::ImportRequest> read_request(const Context& context, const Request& request) {
  app::ImportRequest import;
  import.title = request.query_value("title").value_or("");
  if (auto fine = proto::check_title(import.title, "query:title"); !fine) return fine.error();
  if (const auto id = request.query_value("id")) {
    if (!proto::is_tin_id(*id)) {
      return error(Code::kInvalidValue,
                   "An id has 1 to 64 letters, digits, '-' and '_', and begins with a letter or digit.",
                   "query:id");
    }
    import.id = *id;
  }
  if (const auto text = request.query_value("duplicates")) {
    const auto policy = proto::parse_duplicates(*text, "query:duplicates");
    if (!policy) return policy.error();
    import.duplicates = *policy;
  }
  if (const auto text = request.query_value("vertical-unit")) {
    import.vertical_unit = gdal::vertical_unit(*text);
    if (!import.vertical_unit) return unknown_unit("query:vertical-unit");
  }
  gdal::ImportOptions& options = import.options;
  options.file_name = disposition_file_name(request.header("content-disposition"));
  options.content_type = media_type(request);
  options.format = request.query_value("format").value_or("");
  if (const auto text = request.query_value("class")) {
    auto classes = parse_classes(*text);
    if (!classes) return classes.error();
    options.classes = *std::move(classes);
  }
  options.layer = request.query_value("layer").value_or("");
  options.z_field = request.query_value("z-field").value_or("");
  options.max_samples = static_cast<std::uint64_t>(context.config.limits.vertices_per_tin);
  import.decoder = context.decoder;
  options.max_unpacked_bytes = static_cast<std::uint64_t>(context.config.limits.unpacked_bytes);
  options.max_pixels = static_cast<std::uint64_t>(context.config.limits.raster_pixels);
  if (const auto crs = request.query_value("crs")) {
    const auto name = proto::parse_crs(*crs, "query:crs");
    if (!name) return name.error();
    if (const auto known = gdal::read_crs(*name); !known)
      return error(Code::kInvalidValue, known.error().message, "query:crs");
    options.crs = *name;
  }
  if (const auto text = request.query_value("resolution")) {
    const auto resolution = parse_resolution(*text);
    if (!resolution) return resolution.error();
    options.resolution_x = (*resolution)[0];
    options.resolution_y = (*resolution)[1];
  }
  auto simplify = read_simplification(request);
  if (!simplify) return simplify.error();
  import.simplify = *std::move(simplify);
  const auto seconds = read_max_seconds(context, request);
  if (!seconds) return seconds.error();
  import.max_seconds = *seconds;
  return import;
}

/// What the simplification of an import came to, if there was one.
std::optional<proto::SimplifyResults> simplification_of(const app::ImportedTin& made) {
  if (!made.report) return std::nullopt;
  auto results = made.tin->read([&](const tin::terrain::Terrain& terrain, std::uint64_t) {
    return processes::results_of(*made.report, terrain);
  });
  results.against_source = true;
  results.out_of_time = made.out_of_time;
  results.duplicates = made.duplicates;
  results.seconds = made.seconds;
  results.tin = made.tin->id();
  results.revision = 1;
  return results;
}

/// Removes the file when the last copy goes: a job may be dismissed before it ever runs.
struct OwnedFile {
  explicit OwnedFile(std::filesystem::path p) : path(std::move(p)) {}
  OwnedFile(const OwnedFile&) = delete;
  OwnedFile& operator=(const OwnedFile&) = delete;
  ~OwnedFile() {
    std::error_code ignored;
    std::filesystem::remove(path, ignored);
  }
  const std::filesystem::path path;
};

Result<Response> import_as_job(Context& context, Request& request, app::ImportRequest import) {
  auto file = std::make_shared<OwnedFile>(request.release_body_file());
  const std::string what = import.options.file_name.empty() ? "an upload" : import.options.file_name;
  auto job = context.jobs.submit(
      "import", what,
      [&context, file, import = std::move(import)](tin::base::Progress& progress) -> Result<std::string> {
        const auto made = app::import_tin(context.catalogue, file->path, import, progress);
        if (!made) return made.error();
        const auto simplification = simplification_of(*made);
        const proto::FileReport told{made->duplicates, simplification ? &*simplification : nullptr};
        return proto::tin_json(tin_document(*made->tin), &told);
      });
  if (!job) return job.error();
  return job_accepted_answer(context.jobs, *job, request);
}

}  // namespace

tin::base::Error unknown_unit(std::string where) {
  return error(Code::kInvalidValue, "The units of elevations are metre, foot and US survey foot.",
               std::move(where));
}

std::string disposition_file_name(std::string_view field) {
  const std::string lower = http::lower_case(field);
  auto at = lower.find("filename=");
  if (at == std::string::npos) return "";
  at += 9;
  std::string name;
  if (at < field.size() && field[at] == '"') {
    name = field.substr(at + 1, field.find('"', at + 1) - at - 1);
  } else {
    name = field.substr(at, field.find_first_of("; ", at) - at);
  }
  return name.substr(name.find_last_of("/\\") + 1);
}

Result<Response> create_from_upload(Context& context, Request& request) {
  if (media_type(request).starts_with("multipart/")) {
    return error(Code::kUnsupported, "The body must be the file itself, not a form that holds it.",
                 "header:Content-Type");
  }
  if (request.body_file.empty() || std::filesystem::file_size(request.body_file) == 0) {
    return error(Code::kInvalidValue, "The body is empty: it must be a data file.");
  }
  if (!request.header("content-encoding").empty()) {
    return error(Code::kUnsupported, "The body must be the plain file, without Content-Encoding.",
                 "header:Content-Encoding");
  }
  auto import = read_request(context, request);
  if (!import) return import.error();
  if (auto room = context.catalogue.check_room(import->id); !room) return room.error();
  if (prefers_async(request)) return import_as_job(context, request, std::move(*import));
  if (import->simplify && import->simplify->effort > tin::simplify::Effort::kBalanced) {
    return error(Code::kInvalidValue, "So much effort takes a job: ask with Prefer: respond-async.", "query:effort");
  }
  const Slot slot(context.uploads);
  if (!slot.taken())
    return error(Code::kTooMany,
                 "Too many files are being read; try again, or ask with Prefer: respond-async.");
  tin::base::Progress progress;
  const http::Attention::Work unless_unwanted(request.attention, progress);
  const auto made = app::import_tin(context.catalogue, request.body_file, *import, progress);
  if (!made) return made.error();
  const auto simplification = simplification_of(*made);
  const proto::FileReport told{made->duplicates, simplification ? &*simplification : nullptr};
  return created_answer(context, *made->tin, request, &told);
}

}  // namespace server::api
