#include "server/app/import.h"

#include <chrono>

#include "server/app/source.h"
#include "server/app/thinning.h"
#include "server/app/threads.h"
#include "server/app/time_budget.h"

namespace server::app {

using tin::base::Progress;
using tin::base::Result;
using tin::terrain::Duplicates;
using tin::terrain::SourceSamples;
using tin::terrain::Terrain;

namespace {

/// How much of an import's progress has gone by when the file is read, when its points are triangulated, when
/// as many of a raster's samples are chosen as are needed, and when the terrain is there.
constexpr double kRead = 0.3, kPointsBuilt = 0.4, kChosen = 0.85, kBuilt = 0.9;

SourceSamples raster_source(gdal::Import& import) {
  std::vector<std::uint64_t> valid = import.grid->valid;
  return SourceSamples::restored_raster(import.grid, std::move(import.heights), std::move(valid));
}

/// Every sample becomes a vertex. Until `end` of the progress.
Result<ImportedTerrain> build_whole(gdal::Import import, Duplicates duplicates, Progress& progress,
                                    double end) {
  progress.begin_phase(kRead, end);
  const std::size_t samples = import.placements.size();
  auto terrain = Terrain::build(std::move(import.frame), import.placements, duplicates, &progress, engine_threads());
  if (!terrain) return terrain.error();
  import.placements = {};
  terrain->set_source_grid(import.grid);
  SourceSamples source = import.grid ? raster_source(import) : vertices_as_source(*terrain);
  const std::size_t dropped = samples - terrain->vertex_count();
  return ImportedTerrain{std::move(*terrain),      std::move(source), std::nullopt, false,
                         std::move(import.driver), dropped};
}

/// Of what a simplification is asked for, the number of vertices alone may turn out to be impossible.
tin::base::Error at_its_parameter(tin::base::Error error, const tin::simplify::Options& options) {
  if (error.code == tin::base::Code::kInvalidValue && options.max_vertices) error.where = "query:maxVertices";
  return error;
}

/// A raster becomes a simplified terrain without one of all its samples.
Result<ImportedTerrain> build_from_heights(gdal::Import import, const tin::simplify::Options& options,
                                           Progress& progress) {
  SourceSamples source = raster_source(import);
  progress.begin_phase(kRead, kChosen);
  auto chosen = tin::simplify::simplify_samples(source, options, &progress);
  if (!chosen) return at_its_parameter(chosen.error(), options);
  progress.begin_phase(kChosen, kBuilt);
  auto terrain = Terrain::build(std::move(import.frame), chosen->vertices, Duplicates::kReject, &progress,
                                engine_threads());
  if (!terrain) return terrain.error();
  terrain->set_source_grid(import.grid);
  return ImportedTerrain{std::move(*terrain),      std::move(source), chosen->report, false,
                         std::move(import.driver), 0};
}

/// Points are triangulated first: that is how duplicates find each other.
Result<ImportedTerrain> build_from_points(gdal::Import import, Duplicates duplicates,
                                          const tin::simplify::Options& options, Progress& progress) {
  auto made = build_whole(std::move(import), duplicates, progress, kPointsBuilt);
  if (!made) return made.error();
  progress.begin_phase(kPointsBuilt, kBuilt);
  auto outcome = tin::simplify::simplify(made->terrain, nullptr, {}, options, &progress);
  if (!outcome) return at_its_parameter(outcome.error(), options);
  made->terrain = thinned(made->terrain, {std::move(outcome->removed), {}, std::move(outcome->reset)});
  made->report = outcome->report;
  // Its samples were the vertices, of which no copy was needed; they are the source's points all the same.
  if (auto& worst = made->report->worst; worst && !worst->between)
    worst->source_index = made->source.find(worst->at);
  return made;
}

/// What was read and the terrain that becomes of it. Of a raster that is simplified at once: what is in
/// memory of its heights (as read, and as worked on), its masks and the ranges of its blocks; the rest it
/// asks for on its way.
std::uint64_t bytes_to_build(const gdal::Import& import, const ScratchSpace& scratch) {
  constexpr std::uint64_t kWorkedOn = sizeof(double), kPixelsPerByteOfMasks = 2;
  const auto pixels = static_cast<std::uint64_t>(import.heights.size());
  if (import.placements.empty())
    return scratch.bytes_in_memory(pixels * (import.heights.bytes_each() + kWorkedOn)) +
           pixels / kPixelsPerByteOfMasks;
  return import.placements.size() * (sizeof(tin::terrain::Placement) + kBytesPerVertex) +
         pixels * sizeof(double);
}

Result<ImportedTerrain> build(gdal::Import import, const ImportRequest& request, const TimeBudget& budget,
                              const std::function<bool(std::size_t)>& room, Progress& progress) {
  if (!request.simplify) return build_whole(std::move(import), request.duplicates, progress, kBuilt);
  tin::simplify::Options options = *request.simplify;
  options.out_of_time = budget.question(&progress);
  if (room) options.room = room;
  auto made = import.grid ? build_from_heights(std::move(import), options, progress)
                          : build_from_points(std::move(import), request.duplicates, options, progress);
  if (made) made->out_of_time = budget.was_spent();
  return made;
}

/// The same, until somebody asks to stop.
store::Pieces unless_cancelled(store::Pieces pieces, const Progress& progress) {
  return [pieces = std::move(pieces), &progress](const store::Sink& sink) {
    return pieces([&](std::string_view piece) -> Result<void> {
      if (progress.cancelled()) return tin::base::error(tin::base::Code::kCancelled, "Cancelled.");
      return sink(piece);
    });
  };
}

}  // namespace

Result<ImportedTerrain> import_terrain(const std::filesystem::path& file, const ImportRequest& request,
                                       Progress& progress, const ImportMeans* means) {
  const TimeBudget budget(request.max_seconds);
  progress.begin_phase(0, kRead);
  gdal::ImportOptions options = request.options;
  options.heights_only = request.simplify.has_value();
  auto import = request.decoder.import_file(file, options, &progress);
  if (!import) return import.error();
  if (request.vertical_unit) {
    import->frame.vertical_unit = request.vertical_unit->name;
    import->frame.vertical_unit_m = request.vertical_unit->metres;
  }
  std::optional<GrowingLease> lease;
  std::function<bool(std::size_t)> room;
  if (means != nullptr) {
    auto given = GrowingLease::of(means->memory, bytes_to_build(*import, means->scratch));
    if (!given) return given.error();
    lease.emplace(std::move(*given));
    room = [&lease](std::size_t bytes) { return lease->grow_to(bytes); };
  }
  auto made = build(*std::move(import), request, budget, room, progress);
  if (!made && lease && lease->refusal()) return *lease->refusal();
  if (made) progress.begin_phase(kBuilt, 1);
  return made;
}

Result<ImportedTin> import_tin(Catalogue& catalogue, const std::filesystem::path& file,
                               const ImportRequest& request, Progress& progress) {
  using Clock = std::chrono::steady_clock;
  const auto start = Clock::now();
  if (auto room = catalogue.check_room(request.id); !room) return room.error();
  if (auto room = catalogue.memory().check(0); !room) return room.error();
  const ImportMeans means{catalogue.memory(), catalogue.scratch()};
  const auto memory = catalogue.scratch().memory();  // outlives what lies in it
  ImportRequest own = request;
  if (own.simplify) own.options.memory = own.simplify->memory = memory.get();
  try {
    auto made = import_terrain(file, own, progress, &means);
    if (!made) return made.error();
    const auto completeness = made->report ? Completeness::kSomeSamples : Completeness::kAllSamples;
    auto source = attach_source(made->terrain, std::move(made->source), completeness);
    if (progress.cancelled()) return tin::base::error(tin::base::Code::kCancelled, "Cancelled.");
    auto tin = catalogue.create({request.id, request.title, std::move(made->terrain), request.duplicates,
                                 std::nullopt, unless_cancelled(std::move(source), progress)});
    if (!tin) return tin.error();
    return ImportedTin{*std::move(tin), made->report, made->out_of_time,
                       std::chrono::duration<double>(Clock::now() - start).count(), made->duplicates};
  } catch (const NoScratch& none) {
    return none.error();
  }
}

}  // namespace server::app
