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

/// The samples of the source that are in force in a version.
struct InForce {
  std::shared_ptr<const SourceSamples> source;  // whose heights they share
  std::optional<SourceSamples> samples;
  const SourceSamples* get() const { return samples ? &*samples : nullptr; }
};

/// None where no source is kept, or no surface is left.
Result<InForce> samples_in_force(const Tin& tin, const Terrain& terrain, const ScratchSpace& scratch,
                                 Simplified& result) {
  if (terrain.mesh().dimension() < 2) return InForce();
  auto source = tin.source(scratch);
  if (!source) return source.error();
  if (!*source) return InForce();
  auto in_force = terrain.amendments().in_force(**source, terrain);
  result.against_source = true;
  result.out_of_force = (*source)->sample_count() - in_force.sample_count();
  return InForce{*std::move(source), std::move(in_force)};
}

/// What is left of the TIN at the end, and the heights of a raster as they are worked on.
std::uint64_t bytes_to_simplify(const Terrain& terrain, const ScratchSpace& scratch) {
  const auto* const grid = terrain.source_grid();
  const std::uint64_t cells =
      grid == nullptr ? 0
                      : static_cast<std::uint64_t>(grid->width) * static_cast<std::uint64_t>(grid->height);
  return estimated_bytes(terrain) + scratch.bytes_in_memory(cells * sizeof(double));
}

/// `terrain` as another TIN, thinned.
Result<std::shared_ptr<Tin>> create_thinned(Catalogue& catalogue, const SimplifyRequest& request,
                                            const Terrain& terrain, const Thinning& thinning) {
  return catalogue.create({request.as, request.tin->title() + ", simplified", thinned(terrain, thinning),
                           request.tin->duplicates(), std::nullopt, request.tin->source_bytes()});
}

Result<Simplified> simplify(Catalogue& catalogue, const SimplifyRequest& request,
                            tin::base::Progress& progress) {
  const auto start = Clock::now();
  if (request.as) {
    if (auto room = catalogue.check_room(request.as); !room) return room.error();
  }
  const Version seen = request.tin->version();
  auto leased = GrowingLease::of(catalogue.memory(), bytes_to_simplify(*seen.terrain, catalogue.scratch()));
  if (!leased) return leased.error();
  std::optional<GrowingLease> lease(*std::move(leased));
  Simplified result;
  result.tin = request.tin;
  const auto in_force = samples_in_force(*request.tin, *seen.terrain, catalogue.scratch(), result);
  if (!in_force) return in_force.error();
  const auto memory = catalogue.scratch().memory();
  progress.begin_phase(0.02, 0.95);
  auto options = request.options;
  options.threads = engine_threads();
  const TimeBudget budget(request.max_seconds, start);
  options.out_of_time = budget.question();
  options.protect = protected_positions(*seen.terrain, request.protect);
  options.memory = memory.get();
  options.room = [&lease](std::size_t bytes) { return lease->grow_to(bytes); };
  auto outcome = tin::simplify::simplify(*seen.terrain, in_force->get(), seen.terrain->amendments().own(),
                                         options, &progress);
  if (!outcome) return lease->refusal() ? *lease->refusal() : outcome.error();
  progress.begin_phase(0.95, 1);
  result.report = outcome->report;
  result.out_of_time = budget.was_spent();
  if (progress.cancelled()) return error(Code::kCancelled, "Cancelled.");
  const Thinning thinning{std::move(outcome->removed), std::move(outcome->inserted),
                          std::move(outcome->reset)};
  if (request.as) {
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

}  // namespace

Result<Simplified> simplify_tin(Catalogue& catalogue, const SimplifyRequest& request,
                                tin::base::Progress& progress) {
  try {
    return simplify(catalogue, request, progress);
  } catch (const NoScratch& none) {
    return none.error();
  }
}

}  // namespace server::app
