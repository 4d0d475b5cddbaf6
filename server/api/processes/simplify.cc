#include "server/api/processes/simplify.h"

#include <algorithm>

#include "server/api/processes/process.h"
#include "server/app/simplify.h"
#include "server/app/threads.h"

namespace server::api::processes {

using tin::base::Result;

namespace {

proto::SimplifyWorst worst_sample(const tin::simplify::Worst& worst, const tin::terrain::Terrain& terrain) {
  proto::SimplifyWorst out;
  const auto& [x, y] = worst.at;
  const auto to = worst.between ? worst.between->to : worst.at;
  const double along = worst.between ? worst.between->along : 0;
  out.x = terrain.frame().x.world(x + along * (static_cast<double>(to.x) - x));
  out.y = terrain.frame().y.world(y + along * (static_cast<double>(to.y) - y));
  out.z = worst.z;
  out.error = worst.error;
  if (!worst.source_index) return out;
  if (const auto* grid = terrain.source_grid()) {
    const auto width = static_cast<std::uint64_t>(grid->width);
    out.column = *worst.source_index % width;
    out.row = *worst.source_index / width;
  } else {
    out.index = *worst.source_index;
  }
  return out;
}

std::string results_json(const app::Simplified& done) {
  proto::SimplifyResults results = done.tin->read([&](const tin::terrain::Terrain& terrain, std::uint64_t) {
    return results_of(done.report, terrain);
  });
  results.edited_meanwhile = done.edited_meanwhile;
  results.against_source = done.against_source;
  results.out_of_force = done.out_of_force;
  results.out_of_time = done.out_of_time;
  results.seconds = done.seconds;
  results.tin = done.tin->id();
  results.revision = done.revision;
  return proto::simplify_results_json(results);
}

/// An error of the work, which knows no inputs: that fewer vertices remain than the terrain needs is found out
/// there.
tin::base::Error at_its_input(tin::base::Error error, const tin::simplify::Options& options) {
  if (error.code == tin::base::Code::kInvalidValue && error.where.empty() && options.max_vertices)
    error.where = "/inputs/maxVertices";
  return error;
}

/// Errors: kUnknownVertex, where the id stands; kOutsideLattice.
Result<app::Protection> protection_of(const app::Tin& tin, const proto::SimplifyProtect& asked) {
  app::Protection protect;
  protect.border = asked.border;
  const auto unknown = tin.read([&](const tin::terrain::Terrain& terrain, std::uint64_t) {
    return std::find_if(asked.ids.begin(), asked.ids.end(),
                        [&](const auto& one) { return !terrain.vertex(one.id); });
  });
  if (unknown != asked.ids.end()) {
    return tin::base::error(tin::base::Code::kUnknownVertex,
                            "There is no vertex " + std::to_string(unknown->id.value()) + ".", unknown->where);
  }
  for (const auto& one : asked.ids) protect.ids.push_back(one.id);
  const tin::frame::Frame frame = tin.summary().frame;
  for (const auto& polygon : asked.polygons) {
    auto& rings = protect.polygons.emplace_back();
    for (const auto& ring : polygon) {
      auto& corners = rings.emplace_back();
      for (const proto::Position2& at : ring) {
        const auto corner = frame.to_lattice(at.x, at.y);
        if (!corner) return tin::base::error(corner.error().code, corner.error().message, "/inputs/protect");
        corners.push_back(*corner);
      }
    }
  }
  return protect;
}

Result<Execution> prepare(Context& context, const proto::Value& value) {
  const auto inputs = proto::read_simplify_inputs(value);
  if (!inputs) return inputs.error();
  const auto tin = find_input_tin(context, inputs->tin);
  if (!tin) return tin.error();
  const auto seconds = allowed_seconds(context, inputs->max_seconds, "/inputs/maxSeconds");
  if (!seconds) return seconds.error();
  if (inputs->as) {
    if (auto room = check_new_tin(context, inputs->as); !room) return room.error();
  }
  auto protect = protection_of(**tin, inputs->protect);
  if (!protect) return protect.error();
  app::SimplifyRequest wanted{*tin, {}, *seconds, *std::move(protect), inputs->as};
  wanted.options.effort = effort_of(inputs->effort);
  wanted.options.elevations = elevations_of(inputs->elevations);
  wanted.options.against = against_of(inputs->against);
  wanted.options.keep_flat = static_cast<std::size_t>(inputs->keep_flat);
  wanted.options.seed = inputs->seed;
  wanted.options.threads = app::engine_threads();
  wanted.options.tolerance = inputs->tolerance;
  if (inputs->max_vertices) wanted.options.max_vertices = static_cast<std::size_t>(*inputs->max_vertices);
  return Execution{
      (*tin)->id(),
      [&context, wanted = std::move(wanted)](tin::base::Progress& progress) -> Result<std::string> {
        const auto done = app::simplify_tin(context.catalogue, wanted, progress);
        if (!done) return at_its_input(done.error(), wanted.options);
        return results_json(*done);
      }};
}

}  // namespace

tin::simplify::Effort effort_of(proto::SimplifyEffort effort) {
  switch (effort) {
    case proto::SimplifyEffort::kFast:
      return tin::simplify::Effort::kFast;
    case proto::SimplifyEffort::kBalanced:
      return tin::simplify::Effort::kBalanced;
    case proto::SimplifyEffort::kThorough:
      return tin::simplify::Effort::kThorough;
    case proto::SimplifyEffort::kBest:
      break;
  }
  return tin::simplify::Effort::kBest;
}

tin::simplify::Elevations elevations_of(proto::SimplifyElevations elevations) {
  return elevations == proto::SimplifyElevations::kFit ? tin::simplify::Elevations::kFit : tin::simplify::Elevations::kSource;
}

tin::simplify::Against against_of(proto::SimplifyAgainst against) {
  return against == proto::SimplifyAgainst::kSurface ? tin::simplify::Against::kSurface : tin::simplify::Against::kSamples;
}

Result<double> allowed_seconds(const Context& context, std::optional<double> seconds, std::string where) {
  const std::int64_t most = context.config.jobs.simplify_seconds;
  if (seconds && *seconds > static_cast<double>(most)) {
    return tin::base::error(tin::base::Code::kInvalidValue,
                            "maxSeconds is at most " + std::to_string(most) + " on this server.", std::move(where));
  }
  return seconds.value_or(static_cast<double>(most));
}

proto::SimplifyResults results_of(const tin::simplify::Report& report, const tin::terrain::Terrain& terrain) {
  proto::SimplifyResults results;
  results.crs = terrain.frame().crs;
  results.vertical_unit = terrain.frame().vertical_unit;
  results.vertices_before = report.vertices_before;
  results.vertices_after = report.vertices_after;
  results.max_error = report.max_error;
  if (report.worst) results.worst = worst_sample(*report.worst, terrain);
  results.tolerance_met = report.tolerance_met;
  results.rmse = report.rmse;
  results.samples = report.samples;
  results.level = report.level;
  results.crossings = report.crossings;
  results.histogram_bin = report.bin;
  results.histogram.assign(report.histogram.begin(), report.histogram.end());
  return results;
}

Process simplify() {
  return {&proto::simplify_description(), prepare};
}

}  // namespace server::api::processes
