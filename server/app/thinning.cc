#include "server/app/thinning.h"

#include <algorithm>

#include "server/app/threads.h"

namespace server::app {

using tin::terrain::Change;
using tin::terrain::Terrain;

namespace {

bool is_unchanged(const Terrain& seen, const Terrain& now, VertexId id) {
  const auto present = now.vertex(id), then = seen.vertex(id);
  return present && then && present->at == then->at && present->z == then->z;
}

bool is_free(const Terrain& terrain, tin::exact::Point p) {
  const auto& mesh = terrain.mesh();
  if (mesh.dimension() < 2) {
    const auto line = mesh.line();
    return std::none_of(line.begin(), line.end(), [&](auto v) { return mesh.point(v) == p; });
  }
  return terrain.triangulation().locate(p).kind != tin::delaunay::Location::Kind::kOnVertex;
}

}  // namespace

Fitting fit(const Terrain& seen, const Terrain& now, const Thinning& thinning) {
  using tin::terrain::Placement;
  Fitting fitting;
  fitting.change.cause = tin::terrain::Cause::kSimplification;
  auto& steps = fitting.change.steps;
  for (const VertexId id : thinning.removed) {
    if (!is_unchanged(seen, now, id)) continue;
    const auto vertex = now.vertex(id);
    fitting.removed.push_back(id);
    steps.push_back({id, Placement{vertex->at, vertex->z}, std::nullopt});
  }
  for (const tin::terrain::Vertex& vertex : thinning.reset) {
    if (!is_unchanged(seen, now, vertex.id)) continue;
    steps.push_back(
        {vertex.id, Placement{vertex.at, now.vertex(vertex.id)->z}, Placement{vertex.at, vertex.z}});
    fitting.changed.push_back(vertex);
  }
  VertexId next = now.next_id();
  for (const Placement& sample : thinning.inserted) {
    if (!is_free(now, sample.at)) continue;
    fitting.added.push_back({next, sample.at, sample.z});
    steps.push_back({next, std::nullopt, sample});
    next = VertexId(next.value() + 1);
  }
  return fitting;
}

Terrain rebuilt(const Terrain& terrain, const Fitting& fitting) {
  Terrain rest = terrain.replaced(fitting.removed, fitting.added, engine_threads());
  Change heights;
  for (const tin::terrain::Vertex& vertex : fitting.changed) {
    heights.steps.push_back({vertex.id, tin::terrain::Placement{vertex.at, rest.vertex(vertex.id)->z},
                             tin::terrain::Placement{vertex.at, vertex.z}});
  }
  TIN_CHECK(rest.replay(heights).ok());
  rest.amend(fitting.change);
  return rest;
}

Terrain thinned(const Terrain& terrain, const Thinning& thinning) {
  return rebuilt(terrain, fit(terrain, terrain, thinning));
}

}  // namespace server::app
