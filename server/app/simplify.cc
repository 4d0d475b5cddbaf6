#include "server/app/simplify.h"

#include <chrono>

namespace server::app {

using tin::base::Result;

Result<Simplified> simplify_tin(Catalogue& catalogue, const SimplifyRequest& request,
                                tin::base::Progress& progress) {
  const auto start = std::chrono::steady_clock::now();
  if (request.as) {
    if (auto room = catalogue.check_room(request.as); !room) return room.error();
  }
  const Version seen = request.tin->version();
  // The working TIN, and what is left of it at the end.
  const auto memory = catalogue.memory().lease(2 * estimated_bytes(*seen.terrain));
  if (!memory) return memory.error();
  progress.begin_phase(0, 0.95);
  auto outcome = tin::simplify::simplify(*seen.terrain, request.options, &progress);
  if (!outcome) return outcome.error();
  progress.begin_phase(0.95, 1);
  Simplified result{outcome->report, request.tin, 1, 0};
  if (progress.cancelled()) return tin::base::error(tin::base::Code::kCancelled, "Cancelled.");
  if (request.as) {
    auto made =
        catalogue.create({request.as, request.tin->title() + ", simplified",
                          seen.terrain->without(outcome->removed), request.tin->duplicates(), std::nullopt, true});
    if (!made) return made.error();
    result.tin = *made;
  } else {
    const auto landed = request.tin->remove_vertices(seen, outcome->removed, {now_ms(), "", "simplify"});
    if (!landed) return landed.error();
    result.revision = landed->revision;
    result.edited_meanwhile = landed->edited_meanwhile;
    result.report.vertices_after = landed->vertices_left;
  }
  result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return result;
}

}  // namespace server::app
