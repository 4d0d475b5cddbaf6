#include "server/cli/simplify.h"

#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <new>
#include <system_error>
#include <utility>

#include "proto/json_write.h"
#include "proto/processes/simplify.h"
#include "server/api/processes/simplify.h"
#include "server/app/import.h"
#include "server/app/scratch.h"
#include "server/app/simplify.h"
#include "server/app/threads.h"
#include "server/cli/output_file.h"
#include "server/cli/terminal.h"

namespace server::cli {

using tin::base::Code;
using tin::base::error;
using tin::base::Result;

namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

constexpr int kToleranceNotMet = 3;
constexpr double kMostSeconds = 1e9;
constexpr std::uint64_t kFewestVertices = 3;

Result<app::ImportRequest> request_of(const SimplifyArguments& arguments) {
  if (!arguments.tolerance && !arguments.max_vertices)
    return error(Code::kInvalidValue, "either --tolerance or --max-vertices is needed");
  if (arguments.tolerance && !(std::isfinite(*arguments.tolerance) && *arguments.tolerance >= 0))
    return error(Code::kInvalidValue, "--tolerance must be a number that is not negative");
  if (arguments.max_seconds && !(*arguments.max_seconds > 0 && *arguments.max_seconds <= kMostSeconds))
    return error(Code::kInvalidValue, "--max-seconds must be greater than 0, and at most a billion");
  if (arguments.max_vertices && *arguments.max_vertices < kFewestVertices)
    return error(Code::kInvalidValue, "--max-vertices must be at least " + std::to_string(kFewestVertices));
  const auto effort = proto::parse_effort(arguments.effort, "");
  if (!effort) return error(effort.error().code, "--" + effort.error().message);
  const auto elevations = proto::parse_elevations(arguments.elevations, "");
  if (!elevations) return error(elevations.error().code, "--" + elevations.error().message);
  const auto against = proto::parse_against(arguments.against, "");
  if (!against) return error(against.error().code, "--" + against.error().message);
  const auto duplicates = proto::parse_duplicates(arguments.duplicates, "");
  if (!duplicates) return error(duplicates.error().code, "--" + duplicates.error().message);
  tin::simplify::Options options;
  options.tolerance = arguments.tolerance;
  if (arguments.max_vertices) options.max_vertices = static_cast<std::size_t>(*arguments.max_vertices);
  options.effort = api::processes::effort_of(*effort);
  options.elevations = api::processes::elevations_of(*elevations);
  options.against = api::processes::against_of(*against);
  options.keep_flat = static_cast<std::size_t>(arguments.keep_flat);
  options.seed = arguments.seed;
  const unsigned all = app::engine_threads();
  options.threads = arguments.threads == 0 ? all : std::min(arguments.threads, all);
  app::ImportRequest request;
  request.simplify = std::move(options);
  request.max_seconds = arguments.max_seconds;
  request.duplicates = *duplicates;
  request.options = import_options(arguments.input, arguments.content);
  return request;
}

void print_json(const SimplifyArguments& arguments, const proto::SimplifyResults& results) {
  proto::JsonWriter json;
  json.begin_object();
  json.key("input").string(arguments.input);
  json.key("output").string(arguments.output);
  proto::write_simplify_report(json, results);
  json.end_object();
  std::printf("%s\n", json.take().c_str());
}

void print_text(const SimplifyArguments& arguments, const proto::SimplifyResults& results,
                const std::string& unit) {
  const auto ratio = static_cast<double>(results.vertices_after) /
                     static_cast<double>(results.samples == 0 ? 1 : results.samples) * 100;
  std::printf("%s: %llu of %llu samples are vertices (%.2f %%)\n", arguments.output.c_str(),
              static_cast<unsigned long long>(results.vertices_after),
              static_cast<unsigned long long>(results.samples), ratio);
  const std::string of = unit.empty() ? "" : " " + unit;
  std::printf("largest error %.6g%s", results.max_error, of.c_str());
  if (results.worst) {
    std::printf(" at %.10g, %.10g", results.worst->x, results.worst->y);
    if (results.worst->column)
      std::printf(" (column %llu, row %llu)", static_cast<unsigned long long>(*results.worst->column),
                  static_cast<unsigned long long>(*results.worst->row));
  }
  std::printf("; RMSE %.6g%s; %.2f s\n", results.rmse,
              unit.empty() ? ", in the file's own unit" : of.c_str(), results.seconds);
}

/// Whether temporary files can be made there. Errors: kStorage.
Result<void> check_scratch(const fs::path& folder) {
  if (folder.empty() || ::access((folder / "").c_str(), W_OK | X_OK) == 0) return {};
  return error(Code::kStorage, "cannot hold temporary files: " + std::generic_category().message(errno));
}

fs::path folder_of(const fs::path& file) {
  return file.parent_path().empty() ? "." : file.parent_path();
}

}  // namespace

int simplify(const SimplifyArguments& arguments) {
  const auto start = Clock::now();
  auto request = request_of(arguments);
  if (!request) return misuse("", request.error());
  if (auto fine = check_output_name(arguments.output); !fine) return misuse(arguments.output, fine.error());
  if (auto fine = check_output(arguments.output, arguments.input); !fine) return fail(arguments.output, fine.error());
  if (auto fine = check_scratch(arguments.scratch); !fine) return fail(arguments.scratch, fine.error());
  int bands = 1;
  request->options.look = [&](const gdal::Import& import) {
    bands = import.bands;
    return check_output_frame(arguments.output, import.frame);
  };
  app::ScratchMemory scratch({arguments.memory << 20, arguments.scratch.empty() ? folder_of(arguments.output)
                                                                                : fs::path(arguments.scratch)});
  request->options.memory = request->simplify->memory = &scratch;
  // Of what cannot wait in files. Better an error than a machine that runs out of memory.
  request->simplify->room = [most = app::default_memory_limit()](std::size_t bytes) { return bytes <= most; };
  tin::base::Progress progress;
  const CancelOnSignal cancelling(progress);
  Result<void> written;
  std::optional<Result<app::ImportedTerrain>> made;
  try {
    const ProgressBar bar(progress, !arguments.quiet);
    made.emplace(app::import_terrain(arguments.input, *request, progress));
    if (*made) written = write_output((*made)->terrain, arguments.output, progress);
  } catch (const app::NoScratch& none) {
    return fail(arguments.input, none.error());
  } catch (const std::bad_alloc&) {
    return fail(arguments.input, error(Code::kTooLarge, "there is not enough memory"));
  }
  if (const int signal = CancelOnSignal::signal(); signal != 0) return 128 + signal;
  if (!*made) return fail(arguments.input, made->error());
  if (!written) return fail(arguments.output, written.error());
  const app::ImportedTerrain& result = **made;
  auto results = api::processes::results_of(*result.report, result.terrain);
  results.against_source = true;
  results.out_of_time = result.out_of_time;
  results.duplicates = result.duplicates;
  results.seconds = std::chrono::duration<double>(Clock::now() - start).count();
  if (arguments.json) {
    print_json(arguments, results);
  } else if (!arguments.quiet) {
    if (bands > 1) std::printf("%s: the first of %d bands is read\n", arguments.input.c_str(), bands);
    print_text(arguments, results, result.terrain.frame().vertical_unit);
  }
  if (results.tolerance_met) return 0;
  std::fprintf(stderr,
               "tinsmith: --max-vertices got in the way of --tolerance: the largest error is above it\n");
  return kToleranceNotMet;
}

}  // namespace server::cli
