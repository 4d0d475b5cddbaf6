// The processes that ask about a TIN's surface: each is the job form of a resource, with room for large
// polygons.
#include "proto/processes/surface.h"

#include "server/api/processes/process.h"
#include "server/api/surface_work.h"

namespace server::api::processes {

using tin::base::Progress;
using tin::base::Result;

namespace {

constexpr const char* kWhere = "/inputs/";

/// Runs `answer(version, progress)` on the TIN's version at the time when the job begins.
template <class Answer>
Result<Execution> about(const Context& context, const std::string& id, Answer answer) {
  const auto tin = find_input_tin(context, id);
  if (!tin) return tin.error();
  return Execution{id, [tin = *tin, answer = std::move(answer)](Progress& progress) -> Result<std::string> {
                     return answer(tin->version(), progress);
                   }};
}

std::size_t polygon_limit(const Context& context) {
  return static_cast<std::size_t>(context.config.limits.polygon_positions);
}

Result<Execution> prepare_contours(Context& context, const proto::Value& value) {
  const LimitConfig& limits = context.config.limits;
  const auto asked = proto::read_contours_process(value, static_cast<std::size_t>(limits.contour_levels));
  if (!asked) return asked.error();
  const auto fine =
      proto::check_contour_inputs(asked->inputs, static_cast<std::size_t>(limits.contour_levels), kWhere);
  if (!fine) return fine.error();
  return about(context, asked->tin,
               [&limits, inputs = asked->inputs](const app::Version& version, Progress& progress) {
                 return contours_answer(version, inputs, limits, kWhere, &progress);
               });
}

Result<Execution> prepare_volume(Context& context, const proto::Value& value) {
  const auto asked = proto::read_volume_process(value, polygon_limit(context));
  if (!asked) return asked.error();
  return about(context, asked->tin,
               [inputs = asked->inputs](const app::Version& version, Progress& progress) {
                 return volume_answer(version, inputs, kWhere, &progress);
               });
}

Result<Execution> prepare_cut_fill(Context& context, const proto::Value& value) {
  const auto asked = proto::read_cut_fill_process(value, polygon_limit(context));
  if (!asked) return asked.error();
  const auto after = find_input_tin(context, asked->after, "/inputs/after");
  if (!after) return after.error();
  return about(context, asked->tin,
               [after = *after, inputs = asked->area](const app::Version& version, Progress& progress) {
                 return cut_fill_answer(version, after->version(), after->id(), inputs, kWhere, &progress);
               });
}

Result<Execution> prepare_surface_area(Context& context, const proto::Value& value) {
  const auto asked = proto::read_surface_area_process(value, polygon_limit(context));
  if (!asked) return asked.error();
  return about(context, asked->tin,
               [inputs = asked->inputs](const app::Version& version, Progress& progress) {
                 return surface_area_answer(version, inputs, kWhere, &progress);
               });
}

Result<Execution> prepare_profile(Context& context, const proto::Value& value) {
  const LimitConfig& limits = context.config.limits;
  const auto asked =
      proto::read_profile_process(value, static_cast<std::size_t>(limits.positions_per_request));
  if (!asked) return asked.error();
  return about(context, asked->tin,
               [&limits, inputs = asked->inputs](const app::Version& version, Progress&) {
                 return profile_answer(version, inputs, limits, kWhere);
               });
}

Result<Execution> prepare_line_of_sight(Context& context, const proto::Value& value) {
  const auto asked = proto::read_line_of_sight_process(value);
  if (!asked) return asked.error();
  if (auto fine = proto::check_sight_inputs(asked->inputs, kWhere); !fine) return fine.error();
  const LimitConfig& limits = context.config.limits;
  return about(context, asked->tin,
               [&limits, inputs = asked->inputs](const app::Version& version, Progress&) {
                 return sight_answer(version, inputs, limits, kWhere);
               });
}

}  // namespace

Process contours() {
  return {&proto::contours_description(), prepare_contours};
}
Process volume() {
  return {&proto::volume_description(), prepare_volume};
}
Process cut_fill() {
  return {&proto::cut_fill_description(), prepare_cut_fill};
}
Process surface_area() {
  return {&proto::surface_area_description(), prepare_surface_area};
}
Process profile() {
  return {&proto::profile_description(), prepare_profile};
}
Process line_of_sight() {
  return {&proto::line_of_sight_description(), prepare_line_of_sight};
}

}  // namespace server::api::processes
