#include "server/app/simplify.h"

#include "proto/processes/simplify.h"
#include "server/api/processes/process.h"

namespace server::api::processes {

using tin::base::Result;

namespace {

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

Result<Execution> prepare(Context& context, const proto::Value& value) {
  const auto inputs = proto::read_simplify_inputs(value);
  if (!inputs) return inputs.error();
  const auto tin = find_input_tin(context, inputs->tin);
  if (!tin) return tin.error();
  if (inputs->as) {
    if (auto room = check_new_tin(context, inputs->as); !room) return room.error();
  }
  app::SimplifyRequest wanted{*tin, {}, inputs->as};
  wanted.options.tolerance = inputs->tolerance;
  if (inputs->max_vertices) wanted.options.max_vertices = static_cast<std::size_t>(*inputs->max_vertices);
  return Execution{
      (*tin)->id(),
      [&context, wanted = std::move(wanted)](tin::base::Progress& progress) -> Result<std::string> {
        const auto done = app::simplify_tin(context.catalogue, wanted, progress);
        if (!done) return done.error();
        return results_json(*done);
      }};
}

}  // namespace

Process simplify() {
  return {&proto::simplify_description(), prepare};
}

}  // namespace server::api::processes
