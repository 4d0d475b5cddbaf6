#include "server/app/import.h"

#include "server/app/source.h"

namespace server::app {

using tin::base::Progress;
using tin::base::Result;
using tin::terrain::Duplicates;
using tin::terrain::SourceSamples;
using tin::terrain::Terrain;

namespace {

struct Made {
  Terrain terrain;
  std::string source;  // bytes
};

SourceSamples raster_source(gdal::Import& import) {
  std::vector<std::uint64_t> valid = import.grid->valid;
  return SourceSamples::restored_raster(import.grid, std::move(import.heights), std::move(valid));
}

/// Every sample becomes a vertex.
Result<Made> build_whole(gdal::Import import, Duplicates duplicates, Progress& progress) {
  auto terrain = Terrain::build(std::move(import.frame), import.placements, duplicates, &progress);
  if (!terrain) return terrain.error();
  import.placements = {};
  terrain->set_source_grid(import.grid);
  const SourceSamples source = import.grid ? raster_source(import) : vertices_as_source(*terrain);
  std::string bytes = attach_source(*terrain, source, Completeness::kAllSamples);
  return Made{std::move(*terrain), std::move(bytes)};
}

/// A raster becomes a simplified terrain without one of all its samples.
Result<Made> build_from_heights(gdal::Import import, const tin::simplify::Options& options,
                                Progress& progress) {
  const SourceSamples source = raster_source(import);
  auto chosen = tin::simplify::simplify_samples(source, options, &progress);
  if (!chosen) return chosen.error();
  auto terrain = Terrain::build(std::move(import.frame), chosen->vertices, Duplicates::kReject, &progress);
  if (!terrain) return terrain.error();
  terrain->set_source_grid(import.grid);
  std::string bytes = attach_source(*terrain, source, Completeness::kSomeSamples);
  return Made{std::move(*terrain), std::move(bytes)};
}

/// Points are triangulated first: that is how duplicates find each other.
Result<Made> build_from_points(gdal::Import import, Duplicates duplicates,
                               const tin::simplify::Options& options, Progress& progress) {
  auto made = build_whole(std::move(import), duplicates, progress);
  if (!made) return made.error();
  auto outcome = tin::simplify::simplify(made->terrain, nullptr, {}, options, &progress);
  if (!outcome) return outcome.error();
  // The first change of the terrain: whoever looks at it later sees what it began with.
  Terrain rest = made->terrain.without(outcome->removed);
  tin::terrain::Amendments amendments = rest.amendments();
  amendments.set_thinned();
  rest.set_amendments(std::move(amendments));
  return Made{std::move(rest), std::move(made->source)};
}

Result<Made> build(gdal::Import import, const ImportRequest& request, Progress& progress) {
  if (!request.simplify) return build_whole(std::move(import), request.duplicates, progress);
  if (import.grid) return build_from_heights(std::move(import), *request.simplify, progress);
  return build_from_points(std::move(import), request.duplicates, *request.simplify, progress);
}

}  // namespace

Result<std::shared_ptr<Tin>> import_tin(Catalogue& catalogue, const std::filesystem::path& file,
                                        const ImportRequest& request, Progress& progress) {
  if (auto room = catalogue.check_room(request.id); !room) return room.error();
  progress.begin_phase(0, 0.3);
  gdal::ImportOptions options = request.options;
  options.heights_only = request.simplify.has_value();
  auto import = gdal::import_file(file, options, &progress);
  if (!import) return import.error();
  if (request.vertical_unit) {
    import->frame.vertical_unit = request.vertical_unit->name;
    import->frame.vertical_unit_m = request.vertical_unit->metres;
  }
  progress.begin_phase(0.3, 0.9);
  auto made = build(*std::move(import), request, progress);
  if (!made) return made.error();
  progress.begin_phase(0.9, 1);
  return catalogue.create({request.id, request.title, std::move(made->terrain), request.duplicates,
                           std::nullopt, std::move(made->source)});
}

}  // namespace server::app
