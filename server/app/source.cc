#include "server/app/source.h"

#include <utility>
#include <vector>

#include "tin/codec/source.h"

namespace server::app {

using tin::terrain::Amendments;
using tin::terrain::SourceKind;
using tin::terrain::SourceSamples;
using tin::terrain::Terrain;

store::Pieces attach_source(Terrain& terrain, SourceSamples source, Completeness completeness) {
  Amendments amendments(source.is_raster() ? SourceKind::kRaster : SourceKind::kPoints);
  if (completeness == Completeness::kSomeSamples) amendments.set_thinned();
  terrain.set_amendments(std::move(amendments));
  return [source = std::move(source)](const store::Sink& sink) {
    return tin::codec::encode_source(source, sink);
  };
}

SourceSamples vertices_as_source(const Terrain& terrain) {
  std::vector<tin::terrain::Placement> points;
  points.reserve(terrain.vertex_count());
  for (std::uint32_t i = 1; i < terrain.mesh().vertex_slots(); ++i) {
    const tin::mesh::VertexSlot v(i);
    if (terrain.mesh().is_alive(v)) points.push_back({terrain.mesh().point(v), terrain.z(v)});
  }
  return SourceSamples::points(std::move(points));
}

}  // namespace server::app
