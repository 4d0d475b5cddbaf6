#include "server/app/import.h"

namespace server::app {

using tin::base::Result;

Result<std::shared_ptr<Tin>> import_tin(Catalogue& catalogue, const std::filesystem::path& file,
                                        const ImportRequest& request, tin::base::Progress& progress) {
  if (auto room = catalogue.check_room(request.id); !room) return room.error();
  progress.begin_phase(0, 0.3);
  auto import = request.decoder.import_file(file, request.options, &progress);
  if (!import) return import.error();
  if (request.vertical_unit) {
    import->frame.vertical_unit = request.vertical_unit->name;
    import->frame.vertical_unit_m = request.vertical_unit->metres;
  }
  progress.begin_phase(0.3, 0.9);
  const auto memory =
      catalogue.memory().lease(import->placements.size() * (kBytesPerVertex + sizeof(import->placements[0])));
  if (!memory) return memory.error();
  auto terrain = tin::terrain::Terrain::build(std::move(import->frame), import->placements,
                                              request.duplicates, &progress);
  if (!terrain) return terrain.error();
  import->placements = {};
  terrain->set_source_grid(import->grid);
  progress.begin_phase(0.9, 1);
  Catalogue::NewTin made{request.id,         request.title, std::move(*terrain),
                         request.duplicates, std::nullopt,  true};
  return catalogue.create(std::move(made));
}

}  // namespace server::app
