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

/// None where no source is kept.
InForce in_force(std::shared_ptr<const SourceSamples> source, const Terrain& terrain, Simplified& result) {
  if (!source) return InForce();
  auto samples = terrain.amendments().in_force(*source, terrain);
  result.against_source = true;
  result.out_of_force = source->sample_count() - samples.sample_count();
  return InForce{std::move(source), std::move(samples)};
}

/// Holds the tolerance in a version that others edited meanwhile.
Mend mending(std::shared_ptr<const SourceSamples> source, const tin::simplify::Options& options,
             Simplified& result, tin::base::Progress& progress) {
  return [source = std::move(source), &options, &result, &progress](
             const Terrain& now, const Terrain& landed) -> Result<Thinning> {
    // Where no surface is left that could be held, nothing goes.
    if (now.mesh().dimension() < 2 || landed.mesh().dimension() < 2) return Thinning();
    const InForce samples = in_force(source, now, result);
    auto present = options;
    present.protect = now.amendments().rim(now);
    auto outcome =
        tin::simplify::mend(now, samples.get(), now.amendments().own_in_force(now), landed, present, &progress);
    if (!outcome) return outcome.error();
    result.report = outcome->report;
    return Thinning{std::move(outcome->removed), std::move(outcome->inserted), std::move(outcome->reset)};
  };
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
  const auto source = request.tin->source(catalogue.scratch());
  if (!source) return source.error();
  const InForce samples = in_force(*source, *seen.terrain, result);
  const auto memory = catalogue.scratch().memory();
  progress.begin_phase(0.02, 0.95);
  auto options = request.options;
  options.threads = engine_threads();
  const TimeBudget budget(request.max_seconds, start);
  options.out_of_time = budget.question(&progress);
  options.protect = protected_positions(*seen.terrain, request.protect);
  const auto rim = seen.terrain->amendments().rim(*seen.terrain);
  options.protect.insert(options.protect.end(), rim.begin(), rim.end());
  options.memory = memory.get();
  options.room = [&lease](std::size_t bytes) { return lease->grow_to(bytes); };
  const auto own = seen.terrain->amendments().own_in_force(*seen.terrain);
  auto outcome = tin::simplify::simplify(*seen.terrain, samples.get(), own, options, &progress);
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
    const bool holds = options.tolerance && result.report.tolerance_met;
    const auto landed = request.tin->land(seen, thinning, {now_ms(), "", "simplify"},
                                          holds ? mending(*source, options, result, progress) : Mend());
    if (!landed) return lease->refusal() ? *lease->refusal() : landed.error();
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
