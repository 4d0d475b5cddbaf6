#include "server/app/simplify.h"

#include <chrono>

#include "server/app/threads.h"
#include "server/app/time_budget.h"

namespace server::app {

using tin::base::Code;
using tin::base::error;
using tin::base::Result;
using tin::terrain::SourceSamples;
using tin::terrain::Terrain;

namespace {

using Clock = std::chrono::steady_clock;

constexpr std::size_t kBytesPerSurfaceSample = 120;  // while its triangulation is built

/// The samples of the source that are in force in a version; none where no source is kept, or no surface is
/// left.
Result<std::optional<SourceSamples>> samples_in_force(const Tin& tin, const Terrain& terrain,
                                                      Simplified& result) {
  if (terrain.mesh().dimension() < 2) return std::optional<SourceSamples>();
  const auto source = tin.source();
  if (!source) return source.error();
  if (!*source) return std::optional<SourceSamples>();
  auto in_force = terrain.amendments().in_force(**source, terrain);
  result.against_source = true;
  result.out_of_force = (*source)->sample_count() - in_force.sample_count();
  return std::optional(std::move(in_force));
}

/// `terrain` as another TIN, thinned.
Result<std::shared_ptr<Tin>> create_thinned(Catalogue& catalogue, const SimplifyRequest& request,
                                            const Terrain& terrain, const Thinning& thinning) {
  auto source = request.tin->source_bytes();
  if (!source) return source.error();
  return catalogue.create({request.as, request.tin->title() + ", simplified", thinned(terrain, thinning),
                           request.tin->duplicates(), std::nullopt, *std::move(source)});
}

}  // namespace

Result<Simplified> simplify_tin(Catalogue& catalogue, const SimplifyRequest& request,
                                tin::base::Progress& progress) {
  const auto start = Clock::now();
  if (request.as) {
    if (auto room = catalogue.check_room(request.as); !room) return room.error();
  }
  const Version seen = request.tin->version();
  // The working TIN, and what is left of it at the end.
  auto memory = catalogue.memory().lease(2 * estimated_bytes(*seen.terrain));
  if (!memory) return memory.error();
  std::optional<MemoryBudget::Lease> lease(*std::move(memory));
  Simplified result;
  result.tin = request.tin;
  const auto source = samples_in_force(*request.tin, *seen.terrain, result);
  if (!source) return source.error();
  std::optional<MemoryBudget::Lease> surface;  // the triangulation of all samples
  if (request.options.against == tin::simplify::Against::kSurface) {
    auto held = catalogue.memory().lease(
        kBytesPerSurfaceSample * (*source ? (*source)->sample_count() : seen.terrain->vertex_count()));
    if (!held) return held.error();
    surface.emplace(*std::move(held));
  }
  progress.begin_phase(0.02, 0.95);
  auto options = request.options;
  options.threads = engine_threads();
  const TimeBudget budget(request.max_seconds, start);
  options.out_of_time = budget.question();
  options.protect = protected_positions(*seen.terrain, request.protect);
  auto outcome = tin::simplify::simplify(*seen.terrain, *source ? &**source : nullptr,
                                         seen.terrain->amendments().own(), options, &progress);
  if (!outcome) return outcome.error();
  progress.begin_phase(0.95, 1);
  result.report = outcome->report;
  result.out_of_time = budget.was_spent();
  if (progress.cancelled()) return error(Code::kCancelled, "Cancelled.");
  const Thinning thinning{std::move(outcome->removed), std::move(outcome->inserted),
                          std::move(outcome->reset)};
  if (request.as) {
    surface.reset();
    lease.reset();  // what is kept of it is counted by create()
    auto made = create_thinned(catalogue, request, *seen.terrain, thinning);
    if (!made) return made.error();
    result.tin = *made;
    result.revision = 1;
  } else {
    const auto landed = request.tin->land(seen, thinning, {now_ms(), "", "simplify"});
    if (!landed) return landed.error();
    result.revision = landed->revision;
    result.edited_meanwhile = landed->edited_meanwhile;
    result.report.vertices_after = landed->vertices_left;
  }
  result.seconds = std::chrono::duration<double>(Clock::now() - start).count();
  return result;
}

}  // namespace server::app
