// /processes: what there is, and the execution of simplify.
#include "server/api/answer.h"
#include "server/api/job_answer.h"
#include "server/api/routes.h"
#include "server/app/simplify.h"

namespace server::api {

using tin::base::Code;
using tin::base::error;

namespace {

tin::base::Error no_such_process(std::string_view id) {
  return error(Code::kNotFound, "There is no process \"" + std::string(id) + "\".");
}

std::string results_json(const app::Simplified& done) {
  const auto& report = done.report;
  proto::SimplifyResults results;
  results.vertices_before = report.vertices_before;
  results.vertices_after = report.vertices_after;
  results.max_error = report.max_error;
  results.tolerance_met = report.tolerance_met;
  results.edited_meanwhile = done.edited_meanwhile;
  if (report.worst) {
    results.max_error_at = done.tin->read([&](const tin::terrain::Terrain& terrain, std::uint64_t) {
      return proto::Position2{terrain.frame().x.world(report.worst->at.x),
                              terrain.frame().y.world(report.worst->at.y)};
    });
  }
  results.rmse = report.rmse;
  results.seconds = done.seconds;
  results.tin = done.tin->id();
  results.revision = done.revision;
  return proto::simplify_results_json(results);
}

Result<app::SimplifyRequest> read_request(const Context& context, const Request& request) {
  const auto message = proto::read_simplify_request(request.body);
  if (!message) return message.error();
  const auto tin = context.catalogue.find(message->tin);
  if (!tin) return error(tin.error().code, tin.error().message, "/inputs/tin");
  if (message->as) {
    if (auto room = context.catalogue.check_room(message->as); !room) {
      return error(room.error().code, room.error().message, "/inputs/as");
    }
  }
  app::SimplifyRequest wanted{*tin, {}, message->as};
  wanted.options.tolerance = message->tolerance;
  wanted.options.effort = tin::simplify::Effort::kFast;
  if (message->max_vertices) wanted.options.max_vertices = static_cast<std::size_t>(*message->max_vertices);
  return wanted;
}

Result<Response> execute(Context& context, const Request& request) {
  const auto process = request.path_parameter("process");
  if (process != "simplify") return no_such_process(process);
  if (auto json = require_json(request); !json) return json.error();
  auto wanted = read_request(context, request);
  if (!wanted) return wanted.error();
  const std::string what = wanted->tin->id();
  const auto job = context.jobs.submit(
      "simplify", what,
      [&context, wanted = std::move(*wanted)](tin::base::Progress& progress) -> Result<std::string> {
        const auto done = app::simplify_tin(context.catalogue, wanted, progress);
        if (!done) return done.error();
        return results_json(*done);
      });
  if (!job) return job.error();
  const Slot slot(context.waiting);
  if (!prefers_async(request) && slot.taken()) {
    const auto finished = context.jobs.wait(*job, std::chrono::seconds(context.config.jobs.sync_seconds));
    if (finished && finished->finished_ms) return job_result_answer(*finished);
  }
  return job_accepted_answer(context.jobs, *job);
}

}  // namespace

void add_processes(http::Router& router, Context& context) {
  using http::Method;
  router.add(
      {.method = Method::kGet, .pattern = "/processes", .handler = guarded([](Request&) -> Result<Response> {
                                                          return json_answer(proto::process_list_json());
                                                        })});
  router.add({.method = Method::kGet,
              .pattern = "/processes/{process}",
              .handler = guarded([](Request& request) -> Result<Response> {
                const auto process = request.path_parameter("process");
                const auto document = proto::process_json(process);
                if (!document) return no_such_process(process);
                return json_answer(*document);
              })});
  router.add({.method = Method::kPost,
              .pattern = "/processes/{process}/execution",
              .body = http::BodyKind::kMemory,
              .handler = guarded([&context](Request& request) { return execute(context, request); })});
}

}  // namespace server::api
